#include "identify/report/report.hpp"

#include "base/text/file.hpp"
#include "base/text/text.hpp"
#include "identify/answer/profile.hpp"
#include "identify/experiment/digits.hpp"
#include "identify/report/report_charts.hpp"
#include "identify/report/report_drift.hpp"
#include "identify/report/report_fields.hpp"
#include "identify/report/report_film.hpp"
#include "identify/report/report_pictures.hpp"
#include "study/plots/chart.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

namespace {
// Root mean square residual of an experiment that is left over, in its unit.
double misfit_of(const Estimate& estimate, std::size_t experiment) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < estimate.misfit.size(); ++i) {
        if (estimate.misfit_of[i] != experiment) continue;
        sum += estimate.misfit[i] * estimate.misfit[i];
        count += 1;
    }
    return count > 0 ? std::sqrt(sum / count) : 0;
}

bool only(const StudyFile& file, ExperimentKind kind) {
    return std::ranges::all_of(file.experiments, [&](const auto& one) { return one.kind == kind; });
}

std::string percent(double fraction) { return digits(100 * fraction, 2) + " %"; }

std::string row(const std::vector<std::string>& cells, const char* tag = "td") {
    std::string out = "<tr>";
    for (const auto& cell : cells) out += std::string("<") + tag + ">" + cell + "</" + tag + ">";
    return out + "</tr>\n";
}

// Name of the part of the variance that comes from what is compared.
const char* scatter_name(const StudyFile& file) {
    if (only(file, ExperimentKind::contours)) return "pixels";
    return only(file, ExperimentKind::piv) ? "vectors" : "scatter";
}

// The parts of a variance by their names, the sum last.
std::vector<std::pair<std::string, double>> variance_fractions(const VarianceParts& parts, const StudyFile& file) {
    const auto any = [&](ExperimentKind kind) {
        return std::ranges::any_of(file.experiments, [&](const auto& one) { return one.kind == kind; });
    };
    std::vector<std::pair<std::string, double>> out{{scatter_name(file), parts.pixels}, {"time zero", parts.time}};
    if (file.searched > 1) out.emplace_back("range", parts.range);
    if (any(ExperimentKind::contours) || any(ExperimentKind::occupancy))
        out.insert(out.end(), {{"contour", parts.contour}, {"camera", parts.camera}});
    if (any(ExperimentKind::piv)) out.emplace_back("sheet", parts.sheet);
    if (any(ExperimentKind::series)) out.emplace_back("instrument", parts.instrument);
    if (file.has_rungs()) out.insert(out.end(), {{"resolution", parts.resolution}, {"noise", parts.noise}});
    const bool repeated = std::ranges::any_of(file.experiments, [](const auto& one) { return !one.repeats.empty(); });
    if (repeated) out.emplace_back("clips", parts.clips);
    out.insert(out.end(), parts.measured.begin(), parts.measured.end());
    out.emplace_back("all", parts.total());
    return out;
}

std::string rungs_text(const StudyFile& file, const Identification& identification) {
    if (!file.has_rungs()) {
        return "<p class=\"warn\">The runs have one resolution: the interval lacks its error. Give search.rungs, three "
               "spacings or more.</p>\n";
    }
    std::string out = "<h2>Resolution</h2>\n<table>";
    std::vector<std::string> head{"spacing"};
    for (std::size_t k = 0; k < file.searched; ++k) head.push_back(file.study.parameters[k].column());
    out += row(head, "th");
    for (const auto& rung : identification.rungs) {
        std::vector<std::string> cells{rung.spacing};
        for (const double value : rung.values) cells.push_back(digits(value, 5));
        out += row(cells);
    }
    out += "</table>\n";
    for (const auto& correction : identification.corrections) out += "<p>" + correction.text + "</p>\n";
    return out;
}

// The masks of a run; empty where there is none or where it did not keep them.
std::filesystem::path masks_of(const std::filesystem::path& run, const Experiment& experiment) {
    const auto masks = run / ("masks_" + experiment.name);
    return !run.empty() && std::filesystem::exists(masks) ? masks : std::filesystem::path();
}

std::string film_text(
    const std::filesystem::path& folder, const StudyFile& file, const Experiment& experiment, const FilmRuns& runs) {
    if (runs.answer.empty()) return ""; // of another study that did not keep them
    const auto film = write_film(folder, file, experiment, runs);
    const std::string first =
        "<p>Below each other: " +
        std::string(film.has_film ? "the film" : "its masks, since the film is no more where it was");
    const std::string rows =
        runs.at_curve.empty()
            ? ", the run, the contours of the film (blue) and of the run (red), and where they differ."
            : ", the run at the answer, the run at the measured curve, and where film and answer, film and curve, "
              "answer and curve differ: grey "
              "where both have liquid, blue where only the first has, red where only the second. In the video the "
              "contours of the film (blue) and of the run at the answer (red).";
    return first + rows + "</p>\n<img class=\"wide\" src=\"" + film.rows + "\" alt=\"" + experiment.name +
           ": film, runs, differences\">\n<p><video class=\"wide\" controls src=\"" + film.overlay +
           "\"></video></p>\n";
}

// With a run at a measured curve the trial at the answer is shown that has the same spacing.
std::string pictures_text(const std::filesystem::path& folder, const StudyFile& file,
    const Identification& identification, const std::function<std::filesystem::path(std::int64_t)>& folder_of,
    const std::optional<Trial>& at_curve) {
    const auto* best = at_curve ? trial_at_answer(file, identification) : best_trial(identification);
    if (!best) return "";
    const std::string shown =
        at_curve ? "At the trial of the finest spacing that is most alike: " : "At the trial that is most alike: ";
    std::string out;
    for (const auto& experiment : file.experiments) {
        const auto scene = std::size_t(&file.scene_of(experiment) - file.study.scenes.data());
        const auto run = folder_of(best->runs[scene]);
        const bool film = has_masks(experiment.kind);
        if (film) {
            out += "<h2>Film and run: " + experiment.name + "</h2>\n" +
                   film_text(folder, file, experiment,
                       {masks_of(run, experiment), at_curve ? masks_of(folder_of(at_curve->runs[scene]), experiment)
                                                            : std::filesystem::path()}) +
                   "<p>" + shown +
                   "grey where both have liquid, blue where only the film has, red where only the run.</p>\n";
        } else if (experiment.kind == ExperimentKind::piv) {
            out += "<h2>Fields: " + experiment.name + "</h2>\n<p>" + shown +
                   "measured, simulated, and the difference, five times as long.</p>\n";
        }
        for (const auto& picture :
            film ? write_pictures(folder, file, experiment, run) : write_field_pictures(folder, experiment, run)) {
            out += "<figure><img src=\"" + picture.file + "\" alt=\"" + picture.caption + "\"><figcaption>" +
                   picture.caption + "</figcaption></figure>\n";
        }
    }
    return out;
}

// The middle half and 90 % of the shear rates of the best trial's runs, over time.
std::string rates_text(const StudyFile& file, const Identification& identification,
    const std::function<std::filesystem::path(std::int64_t)>& folder_of) {
    const auto* best = best_trial(identification);
    if (!best) return "";
    std::string out;
    for (std::size_t i = 0; i < best->runs.size(); ++i) {
        const auto frames = read_frame_shear_rates(folder_of(best->runs[i]));
        if (frames.empty()) continue;
        study::Chart chart;
        chart.title = "Shear rates: " + file.study.scenes[i].name;
        chart.x.label = "time [s]";
        chart.y = {"shear rate [1/s]", study::AxisScale::log};
        for (std::size_t k = 0; k < FrameShearRates::quantile_levels.size(); ++k) {
            auto& line = chart.series.emplace_back();
            line.name = percent(FrameShearRates::quantile_levels[k]);
            line.line = true;
            for (const auto& frame : frames) {
                line.x.push_back(frame.time);
                line.y.push_back(frame.quantiles[k]);
            }
        }
        out += "<p>Shear rates of " + file.study.scenes[i].name +
               " by frame: those below which 5, 25, 50, 75 and 95 % of what it dissipates lie.</p>\n" + svg(chart);
    }
    return out;
}

std::string hidden_text(const std::vector<ReportPicture>& hidden) {
    if (hidden.empty()) return "";
    std::string out =
        "<h2>What the film does not show</h2>\n<p>Pressure and speed at the trial that is most alike.</p>\n";
    for (const auto& one : hidden)
        out += "<figure><img src=\"" + one.file + "\" alt=\"" + one.caption + "\"><figcaption>" + one.caption +
               "</figcaption></figure>\n";
    return out;
}

std::string curves_text(const std::vector<FlowCurveBand>& curves) {
    std::string out;
    for (const auto& curve : curves) {
        out += "<h2>Flow curve: " + curve.liquid + "</h2>\n";
        for (const auto& line : describe(curve)) out += "<p>" + line + "</p>\n";
        out += chart(curve);
    }
    return out;
}

std::string compared_text(const ComparedCurve& compared, const StudyFile& file) {
    std::string out = "<h2>Run at the measured curve</h2>\n";
    for (const auto& line : describe(compared, file)) out += "<p>" + line + "</p>\n";
    return out;
}

std::string curves_yaml(const std::vector<FlowCurveBand>& curves) {
    std::string out = curves.empty() ? "" : "flow_curves:\n";
    for (const auto& curve : curves) out += yaml(curve);
    return out;
}

std::string trial_row(const Trial& trial, std::size_t number) {
    std::string runs;
    for (const auto run : trial.runs) runs += (runs.empty() ? "" : ", ") + std::to_string(run);
    std::vector<std::string> cells{std::to_string(number), trial.purpose, runs};
    for (const double value : trial.values) cells.push_back(std::isnan(value) ? "as measured" : digits(value, 6));
    cells.push_back(trial.bound                   ? "stopped early, E &ge; " + digits(*trial.bound, 4)
                    : std::isnan(trial.objective) ? "failed"
                                                  : digits(trial.objective, 5));
    for (const double one : trial.mismatches) cells.push_back(digits(one, 4));
    return row(cells);
}

std::string html(const StudyFile& file, const Identification& identification, const std::string& pictures,
    const std::optional<Trial>& at_curve) {
    const auto title = file.study.title.empty() ? std::string("Identification") : file.study.title;
    std::string out =
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + title +
        "</title><style>body{font-family:sans-serif;max-width:60em;margin:2em "
        "auto;color:#222}table{border-collapse:collapse}"
        "td,th{padding:.25em .8em;border-bottom:1px solid "
        "#ddd;text-align:left}figure{display:inline-block;margin:.3em}img{max-width:18em;border:1px solid "
        "#ddd}.wide{max-width:100%}.big{font-size:150%}.warn{background:#fff3d6;padding:.6em}</style></"
        "head><body>\n<h1>" +
        title + "</h1>\n";
    for (const auto& line : answer_lines(file, identification)) out += "<p class=\"big\">" + line + "</p>\n";
    for (std::size_t k = 0; k < identification.values.size(); ++k) {
        out += "<p>" + file.study.parameters[k].name + ": " + identifiability(file, identification, k) + "</p>\n";
    }
    for (const auto& line : trade_lines(file, identification)) out += "<p>" + line + "</p>\n";
    for (const auto& note : notes(file)) out += "<p>" + note + "</p>\n";
    const auto said = verdict(file, identification);
    if (!said.empty()) out += "<p class=\"warn\">" + said + "</p>\n";
    out += std::string(file.temperature.stated() ? "<p>" : "<p class=\"warn\">") +
           "Temperature of the liquid: " + file.temperature.text() + ".</p>\n";
    out += "<p>" + identification.stop + "</p>\n";
    if (identification.estimate) {
        const auto& estimate = *identification.estimate;
        out += "<h2>Where the interval comes from</h2>\n<table>";
        std::vector<std::string> head{"parameter"};
        for (const auto& [name, part] : variance_fractions(estimate.parts.front(), file)) head.push_back(name);
        out += row(head, "th");
        for (std::size_t k = 0; k < estimate.parts.size(); ++k) {
            std::vector<std::string> cells{file.study.parameters[k].name};
            for (const auto& [name, part] : variance_fractions(estimate.parts[k], file))
                cells.push_back("&plusmn; " + percent(std::sqrt(part)));
            out += row(cells);
        }
        out += "</table>\n<p>Standard deviations. What is left over is taken as correlated over " +
               std::to_string(estimate.block_frames) + " frames; " + std::to_string(estimate.blocks) +
               " independent blocks.</p>\n";
        for (std::size_t e = 0; e < file.experiments.size(); ++e) {
            const auto& one = file.experiments[e];
            out += "<p>" + one.name + ": a noise of " + digits(estimate.noise[e], 2) + " " + misfit_unit(one.kind) +
                   (has_masks(one.kind) ? " a segment" : "") + ".</p>\n";
            out += svg(misfit_chart(file, estimate, e));
        }
        out += drift_html(file, identification) + rungs_text(file, identification);
    }
    out += pictures + "<h2>The search</h2>\n" + svg(objective_chart(file, identification, {}));
    for (std::size_t e = 0; e < file.experiments.size(); ++e) out += svg(objective_chart(file, identification, e));
    out += svg(convergence_chart(file, identification));
    out += "<h2>Trials</h2>\n<table>";
    std::vector<std::string> head{"trial", "purpose", "runs"};
    for (const auto& parameter : file.study.parameters) head.push_back(parameter.column());
    head.push_back("objective");
    for (const auto& one : file.experiments) head.push_back(mismatch_title(one));
    out += row(head, "th");
    for (std::size_t i = 0; i < identification.trials.size(); ++i) out += trial_row(identification.trials[i], i + 1);
    if (at_curve) out += trial_row(*at_curve, identification.trials.size() + 1);
    return out + "</table>\n</body></html>\n";
}

std::string yaml(const StudyFile& file, const Identification& identification) {
    std::string out = "schema_version: 1\nidentified:\n";
    for (std::size_t k = 0; k < identification.values.size(); ++k) {
        const auto& parameter = file.study.parameters[k];
        const auto& parts = identification.estimate->parts[k];
        out += "  - name: " + parameter.name + "\n    key: " + parameter.key +
               "\n    value: " + parameter.word(identification.values[k]) + "\n    identifiability: \"" +
               identifiability(file, identification, k) + "\"\n    interval_90: [" +
               parameter.word(identification.low[k]) + ", " + parameter.word(identification.high[k]) +
               "]\n    deviations:\n";
        for (const auto& [name, part] : variance_fractions(parts, file))
            out += "      " + name + ": " + format_number(std::sqrt(part)) + "\n";
        out += "    if_pixels_were_independent: " + format_number(identification.estimate->naive[k]) + "\n";
    }
    if (identification.estimate) {
        out += "misfits:\n";
        for (std::size_t e = 0; e < file.experiments.size(); ++e) {
            out += "  - {name: " + file.experiments[e].name + ", " + misfit_unit(file.experiments[e].kind) + ": " +
                   format_number(misfit_of(*identification.estimate, e)) + "}\n";
        }
    }
    out += drift_yaml(file, identification);
    if (file.temperature.stated())
        out += "temperature: " + file.temperature.value + "\ntemperature_plus_minus: " + file.temperature.plus_minus +
               "\n";
    out += "trials: " + std::to_string(identification.trials.size()) + "\n";
    if (!identification.problem.empty()) out += "problem: \"" + identification.problem + "\"\n";
    return out;
}
} // namespace

namespace {
// Experiments of set-ups that have no other clip, where no set-up has several: else these are taken to scatter alike.
std::vector<std::string> observed_once(const StudyFile& file) {
    std::vector<std::string> out;
    for (const auto& one : file.experiments) {
        if (!one.repeats.empty()) return {};
        out.push_back(one.name);
    }
    return out;
}
} // namespace

std::string verdict(const StudyFile& file, const Identification& identification) {
    if (!identification.estimate) return "";
    std::string out;
    for (std::size_t e = 0; e < file.experiments.size(); ++e) {
        const auto& one = file.experiments[e];
        const double misfit = misfit_of(*identification.estimate, e), usual = usual_noise(one.kind);
        if (misfit <= 1.5 * usual) continue;
        const std::string what = one.kind == ExperimentKind::contours ? "the video: the contours differ"
                                 : one.kind == ExperimentKind::occupancy
                                     ? "how often pixels are liquid: the contours differ"
                                 : one.kind == ExperimentKind::piv ? "the fields: velocities differ"
                                                                   : "the series: values differ";
        out += (out.empty() ? "" : " ") + std::string("The model does not explain ") + what + " by " +
               digits(misfit, 2) + " " + misfit_unit(one.kind) + " at the best values, where " + digits(usual, 2) +
               (one.kind == ExperimentKind::contours ? " px are" : " is") + " usual (" + one.name +
               "). The interval holds if what is left over is without a trend in time; look at the frames.";
    }
    return out;
}

std::vector<std::string> notes(const StudyFile& file) {
    std::vector<std::string> out;
    if (const auto once = observed_once(file); !once.empty()) {
        out.push_back("Observed once: " + join(once, ", ") +
                      ". Filled and filmed anew, the answer would be another by what differs from one time to the next "
                      "(how the liquid "
                      "is let go, what it did before, its temperature), which one clip does not tell: the interval "
                      "lacks it. Three clips tell it; name the first of them under `repeats`.");
    }
    if (std::ranges::any_of(
            file.study.parameters, [](const auto& one) { return one.key.ends_with(".surface_tension"); })) {
        out.push_back("Runs have the surface tension, but no angle at which the liquid meets walls: edges that wetting "
                      "drives or holds, thinner than the capillary length, "
                      "may move otherwise.");
    }
    const bool falls = std::ranges::any_of(
        file.experiments, [](const auto& one) { return one.kind == ExperimentKind::piv && !prescribes(one); });
    if (!falls) return out;
    std::string note = "Where a body falls freely, the viscosity that is found is proportional to its density less "
                       "that of the liquid, and to the square of its size";
    const bool told = std::ranges::any_of(file.study.parameters.begin() + std::ptrdiff_t(file.searched),
        file.study.parameters.end(), [](const auto& one) { return one.key.ends_with(".density"); });
    out.push_back(note + (told ? "." : ": the interval lacks both. Give them under `measured` with their plus_minus."));
    return out;
}

void write_report(const std::filesystem::path& folder, const StudyFile& file, const Identification& identification,
    const std::function<std::filesystem::path(std::int64_t)>& folder_of, const ReportParts& parts) {
    std::filesystem::create_directories(folder);
    const auto at_curve = parts.compared ? parts.compared->trial : std::nullopt;
    const auto pictures = pictures_text(folder, file, identification, folder_of, at_curve);
    write_file_atomically(folder / "result.yaml", yaml(file, identification) + curves_yaml(parts.curves) +
                                                      (parts.compared ? yaml(*parts.compared, file) : "") +
                                                      yaml(parts.materials));
    write_file_atomically(folder / "index.html",
        html(file, identification,
            curves_text(parts.curves) + (parts.compared ? compared_text(*parts.compared, file) : "") +
                rates_text(file, identification, folder_of) + pictures + hidden_text(parts.hidden),
            at_curve));
}

} // namespace treacle::identify
