#include "identify/estimate/local_model.hpp"

#include "base/text/error.hpp"

#include <algorithm>

namespace treacle::identify {

namespace {
// Distances over which the local model may be fitted, of the logarithm of a viscosity: runs at `cutoff` count half. With several parameters
// the model is linear, and less far.
constexpr double cutoff = 0.3, farthest = 0.7;

// Runs that the model is fitted to: all that are not far from the centre, and the nearest ones where these are too few. A model
// through the nearest alone, where a search has closed in, has the derivatives of the runs' numerical noise.
std::vector<const EvaluatedRun*> runs_near(const std::vector<EvaluatedRun>& runs, const Vector& centre) {
    const std::size_t p = std::size_t(centre.size()), wanted = p == 1 ? 5 : p + 3;
    std::vector<std::pair<double, const EvaluatedRun*>> order;
    order.reserve(runs.size());
    for (const auto& run : runs) order.emplace_back((run.point - centre).norm(), &run);
    std::ranges::stable_sort(order, {}, &std::pair<double, const EvaluatedRun*>::first);
    std::vector<const EvaluatedRun*> out;
    for (const auto& [distance, run] : order) {
        if (distance <= (p == 1 ? farthest : cutoff) || out.size() < wanted) out.push_back(run);
    }
    if (out.size() < p + 1) {
        throw InputError({"identify", "has " + std::to_string(out.size()) + " good runs",
            "its local model needs " + std::to_string(p + 1), "raise search.evaluations, or see why runs failed"});
    }
    return out;
}
} // namespace

LocalModel local_model(const std::vector<EvaluatedRun>& runs, const Layout& layout, const Vector& centre) {
    const auto near = runs_near(runs, centre);
    const auto p = centre.size();
    LocalModel out;
    out.runs = near.size();
    const bool quadratic = p == 1 && out.runs >= 3;
    Matrix basis(Eigen::Index(out.runs), p + 1 + (quadratic ? 1 : 0));
    Matrix values(Eigen::Index(out.runs), Eigen::Index(layout.rows.size()));
    for (std::size_t k = 0; k < out.runs; ++k) {
        const auto i = Eigen::Index(k);
        const Vector d = near[k]->point - centre;
        const double weight = 1 / (1 + d.squaredNorm() / (cutoff * cutoff));
        basis(i, 0) = weight;
        basis.row(i).segment(1, p) = weight * d.transpose();
        if (quadratic) basis(i, p + 1) = weight * 0.5 * d[0] * d[0];
        values.row(i) = weight * displacements(*near[k], layout).transpose();
    }
    const Matrix coefficients = basis.colPivHouseholderQr().solve(values);
    out.value = coefficients.row(0).transpose();
    out.gradient = coefficients.middleRows(1, p).transpose();
    out.square = quadratic ? Vector(coefficients.row(p + 1).transpose()) : Vector(Vector::Zero(out.value.size()));
    return out;
}

void correct(LocalModel& model, const std::vector<EvaluatedRun>& runs, const Layout& layout, const Vector& centre) {
    constexpr double hidden =
        0.1; // distance, of the logarithm of a viscosity, over which the model's slope errs by as much as runs scatter
    const auto p = centre.size(), count = Eigen::Index(runs.size());
    Matrix basis = Matrix::Zero(count + p, p + 1), beyond = Matrix::Zero(count + p, model.value.size());
    for (Eigen::Index i = 0; i < count; ++i) {
        const auto& run = runs[std::size_t(i)];
        const Vector d = run.point - centre;
        basis(i, 0) = 1;
        basis.row(i).tail(p) = d.transpose();
        beyond.row(i) = (displacements(run, layout) - model.value - model.gradient * d).transpose();
        if (p == 1) beyond.row(i) -= 0.5 * d[0] * d[0] * model.square.transpose();
    }
    for (Eigen::Index k = 0; k < p; ++k) basis(count + k, k + 1) = hidden;
    const Matrix change = basis.colPivHouseholderQr().solve(beyond);
    model.value += change.row(0).transpose();
    model.gradient += change.bottomRows(p).transpose();
}

} // namespace treacle::identify
