#include "identify/answer/finer_rungs.hpp"

#include "identify/answer/further_runs.hpp"

#include <algorithm>

namespace treacle::identify {

namespace {
// Runs at one spacing until the answer there stands, at most `most` of them: at the answer so far, and then where it
// moves to. A run to the side, unless the answer moves by itself, gives the change of displacements at this spacing:
// where the flow is wild, the coarse runs have another one. A run that fails is followed by one beside it. False where
// no run succeeded.
bool settle_rung(const StudyFile& file, const Priors& priors, Trials& trials,
    std::vector<std::vector<EvaluatedRun>>& finer, std::size_t rung, Eigen::VectorXd& point) {
    constexpr double near = 0.03, step = 0.15; // of the logarithm of a viscosity
    constexpr std::size_t most = 4;
    constexpr int most_failures = 3;
    finer.emplace_back();
    auto next = point;
    int failures = 0;
    while (finer.back().size() < most) {
        const auto run = trials.run({rung_runs(file, point_of(next))[rung]}).front();
        if (!run) { // its failure stands in the table
            if (++failures == most_failures) break;
            next.array() += (failures % 2 == 1 ? step : -2 * step);
            continue;
        }
        finer.back().push_back(*run);
        point = estimate(trials.good(), priors, finer, range_prior(file)).point;
        const auto distance = [&](const EvaluatedRun& one) { return (one.point - point).cwiseAbs().maxCoeff(); };
        const bool moved =
            std::ranges::all_of(finer.back(), [&](const EvaluatedRun& one) { return distance(one) > near; });
        next = point;
        if (moved) continue;
        if (finer.back().size() > 1) break;
        const Eigen::VectorXd way = point - finer.back().front().point;
        next = finer.back().front().point + (way.norm() > 0 ? Eigen::VectorXd(way * (step / way.norm()))
                                                            : Eigen::VectorXd::Constant(way.size(), step));
    }
    if (!finer.back().empty()) return true;
    finer.pop_back();
    return false;
}

// The pixels' part of the interval and all other figures of the fit are those of the finest runs.
void take_fit(const Estimate& finest, Estimate& out) {
    auto parts = finest.parts;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        parts[k].noise = out.parts[k].noise;
        parts[k].resolution = out.parts[k].resolution;
    }
    const auto point = out.point;
    const auto alike = out.alike;
    out = finest;
    out.parts = std::move(parts);
    out.point = point;
    out.alike = alike;
}

search::Extrapolation at_finest(search::Extrapolation found) {
    found.value -= found.correction;
    found.correction = 0;
    found.deviation = found.noise;
    found.text = "the answer is that of the finest rung, as the study asks";
    return found;
}

} // namespace

void climb_rungs(
    const StudyFile& file, const Priors& priors, const NoiseMeasure& noise, Trials& trials, Identification& out) {
    const auto& parameter = file.study.parameters[file.searched + file.measured];
    auto point = out.estimate->point;
    std::vector<ResolutionAnswer> answers;
    const auto keep = [&](const std::string& word, const ResolutionAnswer& found) {
        RungAnswer answer{word, {}};
        for (std::size_t k = 0; k < file.searched; ++k)
            answer.values.push_back(value_of(file.study.parameters[k], found.value[Eigen::Index(k)]));
        answers.push_back(found);
        out.rungs.push_back(answer);
    };
    const auto found_by = [&](const std::string& word, std::size_t runs) {
        constexpr std::size_t near = 2; // runs that are near enough to the answer to lessen its noise
        return ResolutionAnswer{*parameter.number(word), int(std::min(runs, near)), point};
    };
    const auto& coarsest = parameter.values.front();
    keep(coarsest, noise.answer ? *noise.answer : found_by(coarsest, out.estimate->runs));
    std::vector<std::vector<EvaluatedRun>> finer;
    for (std::size_t i = 1; i < parameter.values.size(); ++i) {
        if (settle_rung(file, priors, trials, finer, i - 1, point))
            keep(parameter.values[i], found_by(parameter.values[i], finer.back().size()));
    }
    if (finer.empty()) return;
    take_fit(estimate(trials.good(), priors, finer, range_prior(file)), *out.estimate);
    auto resolved = extrapolate_answers(answers, out.estimate->covariance, out.noise, noise.freedom);
    if (file.search.answer == Answer::finest) {
        resolved.value = answers.back().value;
        resolved.resolution.setZero();
        for (auto& one : resolved.axes) one = at_finest(one);
    }
    out.resolved = resolved.value;
    if (const auto range = range_prior(file); range.lower.size() > 0)
        out.resolved = resolved.value.cwiseMax(range.lower).cwiseMin(range.upper);
    out.corrections = resolved.axes;
    out.noise = resolved.noise;
    out.covariance += resolved.resolution;
    for (std::size_t k = 0; k < file.searched; ++k) {
        const auto i = Eigen::Index(k);
        out.estimate->parts[k].noise = resolved.noise(i, i);
        out.estimate->parts[k].resolution = resolved.resolution(i, i);
    }
}

} // namespace treacle::identify
