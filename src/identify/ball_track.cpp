#include "identify/ball_track.hpp"

#include "base/csv_reader.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

namespace {
// SI value of the unit in a column's brackets.
double unit_factor(const std::filesystem::path& path, const std::string& column, const Unit& unit, double pixel) {
    const auto open = column.find('['), close = column.find(']');
    const auto word = open == std::string::npos ? std::string() : column.substr(open + 1, close - open - 1);
    if (word == "px" && pixel > 0) return pixel;
    const auto read = read_quantity("1 " + word, unit);
    if (const auto* value = std::get_if<double>(&read); value && !word.empty()) return *value;
    throw InputError({path.string() + ":1", "column " + column + (word.empty() ? " has no unit" : ": " + word + " is no " + std::string(unit.name)),
                      word == "px" ? "the length of a pixel is not given" : "numbers without a unit say nothing",
                      word == "px" ? "give `pixel` of the fields" : "write for instance time [s],x [mm],y [mm],plus_minus [mm]"});
}

std::vector<double> in_si(const CsvColumns& table, const char* name, const Unit& unit, double pixel) {
    for (std::size_t c = 0; c < table.names.size(); ++c) {
        if (without_unit(table.names[c]) != name) continue;
        auto out = table.values[c];
        const double factor = unit_factor(table.path, table.names[c], unit, pixel);
        for (std::size_t i = 0; i < out.size(); ++i) {
            out[i] *= factor;
            if (!std::isfinite(out[i])) throw InputError({table.path.string() + ":" + std::to_string(i + 2), std::string(name) + " is no number", "", "mend the row or leave it out"});
        }
        return out;
    }
    throw InputError({table.path.string() + ":1", std::string("has no column ") + name, "it has " + join(table.names, ", "),
                      "write for instance time [s],x [mm],y [mm],plus_minus [mm]"});
}
} // namespace

BallTrack::Columns BallTrack::read(const Sheet& sheet, const std::filesystem::path& path) {
    const auto table = read_csv(path);
    Columns out{in_si(table, "time", unit::time, 0), in_si(table, "x", unit::length, sheet.pixel), in_si(table, "y", unit::length, sheet.pixel),
                in_si(table, "plus_minus", unit::length, sheet.pixel)};
    const auto bad = std::ranges::adjacent_find(out.times, std::greater_equal<>());
    if (out.times.size() < 2 || bad != out.times.end()) {
        throw InputError({path.string() + ":" + std::to_string(bad - out.times.begin() + 2), "needs two rows at least, with times that grow", "it is the path of the ball", "sort the rows"});
    }
    for (const double one : out.deviations) {
        if (one < 0) throw InputError({path.string(), "plus_minus is negative", "it is a standard deviation", "write how well a picked place is known"});
    }
    return out;
}

BallTrack::BallTrack(const Sheet& sheet, const std::filesystem::path& path) : BallTrack(sheet, read(sheet, path)) {}

BallTrack::BallTrack(const Sheet& sheet, const Columns& columns)
    : sheet_(sheet), x_(columns.times, columns.x, columns.deviations), y_(columns.times, columns.y, columns.deviations),
      deviation_(*std::ranges::max_element(columns.deviations)) {}

Vec3 BallTrack::at(double time) const { return sheet_.point_of_file(x_.at(time), y_.at(time)); }

} // namespace treacle::identify
