#include "base/text/csv_reader.hpp"

#include "base/text/error.hpp"
#include "base/text/split.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <fstream>
#include <limits>

namespace treacle {

std::string without_unit(const std::string& column) { return column.substr(0, column.find(" [")); }

const std::vector<double>* CsvColumns::find(const std::string& name) const {
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == name || without_unit(names[i]) == name) return &values[i];
    }
    return nullptr;
}

const std::vector<double>& CsvColumns::column(const std::string& name) const {
    if (const auto* found = find(name)) return *found;
    const auto close = nearest(name, names);
    throw InputError({path.string(), "has no column " + name, "",
        close ? "did you mean " + *close + "?" : "its columns are " + join(names, ", ")});
}

CsvColumns read_csv(const std::filesystem::path& path) {
    std::ifstream file(path);
    if (!file) throw InputError({path.string(), "cannot be read", "", "check its name"});
    CsvColumns out{path, {}, {}};
    std::string line;
    // A row without its line break was cut off: getline then ends at the end of the file.
    for (int number = 1; std::getline(file, line) && !file.eof(); ++number) {
        const auto words = split(line, ',');
        if (number == 1) {
            out.names = words;
            out.values.resize(words.size());
            continue;
        }
        if (words.size() != out.names.size()) {
            throw InputError(
                {path.string() + ":" + std::to_string(number), "has " + std::to_string(words.size()) + " values",
                    "the header names " + std::to_string(out.names.size()), "the file was damaged"});
        }
        for (std::size_t i = 0; i < words.size(); ++i) {
            out.values[i].push_back(read_number(words[i]).value_or(std::numeric_limits<double>::quiet_NaN()));
        }
    }
    return out;
}

} // namespace treacle
