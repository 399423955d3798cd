#include "identify/report/report_drift.hpp"

#include "base/text/text.hpp"
#include "identify/experiment/digits.hpp"

#include <cmath>

namespace treacle::identify {

namespace {
bool is_log(const StudyFile& file) { return file.study.parameters.front().scale == study::Scale::log; }

double value_at(const StudyFile& file, const Identification& identification, double change) {
    const double value = identification.values.front();
    return is_log(file) ? value * std::exp(change) : value + change;
}

std::string text_of(const StudyFile& file, double change) {
    return is_log(file) ? digits(100 * change, 3) + " %" : digits(change, 3);
}

std::string interval(const WindowAnswer& window) {
    return digits(window.from, 3) + " to " + digits(window.to, 3) + " s";
}

// Beyond what noise, the grid and the runs' scatter do; a grid may err the other way at the end of a flow than at its start.
bool is_drift(const StudyFile& file, const Estimate& estimate, const Drift& drift) {
    if (drift.windows.empty()) return false;
    const auto& parts = estimate.parts.front();
    const double deviation = std::sqrt(drift.deviation * drift.deviation + 4 * (parts.resolution + parts.noise));
    constexpr double little = 0.05; // of a viscosity
    return std::abs(drift.change) > 3 * deviation && (!is_log(file) || std::abs(drift.change) > little);
}

std::string cause(bool rises) {
    return rises ? "a liquid that thins under shear, or yields, is thicker as its flow slows, and so is one that cools"
                 : "a liquid that warms, or breaks down while it is sheared, is thinner as time goes on, and a gate "
                   "that holds the first frames back looks so";
}
} // namespace

std::vector<std::string> drift_lines(const StudyFile& file, const Identification& identification) {
    std::vector<std::string> out;
    if (!identification.estimate) return out;
    const auto& drifts = identification.estimate->drifts;
    for (std::size_t e = 0; e < drifts.size(); ++e) {
        const auto& drift = drifts[e];
        if (!is_drift(file, *identification.estimate, drift)) continue;
        const auto& first = drift.windows.front();
        const auto& last = drift.windows.back();
        const auto& parameter = file.study.parameters.front();
        out.push_back("The best " + parameter.name + " " + (drift.change > 0 ? "rises" : "falls") +
                      " over the frames of " + file.experiments[e].name + ", from " +
                      digits(value_at(file, identification, first.change), 3) + " (" + interval(first) + ") to " +
                      digits(value_at(file, identification, last.change), 3) + " (" + interval(last) + "), by " +
                      text_of(file, drift.change) + " +- " + text_of(file, drift.deviation) + ": " +
                      cause(drift.change > 0) + "; a camera that moved may look like either.");
    }
    return out;
}

std::string drift_html(const StudyFile& file, const Identification& identification) {
    std::string out;
    if (!identification.estimate) return out;
    const auto& parameter = file.study.parameters.front();
    for (std::size_t e = 0; e < identification.estimate->drifts.size(); ++e) {
        const auto& drift = identification.estimate->drifts[e];
        if (drift.windows.empty()) continue;
        out += "<p>" + file.experiments[e].name + ", the best " + parameter.column() +
               " by time:</p>\n<table><tr><th>frames</th><th>best</th><th>&plusmn;</th></tr>\n";
        for (const auto& window : drift.windows) {
            out += "<tr><td>" + interval(window) + "</td><td>" +
                   digits(value_at(file, identification, window.change), 3) + "</td><td>" +
                   text_of(file, window.deviation) + "</td></tr>\n";
        }
        out += "</table>\n";
    }
    for (const auto& line : drift_lines(file, identification)) out += "<p class=\"warn\">" + line + "</p>\n";
    return out;
}

std::string drift_yaml(const StudyFile& file, const Identification& identification) {
    std::string out;
    if (!identification.estimate) return out;
    for (std::size_t e = 0; e < identification.estimate->drifts.size(); ++e) {
        const auto& drift = identification.estimate->drifts[e];
        if (drift.windows.empty()) continue;
        if (out.empty()) out = "by_time:\n";
        out += "  - name: " + file.experiments[e].name + "\n    first_to_last: " + format_number(drift.change) +
               "\n    deviation: " + format_number(drift.deviation) + "\n    windows:\n";
        for (const auto& window : drift.windows) {
            out += "      - {from: " + format_number(window.from) + " s, to: " + format_number(window.to) +
                   " s, value: " + file.study.parameters.front().word(value_at(file, identification, window.change)) +
                   ", deviation: " + format_number(window.deviation) + "}\n";
        }
    }
    return out;
}

} // namespace treacle::identify
