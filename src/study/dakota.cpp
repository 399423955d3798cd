#include "study/dakota.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <fstream>
#include <sstream>

namespace treacle::study {

namespace {
// Value and label of a line: "12.5 viscosity", or { viscosity = 12.5 }.
std::pair<std::string, std::string> value_and_label(std::string line) {
    const auto equals = line.find('=');
    if (line.find('{') != std::string::npos && equals != std::string::npos) {
        for (auto& c : line) c = c == '{' || c == '}' || c == '=' || c == '"' ? ' ' : c;
        std::istringstream words(line);
        std::string label, value;
        words >> label >> value;
        return {value, label};
    }
    std::istringstream words(line);
    std::string value, label;
    words >> value >> label;
    return {value, label};
}
} // namespace

DakotaParameters read_dakota_parameters(const std::filesystem::path& path) {
    std::ifstream file(path);
    if (!file)
        throw InputError({path.string(), "cannot be read", "Dakota writes the variables into it", "check its name"});
    DakotaParameters out;
    int count = -1, number = 0;
    for (std::string line; std::getline(file, line);) {
        ++number;
        const auto [value, label] = value_and_label(line);
        if (value.empty()) continue;
        const auto where = path.string() + ":" + std::to_string(number);
        if (label.empty())
            throw InputError({where, "has no label: " + shorten(line), "a line is a value and its label",
                "see params.in of `treacle sweep --ask`"});
        if (count < 0) {
            const auto words = read_number(value);
            if ((label != "variables" && label != "DAKOTA_VARS") || !words) {
                throw InputError({where, "is not the number of variables",
                    "a parameters file of Dakota's begins with it", "write for instance: 2 variables"});
            }
            count = int(*words);
        } else if (int(out.variables.size()) < count) {
            out.variables.emplace_back(label, value);
        } else if (label == "eval_id" || label == "DAKOTA_EVAL_ID") {
            out.evaluation = int(read_number(value.substr(value.rfind(':') + 1)).value_or(0));
        }
    }
    if (count < 0 || int(out.variables.size()) < count) {
        throw InputError({path.string(), "is not whole",
            "it has " + std::to_string(out.variables.size()) + " of " + std::to_string(std::max(0, count)) +
                " variables",
            "write it again"});
    }
    return out;
}

} // namespace treacle::study
