#include "identify/experiment/observation.hpp"

#include "base/text/csv_reader.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

namespace {
std::filesystem::path table_of(const std::filesystem::path& folder, const std::string& where) {
    for (const char* name : {"silhouettes.csv", "film.csv"}) {
        if (std::filesystem::exists(folder / name)) return folder / name;
    }
    throw InputError({where, folder.string() + " has neither silhouettes.csv nor film.csv",
        "the times of the masks stand there", "give the folder that `treacle silhouettes` has written"});
}

// A point beside excluded pixels lies on their border, not on the liquid's.
bool near_excluded(const video::Mask& mask, const video::ContourPoint& point) {
    constexpr int radius = 4; // [px] of the blur
    const int x = int(std::lround(point.pixel[0])), y = int(std::lround(point.pixel[1]));
    for (int row = std::max(0, y - radius); row <= std::min(mask.height - 1, y + radius); ++row) {
        for (int column = std::max(0, x - radius); column <= std::min(mask.width - 1, x + radius); ++column) {
            if (mask.at(column, row) == video::mask_excluded) return true;
        }
    }
    return false;
}

double distance(const video::ContourPoint& a, const video::ContourPoint& b) {
    return std::hypot(a.pixel[0] - b.pixel[0], a.pixel[1] - b.pixel[1]);
}
} // namespace

std::vector<std::size_t> compared_times(
    const Experiment& experiment, const std::vector<double>& times, const std::string& what) {
    std::vector<std::size_t> out;
    int skipped = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
        const double time = times[i] - experiment.time_zero;
        if (!(time >= experiment.from) || (experiment.to > 0 && time > experiment.to) ||
            skipped++ % experiment.every != 0)
            continue;
        out.push_back(i);
    }
    if (!out.empty()) return out;
    throw InputError({experiment.where, "no " + what + " is between `from` and `to`",
        times.empty() ? "there is none"
                      : "the " + what + "s' times, less time_zero, go from " +
                            format_number(times.front() - experiment.time_zero) + " to " +
                            format_number(times.back() - experiment.time_zero) + " s",
        "look at time_zero, from and to"});
}

std::vector<ObservedFrame> observed_frames(const Experiment& experiment, const std::filesystem::path& folder) {
    const auto table = read_csv(table_of(folder, experiment.where));
    const auto& numbers = table.column("frame");
    const auto& times = table.column("time");
    std::vector<ObservedFrame> frames;
    for (const auto i : compared_times(experiment, times, "mask")) {
        const auto name = video::mask_name(std::int64_t(numbers[i]));
        frames.push_back({int(numbers[i]), times[i] - experiment.time_zero, folder / name});
        if (!std::filesystem::exists(frames.back().mask)) {
            throw InputError(
                {table.path.string(), "names frame " + format_number(numbers[i]) + ", but " + name + " is not there",
                    "every frame of the table has a mask", "make the silhouettes again"});
        }
    }
    return frames;
}

std::vector<ContourSegment> contour_segments(const video::Mask& mask, double length) {
    std::vector<ContourSegment> out;
    double way = 0;
    const video::ContourPoint* last = nullptr;
    auto liquid = mask;
    for (auto& pixel : liquid.pixels) pixel = pixel == video::mask_liquid ? video::mask_liquid : video::mask_background;
    if (liquid.area() == 0) return out;
    const auto points = video::find_contour(liquid);
    for (const auto& point : points) {
        if (near_excluded(mask, point)) continue;
        // Corners that were left out leave a gap.
        const bool follows = last != nullptr && last->piece == point.piece && distance(*last, point) < 3;
        way = follows ? way + distance(*last, point) : length;
        if (way >= length) {
            out.emplace_back();
            way = 0;
        }
        out.back().points.push_back(point);
        last = &point;
    }
    constexpr std::size_t least = 6; // points that a segment needs to count
    std::erase_if(out, [](const ContourSegment& segment) { return segment.points.size() < least; });
    return out;
}

} // namespace treacle::identify
