#include "study/model/readings.hpp"

#include "base/text/csv_reader.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace treacle::study {

namespace {
constexpr double none = std::numeric_limits<double>::quiet_NaN();

double mean_over_time(const std::vector<double>& times, const std::vector<double>& values) {
    if (times.size() == 1 || times.back() <= times.front()) return values.front();
    double sum = 0;
    for (std::size_t i = 1; i < times.size(); ++i) sum += (times[i] - times[i - 1]) * (values[i] + values[i - 1]) / 2;
    return sum / (times.back() - times.front());
}

// Outside of the rows the nearest one's value.
double value_at(const std::vector<double>& times, const std::vector<double>& values, double time) {
    const auto next = std::size_t(std::ranges::lower_bound(times, time) - times.begin());
    if (next == 0) return values.front();
    if (next == times.size()) return values.back();
    const double fraction = (time - times[next - 1]) / (times[next] - times[next - 1]);
    return values[next - 1] + fraction * (values[next] - values[next - 1]);
}

// "front [m]" of "front": the unit of the column that is read.
std::string with_unit_of(const std::string& name, const std::string& column) {
    const auto unit = column.find(" [");
    return name.find(" [") != std::string::npos || unit == std::string::npos ? name : name + column.substr(unit);
}
} // namespace

bool are_read(const Study& study, const std::vector<Figure>& figures) {
    if (study.read.empty()) return !figures.empty();
    return std::ranges::equal(study.read, figures, [](const Reading& reading, const Figure& figure) {
        return without_unit(reading.name) == without_unit(figure.name);
    });
}

double statistic(
    const std::vector<double>& all_times, const std::vector<double>& all_values, Statistic at, double time) {
    // Rows between two measurements of a slower one are empty.
    std::vector<double> times, values;
    for (std::size_t i = 0; i < all_values.size(); ++i) {
        if (!std::isfinite(all_values[i])) continue;
        times.push_back(all_times[i]);
        values.push_back(all_values[i]);
    }
    if (values.empty()) return none;
    switch (at) {
    case Statistic::last: return values.back();
    case Statistic::first: return values.front();
    case Statistic::max: return std::ranges::max(values);
    case Statistic::min: return std::ranges::min(values);
    case Statistic::mean: return mean_over_time(times, values);
    case Statistic::at_time: return value_at(times, values, time);
    }
    return none;
}

std::vector<Figure> read_figures(const Study& study, const std::filesystem::path& run_folder) {
    std::map<std::string, CsvColumns> tables;
    const auto table = [&](const std::string& name) -> const CsvColumns& {
        const auto [entry, fresh] = tables.try_emplace(name);
        if (fresh) entry->second = read_csv(run_folder / (name + ".csv"));
        return entry->second;
    };
    std::vector<Figure> figures;
    if (study.read.empty() && std::filesystem::exists(run_folder / "measurements.csv")) {
        const auto& all = table("measurements");
        for (std::size_t i = 0; i < all.names.size(); ++i) {
            const auto name = without_unit(all.names[i]);
            if (name == "step" || name == "time") continue;
            figures.push_back({all.names[i], statistic(all.column("time"), all.values[i], Statistic::last)});
        }
    }
    for (const auto& reading : study.read) {
        const auto& source = table(reading.table.empty() ? "measurements" : reading.table);
        const auto& column = reading.measurement.empty() ? reading.column : reading.measurement;
        if (!source.find(column)) {
            const auto close = nearest(column, source.names);
            throw InputError({reading.where, source.path.string() + " has no column " + column, "",
                close ? "did you mean " + *close + "?" : "its columns are " + join(source.names, ", ")});
        }
        const auto& values = source.column(column);
        const auto index = std::size_t(&values - source.values.data());
        figures.push_back({with_unit_of(reading.name, source.names[index]),
            statistic(source.column("time"), values, reading.at, reading.time)});
    }
    return figures;
}

} // namespace treacle::study
