#include "app/study/measured_fractions.hpp"

#include "app/input/table_text.hpp"
#include "base/text/file.hpp"
#include "base/text/text.hpp"
#include "identify/experiment/digits.hpp"

#include <cmath>
#include <map>
#include <optional>
#include <sstream>

namespace treacle::app {

namespace {
constexpr double usual_rest = 0.02; // of film, camera and resolution together, before any run
constexpr double aim = 0.01;        // that one measured value may add

// Standard deviations of the first parameter's logarithm by their names, of a result.yaml; empty without one.
std::map<std::string, double> deviations_of(const std::filesystem::path& result) {
    std::map<std::string, double> out;
    std::istringstream text(read_file(result));
    bool inside = false;
    for (std::string line; std::getline(text, line);) {
        const bool part = line.starts_with("      ");
        if (inside && !part) break;
        if (const auto colon = line.find(": "); inside && colon != std::string::npos)
            out[line.substr(6, colon - 6)] = read_number(line.substr(colon + 2)).value_or(0);
        inside = inside || line.starts_with("    deviations:");
    }
    return out;
}

std::string percent(double value) { return short_number(std::round(1000 * value) / 10) + " %"; }

struct Part {
    const study::Parameter* parameter = nullptr;
    double deviation = 0;         // in its unit
    std::optional<double> effect; // standard deviation that it adds to the logarithm
};
} // namespace

std::vector<LabelledLine> measured_fractions(const identify::StudyFile& file, const std::filesystem::path& result) {
    const auto found = deviations_of(result);
    std::vector<Part> parts;
    double sum = 0;
    for (std::size_t m = 0; m < file.measured; ++m) {
        const auto& parameter = file.study.parameters[file.searched + m];
        const double value = *parameter.number(parameter.values.front());
        Part part{&parameter, file.deviations[m], {}};
        if (const auto known = found.find(parameter.name); known != found.end()) {
            part.effect = known->second;
        } else if (file.exponents[m] != 0 && value != 0) {
            part.effect = std::abs(file.exponents[m] * part.deviation / value);
        }
        sum += part.effect ? *part.effect * *part.effect : 0;
        parts.push_back(part);
    }
    sum += file.temperature.deviation() * file.temperature.deviation();
    const auto all = found.find("all");
    const double total = all == found.end() ? sum + usual_rest * usual_rest : std::max(sum, all->second * all->second);
    std::vector<LabelledLine> out{{"", std::string("measured values, one standard deviation each, ") +
                                           (found.empty() ? "by textbook powers" : "by " + result.string())}};
    for (const auto& part : parts) {
        const auto& parameter = *part.parameter;
        auto line = parameter.values.front() + " +- " + parameter.word(part.deviation) + ": ";
        if (!part.effect) {
            out.emplace_back(parameter.name, line + "not known before a run of its own");
            continue;
        }
        line += percent(*part.effect) + " of " + file.study.parameters.front().name + ", " +
                percent(*part.effect * *part.effect / total) + " of its variance";
        if (*part.effect > aim)
            line += "; measure it to +- " + identify::digits(part.deviation * aim / *part.effect, 2) +
                    (parameter.unit.empty() ? "" : " " + parameter.unit) + " for 1 %";
        out.emplace_back(parameter.name, line);
    }
    const double warmth = file.temperature.deviation();
    out.emplace_back("temperature",
        file.temperature.text() + (warmth > 0 ? ": " + percent(warmth) + " of " + file.study.parameters.front().name +
                                                    ", " + percent(warmth * warmth / total) + " of its variance"
                                              : ""));
    const double rest = std::max(0.0, total - sum);
    out.emplace_back("film, camera, resolution", percent(std::sqrt(rest)) + ", " + percent(rest / total) +
                                                     " of its variance" + (all == found.end() ? ", as is usual" : ""));
    out.emplace_back("90 % interval", "about +- " + percent(1.645 * std::sqrt(total)));
    return out;
}

} // namespace treacle::app
