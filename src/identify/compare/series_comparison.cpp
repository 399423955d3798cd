#include "identify/compare/series_comparison.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "base/text/units.hpp"
#include "identify/experiment/observation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace treacle::identify {

namespace {
constexpr std::array known{&unit::length, &unit::area, &unit::volume, &unit::time, &unit::velocity, &unit::angle,
    &unit::angular_velocity, &unit::force, &unit::pressure, &unit::volume_flow, &unit::kinematic_viscosity,
    &unit::frequency};

// SI value of the unit in a column's brackets.
double unit_factor(const CsvColumns& table, const std::string& column, const std::string& si, double pixel) {
    const auto word = unit_in(column);
    if (word == si) return 1;
    if (word == "px" && pixel > 0) return pixel;
    for (const auto* unit : known) {
        if (unit->si != si || word.empty()) continue;
        const auto read = read_quantity("1 " + word, *unit);
        if (const auto* value = std::get_if<double>(&read)) return *value;
    }
    throw InputError({table.path.string() + ":1",
        "column " + column + (word.empty() ? " has no unit" : " is not in a unit of " + si),
        word == "px" ? "the length of a pixel is not given" : "numbers are converted to " + si,
        word == "px" ? "give `pixel` of the fields"
                     : "write its unit in brackets: " + without_unit(column) + " [" + si + "]"});
}
} // namespace

std::string unit_in(const std::string& column) {
    const auto open = column.find('['), close = column.find(']');
    return open == std::string::npos || close == std::string::npos ? "" : column.substr(open + 1, close - open - 1);
}

std::vector<double> column_in_si(
    const CsvColumns& table, const std::string& name, const std::string& si, double pixel) {
    for (std::size_t c = 0; c < table.names.size(); ++c) {
        if (without_unit(table.names[c]) != name) continue;
        auto out = table.values[c];
        const double factor = unit_factor(table, table.names[c], si, pixel);
        for (std::size_t i = 0; i < out.size(); ++i) {
            out[i] *= factor;
            if (!std::isfinite(out[i]))
                throw InputError({table.path.string() + ":" + std::to_string(i + 2), name + " is no number", "",
                    "mend the row or leave it out"});
        }
        return out;
    }
    throw InputError({table.path.string() + ":1", "has no column " + name, "it has " + join(table.names, ", "),
        "name it in the header, with its unit in brackets"});
}

std::vector<ObservedValue> observed_values(
    const Experiment& experiment, const std::filesystem::path& file, const std::string& unit) {
    const auto table = read_csv(file);
    const auto times = column_in_si(table, "time", "s"), values = column_in_si(table, experiment.series.values, unit),
               deviations = column_in_si(table, "plus_minus", unit);
    std::vector<ObservedValue> out;
    for (const auto i : compared_times(experiment, times, "value")) {
        if (!(deviations[i] > 0)) {
            throw InputError({file.string() + ":" + std::to_string(i + 2), "plus_minus must be > 0",
                "it is a standard deviation, and weighs the value", "write how well the value is known"});
        }
        out.push_back({int(i), times[i] - experiment.time_zero, values[i], deviations[i]});
    }
    return out;
}

RunResiduals compare_series(
    const std::vector<ObservedValue>& observed, const std::vector<double>& times, const std::vector<double>& values) {
    RunResiduals out;
    out.kind = ExperimentKind::series;
    for (const auto& one : observed) {
        SegmentResidual row;
        row.frame = one.number;
        row.time = one.time;
        row.displacement = std::numeric_limits<double>::quiet_NaN();
        const auto after = std::ranges::upper_bound(times, one.time) - times.begin();
        const double tolerance =
            times.size() > 1 ? times[1] - times[0] : 0; // the run's first row comes after its first step
        if (times.size() > 1 && one.time >= times.front() - 1.01 * tolerance && one.time <= times.back() * (1 + 1e-9)) {
            const auto i = std::size_t(std::clamp<std::ptrdiff_t>(after, 1, std::ptrdiff_t(times.size()) - 1));
            const double slope = (values[i] - values[i - 1]) / (times[i] - times[i - 1]),
                         value = values[i - 1] + slope * (one.time - times[i - 1]);
            row.points = 1;
            row.displacement = (value - one.value) / one.deviation;
            row.by_view[series_time] = -slope / one.deviation; // a later time zero shows the run earlier
            row.by_view[series_offset] = -1 / one.deviation;
            row.by_view[series_scale] = -one.value / one.deviation;
        }
        out.segments.push_back(row);
        out.squares.push_back(
            {one.number, one.time, row.points > 0 ? row.displacement * row.displacement : 0, row.points});
    }
    return out;
}

} // namespace treacle::identify
