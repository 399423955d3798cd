#include "study/model/points.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <boost/random/sobol.hpp>

#include <algorithm>
#include <fstream>
#include <map>
#include <numeric>
#include <random>

namespace treacle::study {

namespace {
[[noreturn]] void refuse(
    const std::string& where, const std::string& problem, const std::string& reason, const std::string& cure) {
    throw InputError({where, problem, reason, cure});
}

std::vector<std::string> grid_values(const Parameter& parameter) {
    if (!parameter.values.empty()) return parameter.values;
    if (!parameter.has_range() || parameter.points < 2) {
        refuse(parameter.where, parameter.name + " has no values", "the design of the sweep is a grid",
            "give `values`, or a `range` and at least 2 `points`");
    }
    std::vector<std::string> out;
    out.reserve(std::size_t(parameter.points));
    for (int i = 0; i < parameter.points; ++i)
        out.push_back(parameter.word(parameter.at(double(i) / (parameter.points - 1))));
    return out;
}

std::vector<Point> grid_points(const Study& study) {
    std::vector<Point> points{{}};
    for (const auto& parameter : study.parameters) {
        const auto values = grid_values(parameter);
        std::vector<Point> longer;
        for (const auto& point : points) {
            for (const auto& value : values) {
                longer.push_back(point);
                longer.back().push_back(value);
            }
        }
        points = std::move(longer);
    }
    return points;
}

std::vector<std::string> words_of(const std::string& line) {
    std::vector<std::string> words;
    for (std::size_t from = 0; from <= line.size();) {
        const auto comma = std::min(line.find(',', from), line.size());
        auto word = line.substr(from, comma - from);
        word.erase(0, std::min(word.find_first_not_of(" \t\""), word.size()));
        word.erase(word.find_last_not_of(" \t\r\"") + 1);
        words.push_back(word);
        from = comma + 1;
    }
    return words;
}

std::vector<Point> list_points(const Study& study) {
    std::vector<Point> points;
    for (const auto& text : study.sweep.rows) {
        const auto row = words_of(text);
        points.push_back(row);
        if (row.size() == study.parameters.size()) continue;
        refuse(study.sweep.where,
            "a row of the sweep has " + std::to_string(row.size()) + " values: " + shorten(join(row, ", ")),
            "there are " + std::to_string(study.parameters.size()) + " parameters", "give one for each");
    }
    return points;
}

// Place of each parameter in a header whose columns are "viscosity" or "viscosity [Pa.s]".
std::vector<std::size_t> columns_of(
    const Study& study, const std::vector<std::string>& header, const std::string& where) {
    std::vector<std::size_t> out;
    for (const auto& parameter : study.parameters) {
        const auto found = std::ranges::find_if(header, [&](const std::string& word) {
            return word == parameter.name || word.substr(0, word.find(" [")) == parameter.name;
        });
        if (found == header.end())
            refuse(where, "has no column " + parameter.name, "its columns are " + join(header, ", "),
                "a column each parameter");
        out.push_back(std::size_t(found - header.begin()));
    }
    return out;
}

std::vector<Point> file_points(const Study& study) {
    const auto path = study.path.parent_path() / study.sweep.file;
    std::ifstream file(path);
    if (!file)
        refuse(study.sweep.where, "the file " + path.string() + " cannot be read", "the sweep's rows stand in it",
            "check its name");
    std::vector<Point> points;
    std::vector<std::string> header;
    std::vector<std::size_t> columns;
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        const auto words = words_of(line);
        if ((words.size() == 1 && words[0].empty()) || line.starts_with("#")) continue;
        const auto where = path.string() + ":" + std::to_string(number);
        if (header.empty()) {
            header = words;
            columns = columns_of(study, header, where);
            continue;
        }
        if (words.size() != header.size()) {
            refuse(where, "has " + std::to_string(words.size()) + " values",
                "the header names " + std::to_string(header.size()), "give one for each column");
        }
        Point point;
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const auto& column = header[columns[i]];
            const auto bracket = column.find(" [");
            auto word = words[columns[i]];
            // The header's unit is that of plain numbers.
            if (bracket != std::string::npos && read_number(word))
                word += " " + column.substr(bracket + 2, column.size() - bracket - 3);
            point.push_back(word);
        }
        points.push_back(point);
    }
    if (points.empty())
        refuse(path.string(), "has no rows", "there would be nothing to run", "write a row a run below the header");
    return points;
}

void require_ranges(const Study& study) {
    for (const auto& parameter : study.parameters) {
        if (parameter.has_range()) continue;
        refuse(parameter.where, parameter.name + " has no range", "the design spreads points over ranges",
            "give it a `range`");
    }
}

// A number in [0, 1) that is the same with every standard library.
double unit_number(std::mt19937_64& generator) { return double(generator() >> 11) * 0x1p-53; }

std::vector<Point> latin_points(const Study& study) {
    require_ranges(study);
    const auto runs = static_cast<std::size_t>(study.sweep.runs);
    std::mt19937_64 generator(static_cast<std::uint64_t>(study.sweep.seed));
    std::vector<Point> points(runs);
    for (const auto& parameter : study.parameters) {
        std::vector<std::size_t> order(runs);
        std::iota(order.begin(), order.end(), std::size_t{0});
        for (std::size_t i = runs; i > 1; --i)
            std::swap(order[i - 1], order[std::size_t(unit_number(generator) * double(i))]);
        for (std::size_t i = 0; i < runs; ++i) {
            points[i].push_back(
                parameter.word(parameter.at((double(order[i]) + unit_number(generator)) / double(runs))));
        }
    }
    return points;
}

std::vector<Point> sobol_points(const Study& study) {
    require_ranges(study);
    std::vector<Point> points(static_cast<std::size_t>(study.sweep.runs));
    if (study.parameters.empty()) return points;
    boost::random::sobol generator(study.parameters.size());
    generator.discard(std::uintmax_t(study.sweep.seed - std::min(study.sweep.seed, 1)) *
                      std::uintmax_t(study.sweep.runs) * study.parameters.size());
    for (auto& point : points) {
        for (const auto& parameter : study.parameters) {
            point.push_back(parameter.word(parameter.at(double(generator() >> 11) * 0x1p-53)));
        }
    }
    return points;
}
} // namespace

std::vector<Point> sweep_points(const Study& study) {
    switch (study.sweep.design) {
    case Design::grid: return grid_points(study);
    case Design::list: return list_points(study);
    case Design::file: return file_points(study);
    case Design::latin_hypercube: return latin_points(study);
    case Design::sobol: return sobol_points(study);
    case Design::none: break;
    }
    refuse(study.path.string(), "names no points to run", "`treacle sweep` runs those of the block `sweep`",
        "write for instance sweep: {design: sobol, runs: 16}");
}

} // namespace treacle::study
