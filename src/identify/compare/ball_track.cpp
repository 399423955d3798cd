#include "identify/compare/ball_track.hpp"

#include "base/text/error.hpp"
#include "identify/compare/series_comparison.hpp"

#include <algorithm>

namespace treacle::identify {

BallTrack::Columns BallTrack::read(const Sheet& sheet, const std::filesystem::path& path) {
    const auto table = read_csv(path);
    Columns out{column_in_si(table, "time", "s"), column_in_si(table, "x", "m", sheet.pixel),
        column_in_si(table, "y", "m", sheet.pixel), column_in_si(table, "plus_minus", "m", sheet.pixel)};
    const auto bad = std::ranges::adjacent_find(out.times, std::greater_equal<>());
    if (out.times.size() < 2 || bad != out.times.end()) {
        throw InputError({path.string() + ":" + std::to_string(bad - out.times.begin() + 2),
            "needs two rows at least, with times that grow", "it is the path of the ball", "sort the rows"});
    }
    for (const double one : out.deviations) {
        if (one < 0)
            throw InputError({path.string(), "plus_minus is negative", "it is a standard deviation",
                "write how well a picked place is known"});
    }
    return out;
}

BallTrack::BallTrack(const Sheet& sheet, const std::filesystem::path& path) : BallTrack(sheet, read(sheet, path)) {}

BallTrack::BallTrack(const Sheet& sheet, const Columns& columns)
    : sheet_(sheet), x_(columns.times, columns.x, columns.deviations), y_(columns.times, columns.y, columns.deviations),
      deviation_(*std::ranges::max_element(columns.deviations)) {}

Vec3 BallTrack::at(double time) const { return sheet_.point_of_file(x_.at(time), y_.at(time)); }

} // namespace treacle::identify
