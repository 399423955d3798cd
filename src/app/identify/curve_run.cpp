#include "app/identify/curve_run.hpp"

#include "app/identify/identified_liquids.hpp"
#include "base/text/error.hpp"
#include "base/text/split.hpp"
#include "base/text/text.hpp"
#include "identify/experiment/digits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace treacle::app {

namespace {
using identify::digits;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

// True for a key of the rheology of this liquid.
bool is_rheology(const std::string& key, const std::string& liquid) {
    const auto parts = split(key, '.');
    return parts.size() >= 3 && parts[0] == "liquids" && parts[1] == liquid &&
           (parts[2] == "viscosity" || parts[2] == "rheology");
}

// Liquids of which a key of the rheology is searched.
std::vector<std::string> rheological_liquids(const identify::StudyFile& file) {
    std::vector<std::string> out;
    for (const auto& liquid : searched_liquids(file)) {
        const auto end = file.study.parameters.begin() + std::ptrdiff_t(file.searched);
        if (std::any_of(
                file.study.parameters.begin(), end, [&](const auto& one) { return is_rheology(one.key, liquid); }))
            out.push_back(liquid);
    }
    return out;
}

identify::CurveFit fit_over_flow(
    const identify::ViscositiesByRate& measured, const identify::Trial& answer, const study::StudyRuns& runs) {
    identify::ShearRates flow;
    for (const auto run : answer.runs) flow.add(identify::read_shear_rates(runs.folder_of(run)).weights());
    return flow.empty() ? identify::fit_flow_curve(measured)
                        : identify::fit_flow_curve(measured, flow.quantile(0.05), flow.quantile(0.95));
}

// The study's scenes with these words of the parameters, and more keys that are changed.
struct TrialScenes {
    study::Point words;
    std::vector<std::string> changes;
};

// Does the runs, and blocks until they end; runs that failed are logged with their reasons.
void run_trial(const AskedStudy& asked, const TrialScenes& trial_scenes, identify::Trial& trial,
    identify::ComparedCurve& out, identify::Identification& found) {
    const auto& [file, runs, read_scene] = asked;
    for (const auto& scene : file.study.scenes)
        trial.runs.push_back(
            runs.ask(study::candidate_of(file.study, scene, trial_scenes.words, read_scene, trial_scenes.changes)));
    found.end = runs.run(trial.runs);
    if (found.end == study::StudyEnd::stopped) return;
    for (const auto number : trial.runs) {
        const auto* outcome = runs.journal().outcome(number);
        if (outcome && outcome->status == study::RunStatus::done) continue;
        out.problem += (out.problem.empty() ? "run " : "; run ") + std::to_string(number) + " " +
                       (outcome ? study::word(outcome->status) + ": " + outcome->reason : "was not done");
    }
}

void tell(const identify::ComparedCurve& compared, const identify::Identification& found, Log& log) {
    const auto& trial = *compared.trial;
    log.line("trial " + std::to_string(found.trials.size() + 1) + " (" + trial.purpose + ")  " +
             describe(*compared.fit) +
             (std::isnan(trial.objective) ? "  failed" : "  objective " + digits(trial.objective, 6)));
}
} // namespace

MeasuredCurve read_measured_curve(const std::string& argument, const identify::StudyFile& file) {
    const auto sign = argument.find('=');
    if (sign == std::string::npos || std::filesystem::exists(argument))
        return {"", identify::read_flow_curve(argument)};
    MeasuredCurve out{argument.substr(0, sign), identify::read_flow_curve(argument.substr(sign + 1))};
    const auto liquids = searched_liquids(file);
    if (std::ranges::find(liquids, out.liquid) != liquids.end()) return out;
    const auto close = nearest(out.liquid, liquids);
    throw InputError({"--compare-curve " + argument, "no key of a liquid " + out.liquid + " is searched",
        liquids.empty() ? "the study searches no liquid's" : "the study searches those of " + join(liquids, ", "),
        close ? "did you mean " + *close + "?" : "name one of these"});
}

std::vector<std::string> keys_of_law(
    const identify::CurveFit& law, const std::string& liquid, const scene::Rheology& rheology) {
    const bool yields = rheology.law == scene::ViscosityModelKind::herschel_bulkley,
               powers = yields || rheology.law == scene::ViscosityModelKind::power_law;
    std::string block = "law: herschel_bulkley, exponent: " + digits(law.exponent, 6) +
                        ", yield_stress: " + digits(law.yield_stress, 6) + " Pa";
    if (yields) block += ", regularisation_time: " + format_number(rheology.regularisation_time) + " s";
    if (powers) block += ", min_shear_rate: " + format_number(rheology.min_shear_rate) + " 1/s";
    return {"liquids." + liquid + ".viscosity=" + digits(law.consistency, 6) + " Pa.s",
        "liquids." + liquid + ".rheology={" + block + "}"};
}

identify::ComparedCurve run_at_curve(const AskedStudy& asked, const identify::Priors& priors,
    const MeasuredCurve& measured, identify::Identification& found, Log& log) {
    const auto& file = asked.file;
    auto& runs = asked.runs;
    identify::ComparedCurve out;
    auto liquids = rheological_liquids(file);
    std::erase_if(liquids, [&](const auto& name) { return !measured.is_of(name); });
    if (liquids.size() != 1) {
        out.problem = liquids.empty() ? "no viscosity of the liquid was identified"
                                      : "the study identifies " + join(liquids, ", ") +
                                            ", and it is not said which of them was measured: --compare-curve " +
                                            liquids.front() + "=FILE.csv";
        return out;
    }
    out.liquid = liquids.front();
    const auto* answer = identify::trial_at_answer(file, found);
    out.fit = fit_over_flow(measured.curve, *answer, runs);
    if (!out.fit->is_close()) {
        out.problem = "no law of Herschel and Bulkley is near to the curve";
        return out;
    }
    identify::Trial trial;
    trial.purpose = "measured curve";
    trial.objective = none;
    study::Point words;
    for (std::size_t k = 0; k < answer->values.size(); ++k) {
        const auto& parameter = file.study.parameters[k];
        words.push_back(parameter.word(answer->values[k]));
        trial.values.push_back(is_rheology(parameter.key, out.liquid) ? none : answer->values[k]);
    }
    try {
        const auto liquid = liquid_at(file, out.liquid, answer->values);
        run_trial(asked, {words, keys_of_law(*out.fit, out.liquid, liquid->rheology)}, trial, out, found);
    } catch (const Error& error) {
        out.problem = error.what();
        return out;
    }
    if (found.end == study::StudyEnd::stopped) return out;
    const auto at_answer = identify::evaluated_runs(file, runs, answer->runs);
    if (const auto run = identify::evaluated_runs(file, runs, trial.runs)) {
        trial.objective = identify::residual_objective(*run, priors);
        for (const auto& one : run->experiments) trial.mismatches.push_back(one.mismatch);
        out.misfits = identify::misfits_of_run(*run, priors);
        out.at_answer = identify::misfits_of_run(*at_answer, priors);
    }
    out.trial = std::move(trial);
    tell(out, found, log);
    return out;
}

} // namespace treacle::app
