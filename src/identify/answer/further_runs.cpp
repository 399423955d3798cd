#include "identify/answer/further_runs.hpp"

#include "identify/estimate/directions.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace treacle::identify {

namespace {
// Step by which a measured value is changed to measure its effect: far enough that the change stands out of the
// numerical noise.
double measured_step(double value, double deviation) {
    constexpr double clear = 0.05; // relative
    return std::max(deviation, clear * std::abs(value));
}
} // namespace

Wanted runs_around(
    const Estimate& estimate, const std::vector<EvaluatedRun>& good, const std::vector<search::Axis>& axes) {
    constexpr double step = 0.12, near = 0.03; // of the logarithm of a viscosity
    Wanted out;
    const auto p = std::size_t(estimate.point.size());
    if (p > 1) {
        std::vector<Eigen::VectorXd> points;
        points.reserve(good.size());
        for (const auto& run : good) points.push_back(run.point);
        for (const auto& point : points_to_span(estimate.point, points, axes))
            out.push_back({point, {"around the answer"}});
        return out;
    }
    for (std::size_t k = 0; k < p; ++k) {
        for (const double side : {-step, 0.0, step}) {
            search::Point point(estimate.point.data(), estimate.point.data() + p);
            point[k] = std::clamp(point[k] + side, axes[k].lower, axes[k].upper);
            const bool there = std::ranges::any_of(good, [&](const EvaluatedRun& run) {
                return (run.point - Eigen::Map<const Eigen::VectorXd>(point.data(), Eigen::Index(p)))
                           .cwiseAbs()
                           .maxCoeff() < (side == 0 ? near / 3 : near);
            });
            const bool listed = std::ranges::any_of(out, [&](const auto& one) { return one.first == point; });
            if (!there && !listed) out.push_back({point, {"around the answer"}});
        }
    }
    return out;
}

search::Point point_of(const Eigen::VectorXd& vector) { return {vector.data(), vector.data() + vector.size()}; }

Wanted noise_runs(const StudyFile& file, const search::Point& point) {
    constexpr std::array factors{0.985, 1.015, 0.97, 1.03, 0.955, 1.045, 0.94, 1.06};
    const auto spacing = file.searched + file.measured;
    const auto& parameter = file.study.parameters[spacing];
    const double width = *parameter.number(parameter.values.front());
    Wanted out;
    for (int i = 0; i < file.search.noise_runs; ++i)
        out.push_back({point, {"noise", spacing, width * factors[std::size_t(i)]}});
    return out;
}

Wanted rung_runs(const StudyFile& file, const search::Point& point) {
    const auto spacing = file.searched + file.measured;
    const auto& parameter = file.study.parameters[spacing];
    Wanted out;
    for (std::size_t i = 1; i < parameter.values.size(); ++i)
        out.push_back({point, {"rung " + parameter.values[i], spacing, *parameter.number(parameter.values[i])}});
    return out;
}

Wanted measured_runs(const StudyFile& file, const search::Point& point) {
    Wanted out;
    for (std::size_t m = 0; m < file.measured; ++m) {
        const auto index = file.searched + m;
        const auto& parameter = file.study.parameters[index];
        const double value = *parameter.number(parameter.values.front());
        if (file.deviations[m] != 0)
            out.push_back({point, {parameter.name, index, value + measured_step(value, file.deviations[m])}});
    }
    return out;
}

Wanted later_runs(const StudyFile& file, const search::Point& point) {
    Wanted out;
    const auto add = [&](const Wanted& more) { out.insert(out.end(), more.begin(), more.end()); };
    if (file.has_rungs()) {
        add(noise_runs(file, point));
        add(rung_runs(file, point));
    }
    add(measured_runs(file, point));
    return out;
}

} // namespace treacle::identify
