#include "identify/material/compared_curve.hpp"

#include "identify/experiment/digits.hpp"

#include <cmath>

namespace treacle::identify {

namespace {
std::string short_text(double value) { return digits(value, 3); }
std::string yaml_number(double value) { return std::isfinite(value) ? digits(value, 6) : "null"; }

std::string quoted(std::string text) {
    for (auto& c : text) c = c == '"' || c == '\\' || c == '\n' ? '\'' : c;
    return "\"" + text + "\"";
}
} // namespace

std::vector<std::string> describe(const ComparedCurve& compared, const StudyFile& file) {
    std::vector<std::string> out;
    if (compared.fit) {
        const auto& fit = *compared.fit;
        out.push_back("The measured curve of " + compared.liquid + " as a Herschel-Bulkley law: " + describe(fit) +
                      "; " + short_text(100 * fit.rms) + " % from its " + std::to_string(fit.points) + " points from " +
                      short_text(fit.from) + " to " + short_text(fit.to) + " 1/s (root mean square of logarithms).");
    }
    for (std::size_t e = 0; e < compared.misfits.size(); ++e) {
        const auto& one = file.experiments[e];
        const std::string unit = misfit_unit(one.kind);
        const auto off = [&](double misfit) {
            return std::isfinite(misfit) ? short_text(misfit) + " " + unit + " off" : "not comparable at all";
        };
        out.push_back(one.name + ": the run at the measured curve is " + off(compared.misfits[e]) +
                      ", that at the answer " + off(compared.at_answer[e]) + ", each at the view that suits it best.");
    }
    if (!compared.problem.empty()) out.push_back("The run at the measured curve is lacking: " + compared.problem + ".");
    return out;
}

std::string yaml(const ComparedCurve& compared, const StudyFile& file) {
    std::string out = "compared_curve:\n";
    if (!compared.liquid.empty()) out += "  liquid: " + compared.liquid + "\n";
    if (compared.fit) {
        const auto& fit = *compared.fit;
        out += "  fit: {consistency: " + yaml_number(fit.consistency) +
               " Pa.s, exponent: " + yaml_number(fit.exponent) + ", yield_stress: " + yaml_number(fit.yield_stress) +
               " Pa, rms: " + yaml_number(fit.rms) + ", from: " + yaml_number(fit.from) +
               " 1/s, to: " + yaml_number(fit.to) + " 1/s, points: " + std::to_string(fit.points) + "}\n";
    }
    if (!compared.misfits.empty()) out += "  misfits:\n";
    for (std::size_t e = 0; e < compared.misfits.size(); ++e) {
        out += "    - {name: " + file.experiments[e].name + ", unit: " + misfit_unit(file.experiments[e].kind) +
               ", curve: " + yaml_number(compared.misfits[e]) + ", answer: " + yaml_number(compared.at_answer[e]) +
               "}\n";
    }
    if (!compared.problem.empty()) out += "  problem: " + quoted(compared.problem) + "\n";
    return out;
}

} // namespace treacle::identify
