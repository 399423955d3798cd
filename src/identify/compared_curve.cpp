#include "identify/compared_curve.hpp"

#include "base/text.hpp"

#include <cmath>
#include <cstdio>

namespace treacle::identify {

namespace {
std::string short_text(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

std::string number_or_null(double value) { return std::isfinite(value) ? format_number(value) : "null"; }

std::string quoted(std::string text) {
    for (auto& c : text) c = c == '"' || c == '\\' || c == '\n' ? '\'' : c;
    return "\"" + text + "\"";
}
} // namespace

std::vector<std::string> describe(const ComparedCurve& compared, const StudyFile& file) {
    std::vector<std::string> out;
    if (compared.fit) {
        const auto& fit = *compared.fit;
        out.push_back("The measured curve of " + compared.liquid + " as a Herschel-Bulkley law: " + describe(fit) + "; " + short_text(100 * fit.rms) + " % from its " +
                      std::to_string(fit.points) + " points from " + short_text(fit.from) + " to " + short_text(fit.to) + " 1/s (root mean square of logarithms).");
    }
    for (std::size_t e = 0; e < compared.misfits.size(); ++e) {
        const auto& one = file.experiments[e];
        const std::string unit = misfit_unit(one.kind);
        const auto off = [&](double misfit) { return std::isfinite(misfit) ? short_text(misfit) + " " + unit + " off" : "not comparable at all"; };
        out.push_back(one.name + ": the run at the measured curve is " + off(compared.misfits[e]) + ", that at the answer " + off(compared.at_answer[e]) + ".");
    }
    if (!compared.problem.empty()) out.push_back("The run at the measured curve is lacking: " + compared.problem + ".");
    return out;
}

std::string yaml(const ComparedCurve& compared, const StudyFile& file) {
    std::string out = "compared_curve:\n";
    if (!compared.liquid.empty()) out += "  liquid: " + compared.liquid + "\n";
    if (compared.fit) {
        const auto& fit = *compared.fit;
        out += "  fit: {consistency: " + format_number(fit.consistency) + " Pa.s, exponent: " + format_number(fit.exponent) + ", yield_stress: " + format_number(fit.yield_stress) +
               " Pa, rms: " + format_number(fit.rms) + ", from: " + format_number(fit.from) + " 1/s, to: " + format_number(fit.to) + " 1/s, points: " + std::to_string(fit.points) + "}\n";
    }
    if (!compared.misfits.empty()) out += "  misfits:\n";
    for (std::size_t e = 0; e < compared.misfits.size(); ++e) {
        out += "    - {name: " + file.experiments[e].name + ", unit: " + misfit_unit(file.experiments[e].kind) + ", curve: " + number_or_null(compared.misfits[e]) +
               ", answer: " + number_or_null(compared.at_answer[e]) + "}\n";
    }
    if (!compared.problem.empty()) out += "  problem: " + quoted(compared.problem) + "\n";
    return out;
}

} // namespace treacle::identify
