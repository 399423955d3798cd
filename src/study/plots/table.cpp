#include "study/plots/table.hpp"

#include "base/text/error.hpp"
#include "base/text/file.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace treacle::study {

namespace {
constexpr const char* seconds_column = "seconds [s]";

std::string quoted(const std::string& word) {
    if (word.find_first_of(",\"\n\r") == std::string::npos) return word;
    std::string out = "\"";
    for (const char c : word) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

// In the order in which they first come.
std::vector<std::string> figure_names(const Journal& journal, std::span<const std::int64_t> runs) {
    std::vector<std::string> names;
    for (const auto run : runs) {
        const auto* outcome = journal.outcome(run);
        if (!outcome) continue;
        for (const auto& figure : outcome->figures) {
            if (std::ranges::find(names, figure.name) == names.end()) names.push_back(figure.name);
        }
    }
    return names;
}

// A number of the parameter's unit without it, since the header has it.
std::string plain(const Parameter& parameter, const std::string& word) {
    const auto number = parameter.number(word);
    return number && !parameter.unit.empty() ? format_number(*number) : word;
}
} // namespace

Table table_of(const Study& study, const Journal& journal, std::span<const std::int64_t> runs) {
    Table out;
    out.figures = figure_names(journal, runs);
    out.header = {"run"};
    const bool several = study.scenes.size() > 1;
    if (several) out.header.push_back("scene");
    for (const auto& parameter : study.parameters) out.header.push_back(parameter.column());
    out.header.push_back("status");
    out.header.insert(out.header.end(), out.figures.begin(), out.figures.end());
    out.header.push_back(seconds_column);
    out.header.push_back("reason");
    for (const auto number : runs) {
        const auto& run = journal.runs()[std::size_t(number - 1)];
        const auto* outcome = journal.outcome(number);
        std::vector<std::string> row{std::to_string(number)};
        if (several) row.push_back(run.scene);
        for (std::size_t i = 0; i < study.parameters.size(); ++i)
            row.push_back(plain(study.parameters[i], run.values[i]));
        row.push_back(outcome ? word(outcome->status) : "not run");
        for (const auto& name : out.figures) {
            if (!outcome) {
                row.emplace_back();
                continue;
            }
            const auto figure = std::ranges::find(outcome->figures, name, &Figure::name);
            row.push_back(
                figure == outcome->figures.end() || !std::isfinite(figure->value) ? "" : format_number(figure->value));
        }
        row.push_back(outcome ? format_fixed(outcome->seconds, 2) : "");
        const auto changes = join(run.changes, "; ");
        row.push_back(outcome && !outcome->reason.empty() ? outcome->reason : changes.empty() ? "" : "with " + changes);
        out.rows.push_back(std::move(row));
    }
    return out;
}

void write_table(const std::filesystem::path& path, const Table& table) {
    std::string text;
    const auto add = [&](const std::vector<std::string>& row) {
        for (std::size_t i = 0; i < row.size(); ++i) text += (i > 0 ? "," : "") + quoted(row[i]);
        text += "\n";
    };
    add(table.header);
    for (const auto& row : table.rows) add(row);
    write_file_atomically(path, text);
}

std::vector<double> numbers_of(const Table& table, const std::string& column) {
    const auto index = std::size_t(std::ranges::find(table.header, column) - table.header.begin());
    std::vector<double> out;
    for (const auto& row : table.rows)
        out.push_back(read_number(row.at(index)).value_or(std::numeric_limits<double>::quiet_NaN()));
    return out;
}

std::vector<std::string> lines_of(const Table& table) {
    std::vector<std::size_t> widths(table.header.size(), 0);
    const auto measure = [&](const std::vector<std::string>& row) {
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    };
    measure(table.header);
    for (const auto& row : table.rows) measure(row);
    std::vector<std::string> lines;
    const auto add = [&](const std::vector<std::string>& row) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i) {
            line += (i > 0 ? "  " : "") + row[i];
            if (i + 1 < row.size()) line.append(widths[i] - row[i].size(), ' ');
        }
        lines.push_back(line);
    };
    add(table.header);
    for (const auto& row : table.rows) add(row);
    return lines;
}

} // namespace treacle::study
