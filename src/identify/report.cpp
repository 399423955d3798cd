#include "identify/report.hpp"

#include "base/file.hpp"
#include "base/text.hpp"
#include "identify/report_pictures.hpp"
#include "study/chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace treacle::identify {

namespace {
constexpr double usual_noise = 0.5; // [px] of a contour that image processing finds

std::string digits(double value, int count = 4) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", count, value);
    return text;
}

double misfit_of(const Estimate& estimate) {
    double sum = 0;
    for (const double one : estimate.misfit) sum += one * one;
    return estimate.misfit.empty() ? 0 : std::sqrt(sum / double(estimate.misfit.size()));
}

std::string percent(double share) { return digits(100 * share, 2) + " %"; }

std::string row(const std::vector<std::string>& cells, const char* tag = "td") {
    std::string out = "<tr>";
    for (const auto& cell : cells) out += std::string("<") + tag + ">" + cell + "</" + tag + ">";
    return out + "</tr>\n";
}

study::Chart objective_chart(const StudyFile& file, const Identification& identification, bool mismatch) {
    const auto& parameter = file.study.parameters.front();
    study::Chart chart;
    chart.title = mismatch ? "Share of pixels that differ, halved (6.9)" : "Objective of contour displacements";
    chart.x = {parameter.column(), parameter.scale == study::Scale::log ? study::AxisScale::log : study::AxisScale::linear};
    chart.y = {mismatch ? "E" : "objective", study::AxisScale::log};
    study::ChartSeries dots;
    for (const auto& trial : identification.trials) {
        if (trial.purpose != "search" && trial.purpose != "around the answer") continue; // of another spacing or measured value
        dots.x.push_back(trial.values.front());
        dots.y.push_back(mismatch ? trial.mismatch : trial.objective);
    }
    chart.series.push_back(dots);
    return chart;
}

study::Chart misfit_chart(const Estimate& estimate) {
    study::Chart chart;
    chart.title = "Displacement left over by frame";
    chart.x.label = "time [s]";
    chart.y.label = "root mean square [px]";
    study::ChartSeries line;
    line.x = estimate.times;
    line.y = estimate.misfit;
    line.line = true;
    chart.series.push_back(line);
    return chart;
}

study::Chart convergence_chart(const StudyFile& file, const Identification& identification) {
    study::Chart chart;
    const auto& parameter = file.study.parameters.front();
    chart.title = "Search";
    chart.x.label = "trial";
    chart.y = {parameter.column(), parameter.scale == study::Scale::log ? study::AxisScale::log : study::AxisScale::linear};
    study::ChartSeries line;
    for (std::size_t i = 0; i < identification.trials.size(); ++i) {
        line.x.push_back(double(i + 1));
        line.y.push_back(identification.trials[i].values.front());
    }
    auto dots = line;
    line.line = true;
    chart.series = {line, dots};
    return chart;
}

// The parts of a variance by their names, the sum last.
std::vector<std::pair<std::string, double>> shares(const VarianceParts& parts, bool rungs) {
    std::vector<std::pair<std::string, double>> out{{"pixels", parts.pixels}, {"time zero", parts.time}, {"contour", parts.contour}, {"camera", parts.camera}};
    if (rungs) out.insert(out.end(), {{"resolution", parts.resolution}, {"noise", parts.noise}});
    out.insert(out.end(), parts.measured.begin(), parts.measured.end());
    out.emplace_back("all", parts.total());
    return out;
}

std::string rungs_text(const StudyFile& file, const Identification& identification) {
    if (!file.has_rungs()) {
        return "<p class=\"warn\">The runs have one resolution: the interval lacks its error. Give search.rungs, three spacings or more.</p>\n";
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

// The trial that looks most like the films; null without one.
const Trial* best_trial(const Identification& identification) {
    const Trial* best = nullptr;
    for (const auto& trial : identification.trials) {
        if (!std::isnan(trial.objective) && (!best || trial.objective < best->objective)) best = &trial;
    }
    return best;
}

std::string pictures_text(const std::filesystem::path& folder, const StudyFile& file, const Identification& identification,
                          const std::function<std::filesystem::path(std::int64_t)>& folder_of) {
    const auto* best = best_trial(identification);
    if (!best) return "";
    std::string out = "<h2>Film and run</h2>\n<p>At the trial that is most alike: grey where both have liquid, blue where only the film has, red where only the run.</p>\n";
    for (const auto& experiment : file.experiments) {
        const auto scene = std::size_t(&file.scene_of(experiment) - file.study.scenes.data());
        for (const auto& picture : write_pictures(folder, file, experiment, folder_of(best->runs[scene]))) {
            out += "<figure><img src=\"" + picture.file + "\" alt=\"" + picture.caption + "\"><figcaption>" + picture.caption + "</figcaption></figure>\n";
        }
    }
    return out;
}

std::string html(const StudyFile& file, const Identification& identification, const std::string& pictures) {
    const auto title = file.study.title.empty() ? std::string("Identification") : file.study.title;
    std::string out = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + title +
                      "</title><style>body{font-family:sans-serif;max-width:60em;margin:2em auto;color:#222}table{border-collapse:collapse}"
                      "td,th{padding:.25em .8em;border-bottom:1px solid #ddd;text-align:left}figure{display:inline-block;margin:.3em}img{max-width:18em;border:1px solid #ddd}.big{font-size:150%}.warn{background:#fff3d6;padding:.6em}</style></head><body>\n<h1>" +
                      title + "</h1>\n";
    for (const auto& line : answer_lines(file, identification)) out += "<p class=\"big\">" + line + "</p>\n";
    for (std::size_t k = 0; k < identification.values.size(); ++k) {
        out += "<p>" + file.study.parameters[k].name + ": " + identifiability(file, identification, k) + "</p>\n";
    }
    const auto said = verdict(identification);
    if (!said.empty()) out += "<p class=\"warn\">" + said + "</p>\n";
    out += std::string(file.temperature.stated() ? "<p>" : "<p class=\"warn\">") + "Temperature of the liquid: " + file.temperature.text() + ".</p>\n";
    out += "<p>" + identification.stop + "</p>\n";
    if (identification.estimate) {
        const auto& estimate = *identification.estimate;
        out += "<h2>Where the interval comes from</h2>\n<table>";
        std::vector<std::string> head{"parameter"};
        for (const auto& [name, part] : shares(estimate.parts.front(), file.has_rungs())) head.push_back(name);
        out += row(head, "th");
        for (std::size_t k = 0; k < estimate.parts.size(); ++k) {
            std::vector<std::string> cells{file.study.parameters[k].name};
            for (const auto& [name, part] : shares(estimate.parts[k], file.has_rungs())) cells.push_back("&plusmn; " + percent(std::sqrt(part)));
            out += row(cells);
        }
        out += "</table>\n<p>Standard deviations. Displacements are taken as correlated over " + std::to_string(estimate.block_frames) +
               " frames; " + std::to_string(estimate.blocks) + " independent blocks, a noise of " + digits(estimate.noise, 2) + " px a segment.</p>\n";
        out += svg(misfit_chart(estimate));
        out += rungs_text(file, identification);
    }
    out += pictures + "<h2>The search</h2>\n" + svg(objective_chart(file, identification, false)) + svg(objective_chart(file, identification, true)) +
           svg(convergence_chart(file, identification));
    out += "<h2>Trials</h2>\n<table>";
    std::vector<std::string> head{"trial", "purpose", "runs"};
    for (const auto& parameter : file.study.parameters) head.push_back(parameter.column());
    head.insert(head.end(), {"objective", "E (6.9)"});
    out += row(head, "th");
    for (std::size_t i = 0; i < identification.trials.size(); ++i) {
        const auto& trial = identification.trials[i];
        std::string runs;
        for (const auto run : trial.runs) runs += (runs.empty() ? "" : ", ") + std::to_string(run);
        std::vector<std::string> cells{std::to_string(i + 1), trial.purpose, runs};
        for (const double value : trial.values) cells.push_back(digits(value, 6));
        cells.insert(cells.end(), {std::isnan(trial.objective) ? "failed" : digits(trial.objective, 5), std::isnan(trial.mismatch) ? "" : digits(trial.mismatch, 4)});
        out += row(cells);
    }
    return out + "</table>\n</body></html>\n";
}

std::string yaml(const StudyFile& file, const Identification& identification) {
    std::string out = "schema_version: 1\nidentified:\n";
    for (std::size_t k = 0; k < identification.values.size(); ++k) {
        const auto& parameter = file.study.parameters[k];
        const auto& parts = identification.estimate->parts[k];
        out += "  - name: " + parameter.name + "\n    key: " + parameter.key + "\n    value: " + parameter.word(identification.values[k]) +
               "\n    identifiability: \"" + identifiability(file, identification, k) +
               "\"\n    interval_90: [" + parameter.word(identification.low[k]) + ", " + parameter.word(identification.high[k]) + "]\n    deviations:\n";
        for (const auto& [name, part] : shares(parts, file.has_rungs())) out += "      " + name + ": " + format_number(std::sqrt(part)) + "\n";
    }
    if (identification.estimate) out += "misfit_px: " + format_number(misfit_of(*identification.estimate)) + "\n";
    if (file.temperature.stated()) out += "temperature: " + file.temperature.value + "\ntemperature_plus_minus: " + file.temperature.plus_minus + "\n";
    out += "trials: " + std::to_string(identification.trials.size()) + "\n";
    if (!identification.problem.empty()) out += "problem: \"" + identification.problem + "\"\n";
    return out;
}
} // namespace

std::vector<std::string> answer_lines(const StudyFile& file, const Identification& identification) {
    std::vector<std::string> out;
    for (std::size_t k = 0; k < identification.values.size(); ++k) {
        const auto& parameter = file.study.parameters[k];
        const auto unit = parameter.unit.empty() ? "" : " " + parameter.unit;
        out.push_back(parameter.name + " = " + digits(identification.values[k]) + unit + ", 90 % interval " + digits(identification.low[k]) + " to " +
                      digits(identification.high[k]) + unit);
    }
    if (out.empty()) out.push_back("nothing is identified" + (identification.problem.empty() ? "" : ": " + identification.problem));
    return out;
}

std::string identifiability(const StudyFile& file, const Identification& identification, std::size_t k) {
    const auto& parameter = file.study.parameters[k];
    const double value = identification.values[k], low = identification.low[k], high = identification.high[k];
    const double span = parameter.upper - parameter.lower;
    const auto near = [&](double end) {
        return parameter.scale == study::Scale::log ? std::abs(std::log(value / end)) < 0.02 : std::abs(value - end) < 0.01 * span;
    };
    if (near(parameter.lower)) return "at the lower end of its range: widen the range, or the film does not tell it";
    if (near(parameter.upper)) return "at the upper end of its range: widen the range, or the film does not tell it";
    if (low <= parameter.lower && high >= parameter.upper) return "not determined: the interval is as wide as the range";
    if (low <= parameter.lower) return "an upper limit alone: everything down to the lower end of the range looks alike";
    if (high >= parameter.upper) return "a lower limit alone: everything up to the upper end of the range looks alike";
    const double wide = parameter.scale == study::Scale::log ? high / low > 4 : high - low > 0.5 * span;
    return wide ? "poorly determined: a film of faster flow, of more of it, or from nearer by tells more" : "well determined";
}

std::string verdict(const Identification& identification) {
    if (!identification.estimate) return "";
    const double misfit = misfit_of(*identification.estimate);
    if (misfit <= 1.5 * usual_noise) return "";
    return "The model does not explain the video: the contours differ by " + digits(misfit, 2) + " px at the best values, where " + digits(usual_noise, 2) +
           " px are usual. The interval holds if what is left over is without a trend in time; look at the frames.";
}

void write_report(const std::filesystem::path& folder, const StudyFile& file, const Identification& identification,
                  const std::function<std::filesystem::path(std::int64_t)>& folder_of) {
    std::filesystem::create_directories(folder);
    const auto pictures = pictures_text(folder, file, identification, folder_of);
    write_file_atomically(folder / "result.yaml", yaml(file, identification));
    write_file_atomically(folder / "index.html", html(file, identification, pictures));
}

} // namespace treacle::identify
