#include "video/number_table.hpp"

#include "base/error.hpp"
#include "base/text.hpp"

#include <fstream>
#include <sstream>

namespace treacle::video {

namespace {
std::string trim(const std::string& text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> words;
    std::istringstream stream(line);
    for (std::string word; std::getline(stream, word, ',');) words.push_back(trim(word));
    return words;
}
} // namespace

const std::vector<double>& NumberTable::column(const std::string& name) const {
    if (const auto found = columns.find(name); found != columns.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& [key, values] : columns) names.push_back(key);
    throw InputError({path.string(), "has no column " + name, "its columns are " + join(names, ", "),
                      "name the column in the first line"});
}

NumberTable read_number_table(const std::filesystem::path& path) {
    std::ifstream file(path);
    if (!file) throw InputError({path.string(), "cannot be read", "", "check its name"});
    NumberTable table{path, {}};
    std::vector<std::string> names;
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        line = trim(line);
        if (line.empty() || line.front() == '#') continue;
        const auto words = split(line);
        if (names.empty()) {
            for (const auto& word : words) names.push_back(trim(word.substr(0, word.find('['))));
            for (const auto& name : names) table.columns[name];
            continue;
        }
        const auto where = path.string() + ":" + std::to_string(number);
        if (words.size() != names.size())
            throw InputError({where, "has " + std::to_string(words.size()) + " values",
                              "the header names " + std::to_string(names.size()), "give one for each column"});
        for (std::size_t i = 0; i < words.size(); ++i) {
            const auto value = read_number(words[i]);
            if (!value) throw InputError({where, shorten(words[i]) + " is no number", "", "write for instance 0.25"});
            table.columns[names[i]].push_back(*value);
        }
    }
    return table;
}

} // namespace treacle::video
