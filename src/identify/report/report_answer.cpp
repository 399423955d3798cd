#include "identify/answer/profile.hpp"
#include "identify/estimate/directions.hpp"
#include "identify/experiment/digits.hpp"
#include "identify/report/report.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

std::vector<std::string> answer_lines(const StudyFile& file, const Identification& identification) {
    std::vector<std::string> out;
    for (std::size_t k = 0; k < identification.values.size(); ++k) {
        const auto& parameter = file.study.parameters[k];
        const auto unit = parameter.unit.empty() ? "" : " " + parameter.unit;
        out.push_back(parameter.name + " = " + digits(identification.values[k]) + unit + ", 90 % interval " +
                      digits(identification.low[k]) + " to " + digits(identification.high[k]) + unit);
    }
    if (out.empty())
        out.push_back("nothing is identified" + (identification.problem.empty() ? "" : ": " + identification.problem));
    return out;
}

std::string identifiability(const StudyFile& file, const Identification& identification, std::size_t k) {
    const auto& parameter = file.study.parameters[k];
    const double value = identification.values[k], low = identification.low[k], high = identification.high[k];
    const double span = parameter.upper - parameter.lower;
    const auto near = [&](double end) {
        return parameter.scale == study::Scale::log ? std::abs(std::log(value / end)) < 0.02
                                                    : std::abs(value - end) < 0.01 * span;
    };
    const bool prescribed = std::ranges::all_of(file.experiments, prescribes);
    const std::string unknown = prescribed ? "not identifiable: " : "";
    const std::string why = prescribed ? "; where a body follows a prescribed path slowly, the flow around it does not "
                                         "depend on the viscosity: let it fall freely, or move it faster"
                                       : "";
    const std::string subject =
        std::ranges::all_of(file.experiments, [](const auto& one) { return has_masks(one.kind); })
            ? "the film does not tell it"
            : "the measurement does not tell it";
    if (low <= parameter.lower && high >= parameter.upper)
        return "not identifiable: the interval is as wide as the range" + why;
    if (near(parameter.lower)) return unknown + "at the lower end of its range: widen the range, or " + subject + why;
    if (near(parameter.upper)) return unknown + "at the upper end of its range: widen the range, or " + subject + why;
    if (low <= parameter.lower)
        return unknown + "an upper limit alone: everything down to the lower end of the range looks alike" + why;
    if (high >= parameter.upper)
        return unknown + "a lower limit alone: everything up to the upper end of the range looks alike" + why;
    const bool wide = parameter.scale == study::Scale::log ? high / low > 4 : high - low > 0.5 * span;
    if (!wide) return well_determined;
    return prescribed ? "not identifiable: within a factor of " + digits(high / low, 2) + why
                      : "poorly determined: a film of faster flow, of more of it, or from nearer by tells more";
}

std::vector<std::string> trade_lines(const StudyFile& file, const Identification& identification) {
    if (!identification.estimate) return {};
    std::vector<std::string> names;
    for (std::size_t k = 0; k < file.searched; ++k) names.push_back(file.study.parameters[k].name);
    return trades(names, identification.covariance);
}

} // namespace treacle::identify
