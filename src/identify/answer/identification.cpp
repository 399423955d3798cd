#include "identify/answer/identification.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "identify/answer/early_stop.hpp"
#include "identify/answer/finer_rungs.hpp"
#include "identify/answer/further_runs.hpp"
#include "identify/answer/profile.hpp"
#include "identify/estimate/repeats.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace treacle::identify {

namespace {
// Scatter of few runs, of one parameter on a logarithmic scale, taken together with what it usually is, which counts as one run: two answers
// can be alike by chance, and the interval would then be too narrow. Returns the degrees of freedom.
int expect_usual_noise(const StudyFile& file, int freedom, Eigen::MatrixXd& noise) {
    constexpr double usual =
        0.01; // of the logarithm of a viscosity; 0.5 to 2 % in the templates' scenes at their coarsest spacing
    if (file.searched != 1 || file.study.parameters.front().scale != study::Scale::log) return freedom;
    noise(0, 0) = (noise(0, 0) * freedom + usual * usual) / (freedom + 1);
    return freedom + 1;
}

// Scatter of the answer over runs of spacings near the coarsest, and their mean, which has less of it than the answer of the search.
NoiseMeasure measure_noise(const StudyFile& file, const Priors& priors, Trials& trials, Identification& out) {
    const auto& parameter = file.study.parameters[file.searched + file.measured];
    std::vector<Eigen::VectorXd> answers{out.estimate->point};
    double spacings = *parameter.number(parameter.values.front());
    const auto wanted = noise_runs(file, point_of(out.estimate->point));
    const auto evaluated = trials.run(wanted);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (!evaluated[i]) continue;
        answers.push_back(estimate(trials.good(), priors, {{*evaluated[i]}}, range_prior(file)).point);
        spacings += wanted[i].second.value;
    }
    if (answers.size() < 2) return {};
    const double count = double(answers.size());
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(out.estimate->point.size());
    for (const auto& one : answers) mean += one / count;
    for (const auto& one : answers) out.noise += (one - mean) * (one - mean).transpose() / (count - 1);
    const int runs = int(answers.size()), freedom = expect_usual_noise(file, runs - 1, out.noise);
    for (std::size_t k = 0; k < file.searched; ++k)
        out.estimate->parts[k].noise = out.noise(Eigen::Index(k), Eigen::Index(k));
    return {freedom, ResolutionAnswer{spacings / count, runs, mean}};
}

// Effect of a standard deviation of each measured value on the answer.
void vary_measured(const StudyFile& file, const Priors& priors, Trials& trials, Identification& out) {
    const auto point = out.estimate->point;
    for (const auto& wanted : measured_runs(file, point_of(point))) {
        const auto index = wanted.second.parameter;
        const auto& parameter = file.study.parameters[index];
        const double deviation = file.deviations[index - file.searched];
        double step = wanted.second.value - *parameter.number(parameter.values.front());
        auto run = trials.run({wanted}).front();
        if (!run) {
            auto lowered = wanted;
            lowered.second.value -= 2 * step;
            step = -step;
            run = trials.run({lowered}).front();
        }
        if (!run)
            throw InputError({parameter.where,
                "the runs with " + parameter.name + " raised and lowered by " + format_number(-step) + " failed",
                "its share of the interval is not known", "see the table for the reason"});
        const Eigen::VectorXd shift =
            (estimate(trials.good(), priors, {{*run}}, range_prior(file)).point - point) * deviation / step;
        for (std::size_t k = 0; k < file.searched; ++k)
            out.estimate->parts[k].measured.emplace_back(
                parameter.name, shift[Eigen::Index(k)] * shift[Eigen::Index(k)]);
        out.covariance += shift * shift.transpose();
    }
}

// With several clips of one set-up the answer is the mean of theirs; what they differ by beyond their own noise enters the interval.
void add_clips(const StudyFile& file, const Priors& priors, Trials& trials, Identification& out) {
    const auto scatter = between_clips(trials.good(), priors, set_ups(file.experiments));
    if (!scatter) return;
    out.estimate->point += scatter->shift;
    for (std::size_t k = 0; k < out.corrections.size(); ++k)
        out.corrections[k].value += scatter->shift[Eigen::Index(k)];
    for (std::size_t k = 0; k < file.searched; ++k) {
        out.estimate->parts[k].clips = scatter->variance[Eigen::Index(k)];
        out.estimate->parts[k].clip_freedom = scatter->freedom;
    }
}

void say_answer(const StudyFile& file, Identification& out) {
    const auto& estimate = *out.estimate;
    out.covariance += estimate.covariance + out.noise;
    const Eigen::VectorXd answer = out.resolved.size() > 0 ? out.resolved : estimate.point;
    for (std::size_t k = 0; k < file.searched; ++k) { // what else there is moves each parameter by itself
        const auto i = Eigen::Index(k);
        out.covariance(i, i) = std::max(out.covariance(i, i), estimate.parts[k].total());
    }
    for (std::size_t k = 0; k < file.searched; ++k) {
        const auto& parameter = file.study.parameters[k];
        const double x = answer[Eigen::Index(k)];
        const double half =
            ninety_percent(estimate.parts[k], estimate.freedom[k]) * std::sqrt(estimate.parts[k].total());
        const bool log = parameter.scale == study::Scale::log;
        const auto at = [&](double y) { return log ? std::exp(y) : y; };
        out.values.push_back(at(x));
        out.low.push_back(at(x - half));
        out.high.push_back(at(x + half));
    }
}

// Runs that may follow the present ones of the search: its own next ones, and those at the answer so far.
Wanted expected_runs(const StudyFile& file, const Priors& priors, const Trials& trials, const search::Search& search) {
    Wanted out;
    if (!trials.speculates()) return out;
    for (const auto& point : search.speculate()) out.push_back({point, {}});
    if (trials.good().size() <= file.searched) return out;
    const auto so_far = estimate(trials.good(), priors, {}, range_prior(file));
    for (const auto& one : runs_around(so_far, trials.good(), search.axes())) out.push_back(one);
    for (const auto& one : later_runs(file, point_of(so_far.point))) out.push_back(one);
    return out;
}

std::vector<std::vector<double>> residuals_of(
    const std::vector<std::optional<EvaluatedRun>>& runs, const Priors& priors) {
    std::vector<std::vector<double>> out;
    out.reserve(runs.size());
    for (const auto& run : runs) out.push_back(run ? search_residuals(*run, priors) : std::vector<double>());
    return out;
}

void search_and_estimate(const StudyFile& file, const Priors& priors, Trials& trials, Identification& out) {
    auto search = search_of(file);
    while (!search->stopped()) {
        Wanted wanted;
        for (const auto& point : search->ask()) wanted.push_back({point, {}});
        trials.offer(expected_runs(file, priors, trials, *search));
        const auto before = out.trials.size();
        const auto cut = [&](std::size_t k) { return search->cut(k); };
        const auto evaluated = trials.run(wanted, file.search.stops_early() ? Trials::Cuts(cut) : Trials::Cuts());
        if (search->uses_residuals() && file.search.objective == Objective::displacements)
            search->tell_residuals(residuals_of(evaluated, priors));
        std::vector<search::Value> values;
        for (std::size_t i = before; i < out.trials.size(); ++i) {
            values.push_back(value_for_search(file, out.trials[i]));
        }
        search->tell(values);
    }
    out.stop = search->stopped()->text;
    for (int round = 0; round < 2; ++round) {
        const auto more =
            runs_around(estimate(trials.good(), priors, {}, range_prior(file)), trials.good(), search->axes());
        if (more.empty()) break;
        trials.offer(expected_runs(file, priors, trials, *search));
        trials.run(more);
    }
    out.estimate = estimate(trials.good(), priors, {}, range_prior(file));
    trials.offer(later_runs(file, point_of(out.estimate->point)));
}
} // namespace

const Trial* best_trial(const Identification& identification) {
    const Trial* best = nullptr;
    for (const auto& trial : identification.trials) {
        if (!std::isnan(trial.objective) && (!best || trial.objective < best->objective)) best = &trial;
    }
    return best;
}

const Trial* trial_at_answer(const StudyFile& file, const Identification& identification) {
    if (!file.has_rungs()) return best_trial(identification);
    const auto& spacing = file.study.parameters.back();
    const double finest = *spacing.number(spacing.values.back());
    const Trial* best = nullptr;
    for (const auto& trial : identification.trials) {
        if (!std::isnan(trial.objective) && trial.values.back() == finest &&
            (!best || trial.objective < best->objective))
            best = &trial;
    }
    return best ? best : best_trial(identification);
}

std::optional<EvaluatedRun> evaluated_runs(
    const StudyFile& file, const study::StudyRuns& runs, const std::vector<std::int64_t>& numbers) {
    EvaluatedRun out;
    for (const auto& experiment : file.experiments) {
        const auto number = numbers[std::size_t(&file.scene_of(experiment) - file.study.scenes.data())];
        const auto* outcome = runs.journal().outcome(number);
        if (!outcome || outcome->status != study::RunStatus::done) return {};
        out.experiments.push_back(read_residuals(runs.folder_of(number), experiment.name, experiment.kind));
    }
    return out;
}

void check_searched(const StudyFile& file, const study::SceneReader& read_scene) {
    search_of(file);
    check_scatter_is_measured(file);
    std::vector<study::Point> ends(2);
    for (const auto& parameter : file.study.parameters) {
        ends[0].push_back(parameter.word(parameter.lower));
        ends[1].push_back(parameter.word(parameter.upper));
    }
    study::candidates_of(file.study, ends, read_scene);
}

Identification identify(const StudyFile& file, const Priors& priors, study::StudyRuns& runs,
    const study::SceneReader& read_scene, Log& log) {
    Identification out;
    out.noise = out.covariance = Eigen::MatrixXd::Zero(Eigen::Index(file.searched), Eigen::Index(file.searched));
    Trials trials(file, priors, runs, read_scene, log, out);
    try {
        search_and_estimate(file, priors, trials, out);
        if (file.has_rungs()) {
            const auto noise = measure_noise(file, priors, trials, out);
            climb_rungs(file, priors, noise, trials, out);
        }
        vary_measured(file, priors, trials, out);
        add_clips(file, priors, trials, out);
        if (file.temperature.deviation() > 0) {
            for (auto& parts : out.estimate->parts)
                parts.measured.emplace_back("temperature", std::pow(file.temperature.deviation(), 2));
        }
        trials.offer({});
        say_answer(file, out);
        widen_to_alike_trials(file, out);
    } catch (const Trials::Stopped&) {
        out.end = study::StudyEnd::stopped;
        out.estimate.reset();
    } catch (const InputError& error) {
        out.problem = error.what();
        out.estimate.reset();
    }
    return out;
}

} // namespace treacle::identify
