#include "identify/compare/occupancy_comparison.hpp"

#include "base/median.hpp"
#include "video/mask/contour_distance.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

namespace {
constexpr std::size_t fields = 3; // of a pixel
constexpr double micrometre = 1e-6;
} // namespace

OccupancySum::OccupancySum(int width, int height)
    : width_(width), height_(height), numbers_(fields * std::size_t(width) * std::size_t(height)) {}

void OccupancySum::add(const video::Mask& film, const video::Mask& liquid, const video::FilmDepth& depth) {
    for (std::size_t i = 0; i < film.pixels.size(); ++i) {
        if (film.pixels[i] == video::mask_excluded) continue;
        ++numbers_[fields * i];
        if (liquid.pixels[i] != video::mask_liquid) continue;
        ++numbers_[fields * i + 1];
        if (!depth.empty()) numbers_[fields * i + 2] += std::llround(double(depth[i]) / micrometre);
    }
}

video::Mask OccupancySum::level(double fraction) const {
    video::Mask out{width_, height_, std::vector<std::uint8_t>(numbers_.size() / fields, video::mask_background)};
    std::int64_t most = 0;
    for (std::size_t i = 0; i < out.pixels.size(); ++i) most = std::max(most, numbers_[fields * i]);
    for (std::size_t i = 0; i < out.pixels.size(); ++i) {
        const auto frames = numbers_[fields * i], liquid = numbers_[fields * i + 1];
        if (2 * frames < most) {
            out.pixels[i] = video::mask_excluded;
        } else if (liquid > 0 && double(liquid) >= fraction * double(frames)) {
            out.pixels[i] = video::mask_liquid;
        }
    }
    return out;
}

video::FilmDepth OccupancySum::depth() const {
    video::FilmDepth out(numbers_.size() / fields, 1e30f);
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (numbers_[fields * i + 1] > 0)
            out[i] = float(micrometre * double(numbers_[fields * i + 2]) / double(numbers_[fields * i + 1]));
    }
    return out;
}

FrameComparison compare_window(
    const OccupancyWindow& window, const std::vector<double>& levels, const scene::CameraModel& camera) {
    SimulatedFrame run;
    run.step = window.step;
    run.now.depth = window.now.depth();
    FrameComparison out;
    for (const double level : levels) {
        run.now.mask = window.now.level(level);
        run.later.mask = window.later.level(level);
        const auto one = compare_frame(window.frame, window.film.level(level), run, camera);
        out.segments.insert(out.segments.end(), one.segments.begin(), one.segments.end());
        out.mismatches += one.mismatches;
        out.observed += one.observed;
        out.simulated += one.simulated;
        out.compared += one.compared;
    }
    return out;
}

double occupancy_noise(const std::vector<OccupancyWindow>& windows, const std::vector<double>& levels) {
    std::vector<double> scatter;
    for (std::size_t w = 1; w + 1 < windows.size(); ++w) {
        for (const double level : levels) {
            const video::ContourDistance before(windows[w - 1].film.level(level)),
                after(windows[w + 1].film.level(level));
            for (const auto& segment : contour_segments(windows[w].film.level(level))) {
                double sum = 0;
                for (const auto& point : segment.points) sum += 0.5 * (before(point) + after(point));
                scatter.push_back(std::abs(sum / double(segment.points.size())));
            }
        }
    }
    const double least = usual_noise(ExperimentKind::contours);
    if (scatter.empty()) return least;
    // The variance of these is 3/2 of a window's, that of a film less a run twice a window's.
    return std::max(least, 1.4826 * upper_median(scatter) * std::sqrt(2 / 1.5));
}

void scale_by_noise(FrameComparison& comparison, double noise) {
    for (auto& segment : comparison.segments) {
        segment.displacement /= noise;
        for (auto& one : segment.by_view) one /= noise;
    }
}

void add_turning(FrameComparison& comparison, const ObservedFrame& frame, const TurningRate& film,
    const TurningRate& run, double scatter, std::size_t levels) {
    constexpr double least = 0.02; // relative noise: passages are resolved by frames
    if (film.turns < 0.5) return;
    SegmentResidual row;
    row.frame = frame.number;
    row.time = frame.time;
    for (const auto& segment : comparison.segments) row.points += segment.points / double(levels);
    row.displacement = (run.rate / film.rate - 1) / std::max(least, scatter * std::sqrt(2 / film.turns));
    if (row.points > 0) comparison.segments.push_back(row);
}

} // namespace treacle::identify
