#include "identify/estimate/repeats.hpp"

#include "base/text/error.hpp"

#include <algorithm>

namespace treacle::identify {

namespace {
// The answer of one clip alone.
struct ClipAnswer {
    std::size_t set_up = 0;
    Eigen::VectorXd point,
        own; // [p] variance: what the clip has by itself; camera and threshold are the same in all clips of a set-up
};

ClipAnswer answer_of(
    const std::vector<EvaluatedRun>& runs, const std::vector<ViewInformation>& priors, std::size_t clip) {
    std::vector<EvaluatedRun> alone;
    alone.reserve(runs.size());
    for (const auto& run : runs) alone.push_back({run.point, {run.experiments[clip]}});
    const auto found = estimate(alone, {priors[clip]});
    ClipAnswer out{0, found.point, Eigen::VectorXd(found.point.size())};
    for (std::size_t k = 0; k < found.parts.size(); ++k)
        out.own[Eigen::Index(k)] = found.parts[k].pixels + found.parts[k].time;
    return out;
}

// Variance between clips of one set-up [p], 0 at least, and its degrees of freedom.
std::pair<Eigen::VectorXd, double> between(const std::vector<ClipAnswer>& clips) {
    Eigen::VectorXd square = Eigen::VectorXd::Zero(clips.front().point.size()), own = square;
    double count = 0, freedom = 0;
    for (const auto& first : clips) {
        std::vector<const ClipAnswer*> group;
        for (const auto& one : clips) {
            if (one.set_up == first.set_up) group.push_back(&one);
        }
        if (group.front() != &first || group.size() < 2) continue;
        Eigen::VectorXd mean = Eigen::VectorXd::Zero(square.size());
        for (const auto* one : group) mean += one->point / double(group.size());
        for (const auto* one : group) {
            square += (one->point - mean).cwiseAbs2();
            own += one->own;
        }
        count += double(group.size());
        freedom += double(group.size()) - 1;
    }
    return {(square / freedom - own / count).cwiseMax(0), freedom};
}

ClipScatter scatter_of(const std::vector<EvaluatedRun>& runs, const std::vector<ViewInformation>& priors,
    const std::vector<std::size_t>& set_up) {
    std::vector<ClipAnswer> clips;
    for (std::size_t e = 0; e < set_up.size(); ++e) {
        clips.push_back(answer_of(runs, priors, e));
        clips.back().set_up = set_up[e];
    }
    const auto [variance, freedom] = between(clips);
    constexpr double least = 1e-12; // of a variance: clips without noise
    Eigen::ArrayXd weights = Eigen::ArrayXd::Zero(variance.size()), sum = weights, squares = weights;
    for (const auto& one : clips) {
        const Eigen::ArrayXd weight = 1 / ((one.own + variance).array() + least);
        weights += weight;
        squares += weight * weight;
        sum += weight * one.point.array();
    }
    ClipScatter out;
    out.mean = (sum / weights).matrix();
    out.shift = out.mean - estimate(runs, priors).point;
    out.variance = (variance.array() * squares / (weights * weights)).matrix();
    out.freedom = freedom;
    return out;
}
} // namespace

std::vector<std::size_t> set_ups(const std::vector<Experiment>& experiments) {
    std::vector<std::size_t> out;
    for (std::size_t e = 0; e < experiments.size(); ++e) {
        const auto first = std::ranges::find(experiments, experiments[e].repeats, &Experiment::name);
        out.push_back(experiments[e].repeats.empty() || first == experiments.end()
                          ? e
                          : std::size_t(first - experiments.begin()));
    }
    return out;
}

std::optional<ClipScatter> between_clips(const std::vector<EvaluatedRun>& runs,
    const std::vector<ViewInformation>& priors, const std::vector<std::size_t>& set_up) {
    if (runs.empty()) return {};
    std::vector<std::size_t> different = set_up;
    std::ranges::sort(different);
    different.erase(std::unique(different.begin(), different.end()), different.end());
    if (different.size() == set_up.size()) return {};
    if (runs.front().point.size() > 1 && different.size() > 1) return {};
    try {
        return scatter_of(runs, priors, set_up);
    } catch (const InputError&) { // a clip alone does not determine the parameters
        return {};
    }
}

} // namespace treacle::identify
