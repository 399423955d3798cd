#include "identify/compare/occupancy_comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace treacle::identify {
namespace {

constexpr int width = 160, height = 120, frames = 120;
const std::vector<double> levels{0.1, 0.3, 0.5};

// From the side: a disc of 20 px radius that goes to and fro by `swing` px, seven times over the frames.
video::Mask disc_at(int frame, double swing, double phase, double sense = 1) {
    const double x = 80 + sense * swing * std::sin(2 * std::numbers::pi * 7 * frame / frames + phase);
    video::Mask out{width, height, std::vector<std::uint8_t>(std::size_t(width * height), video::mask_background)};
    for (int r = 0; r < height; ++r)
        for (int c = 0; c < width; ++c) {
            if (std::hypot(c - x, r - 60.0) <= 20) out.pixels[std::size_t(r * width + c)] = video::mask_liquid;
        }
    return out;
}

struct Swing {
    double swing = 25, phase = 0, sense = 1;
};

OccupancyWindow window_of(const Swing& film, const Swing& run) {
    OccupancyWindow out(width, height);
    out.frame = {30, 0.5, {}};
    out.step = 1e-3;
    const video::FilmDepth depth(std::size_t(width * height), 0.25f);
    for (int k = 0; k < frames; ++k) {
        const auto mask = disc_at(k, film.swing, film.phase, film.sense),
                   seen = disc_at(k, run.swing, run.phase, run.sense);
        out.film.add(mask, mask);
        out.now.add(mask, seen, depth);
        out.later.add(mask, seen);
    }
    return out;
}

scene::CameraModel camera() {
    scene::Lens lens;
    lens.width = width;
    lens.height = height;
    lens.fx = lens.fy = 500;
    lens.cx = 79.5;
    lens.cy = 59.5;
    scene::CameraPose pose;
    pose.rotation = {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, -1}};
    pose.translation = {0, 0, 0.25};
    return {"main", lens, pose};
}

double largest(const FrameComparison& one) {
    double out = 0;
    for (const auto& s : one.segments) out = std::max(out, std::abs(s.displacement));
    return out;
}

TEST(Occupancy, PhaseAndSenseDoNotCount) {
    const auto same = compare_window(window_of({}, {25, 1.3, 1}), levels, camera());
    EXPECT_GT(same.segments.size(), 10u);
    EXPECT_LT(largest(same), 1);
    EXPECT_LT(largest(compare_window(window_of({}, {25, 0, -1}), levels, camera())), 1);
    // Frame by frame, which has as many pixels of liquid, half of them would not fit.
    const auto a = disc_at(3, 25, 0), b = disc_at(3, 25, 0, -1);
    EXPECT_LT(video::overlap(a, b), 0.2);
}

TEST(Occupancy, AWiderSwingLiesOutside) {
    const auto wider = compare_window(window_of({}, {28, 1.3, 1}), levels, camera());
    double sum = 0, count = 0;
    for (const auto& s : wider.segments) {
        if (std::abs(s.normal_x) < 0.8 || std::abs(s.x - 80) < 25) continue; // the ends of the lowest level
        sum += s.displacement;
        count += 1;
        EXPECT_NEAR(s.by_view[view_contour], 1, 1e-9);
    }
    ASSERT_GT(count, 0);
    EXPECT_GT(sum / count, 1.5); // 3 px along the swing, less along normals that lean
    EXPECT_LT(sum / count, 3.2);
}

TEST(Occupancy, LevelsAreSharesOfTheFramesThatCount) {
    OccupancySum sum(2, 1);
    const video::Mask left{2, 1, {video::mask_liquid, video::mask_background}},
        none{2, 1, {video::mask_background, video::mask_excluded}};
    for (int k = 0; k < 3; ++k) sum.add(left, left);
    for (int k = 0; k < 7; ++k) sum.add(none, none);
    EXPECT_EQ(sum.level(0.3).at(0, 0), video::mask_liquid);
    EXPECT_EQ(sum.level(0.31).at(0, 0), video::mask_background);
    EXPECT_EQ(sum.level(0.3).at(1, 0), video::mask_excluded); // counts in 3 of 10
}

// Discs that stand, of these radii.
double noise_of(const std::vector<double>& radii) {
    std::vector<OccupancyWindow> windows;
    for (const double radius : radii) {
        video::Mask mask{width, height, std::vector<std::uint8_t>(std::size_t(width * height), video::mask_background)};
        for (int r = 0; r < height; ++r)
            for (int c = 0; c < width; ++c) {
                if (std::hypot(c - 80.0, r - 60.0) <= radius)
                    mask.pixels[std::size_t(r * width + c)] = video::mask_liquid;
            }
        windows.emplace_back(width, height).film.add(mask, mask);
    }
    return occupancy_noise(windows, levels);
}

TEST(Occupancy, NoiseIsTheScatterOfWindowsBesideTheirGrowth) {
    EXPECT_DOUBLE_EQ(noise_of({30, 30, 30}), 0.5); // no less than that of a contour
    EXPECT_DOUBLE_EQ(noise_of({24, 28, 32, 36}), 0.5);
    EXPECT_NEAR(noise_of({30, 33, 30, 33}), 1.4826 * 3 * std::sqrt(2 / 1.5), 0.5); // 3 px from the middle
}

TEST(Occupancy, TheRateCountsAsALevelDoes) {
    auto one = compare_window(window_of({}, {}), levels, camera());
    double points = 0;
    for (const auto& s : one.segments) points += s.points;
    const auto before = one.segments.size();
    add_turning(one, {30, 0.5, {}}, {5, 0.3}, {6, 4}, 0.1, levels.size()); // the film has too little of a turn
    EXPECT_EQ(one.segments.size(), before);
    add_turning(one, {30, 0.5, {}}, {5, 8}, {6, 9.6}, 0.1, levels.size());
    ASSERT_EQ(one.segments.size(), before + 1);
    EXPECT_NEAR(one.segments.back().points, points / 3, 1e-9);
    EXPECT_NEAR(one.segments.back().displacement, 0.2 / (0.1 * 0.5), 1e-9);
    add_turning(one, {30, 0.5, {}}, {5, 8}, {0, 0}, 0.1,
        levels.size()); // a run that does not turn is far away, and has a value
    EXPECT_NEAR(one.segments.back().displacement, -20, 1e-9);
}

} // namespace
} // namespace treacle::identify
