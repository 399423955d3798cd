#include "identify/compare/comparison.hpp"

#include "video/mask/contour_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace treacle::identify {
namespace {

// A plane disc of liquid, in front of a camera that looks along -z.
struct Disc {
    double x = 0.01, y = 0.02, radius = 0.03;
    std::vector<double> position, normal, velocity;
    std::vector<std::array<int, 3>> segments;

    explicit Disc(double r = 0.03, const Vec3& speed = {0, 0, 0}) : radius(r) {
        constexpr int n = 400;
        for (int i = 0; i < n; ++i) {
            const double a = 2 * std::numbers::pi * i / n;
            position.insert(position.end(), {x + radius * std::cos(a), y + radius * std::sin(a), 0});
            normal.insert(normal.end(), {std::cos(a), std::sin(a), 0});
            velocity.insert(velocity.end(), speed.begin(), speed.end());
            segments.push_back({i, (i + 1) % n, -1});
        }
    }
    video::FilmDrawing draw(const scene::CameraModel& camera, double offset = 0, double readout = 0) const {
        video::FilmShot shot;
        shot.readout = readout;
        shot.samples = 1;
        shot.offset = offset;
        return video::draw_liquid({2, position, normal, velocity, segments}, camera, shot, {});
    }
};

// 2000 px/m on the plane z = 0: the disc has a radius of 60 px.
scene::CameraModel camera_at(double focal = 1000, const Vec3& turn = {0, 0, 0}, const Vec3& move = {0, 0, 0}) {
    scene::Lens lens;
    lens.width = 320;
    lens.height = 240;
    lens.fx = lens.fy = focal;
    lens.cx = 159.5;
    lens.cy = 119.5;
    const scene::Matrix3 upright{Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, -1}};
    scene::CameraPose pose;
    pose.rotation = scene::product(scene::rotation_matrix(turn), upright);
    pose.translation = {move[0], move[1], 0.5 + move[2]};
    return {"main", lens, pose};
}

constexpr double time_step = 0.01;

FrameComparison compare(const Disc& observed, const Disc& simulated, const scene::CameraModel& camera,
    double filmed_readout = 0, double readout = 0) {
    SimulatedFrame frame{simulated.draw(camera, 0, readout), simulated.draw(camera, time_step, readout), time_step};
    return compare_frame({3, 0.1, {}}, observed.draw(camera_at(), 0, filmed_readout).mask, frame, camera);
}

double mean(const FrameComparison& comparison) {
    double sum = 0;
    for (const auto& s : comparison.segments) sum += s.displacement / double(comparison.segments.size());
    return sum;
}

// A drop of 40 px within a thread as wide that goes on for 100 px more, and the other way round: tips have the
// displacement, sides none.
TEST(ContourDistance, GoesAlongTheNormalWhereTheContourIsFar) {
    const auto thread = [](int end) {
        video::Mask out{160, 240, std::vector<std::uint8_t>(160 * 240, video::mask_background)};
        for (int row = 40; row < end; ++row) {
            for (int column = 60; column < 100; ++column)
                out.pixels[std::size_t(row * 160 + column)] = video::mask_liquid;
        }
        return out;
    };
    const video::ContourDistance longer(thread(180)), shorter(thread(80));
    EXPECT_NEAR(longer({{79.5, 79.5}, {0, 1}}), 100, 0.5);
    EXPECT_NEAR(shorter({{79.5, 179.5}, {0, 1}}), -100, 0.5);
    EXPECT_NEAR(longer({{99.5, 60}, {1, 0}}), 0, 0.05);
    EXPECT_NEAR(shorter({{99.5, 150}, {1, 0}}), -70.5, 1); // nothing inward: to the tip's nearest pixel
    EXPECT_NEAR(video::ContourDistance(thread(240))({{79.5, 79.5}, {0, 1}}), 159.5, 1); // the liquid leaves the picture
}

// Points of the small disc's contour depend on the distance of the ring around, but not on liquid beyond it.
TEST(FrameComparison, LiquidFarBeyondTheObservedCountsByHowFarItGoesOn) {
    EXPECT_EQ(compare(Disc(0.03), Disc(0.03), camera_at()).beyond, 0);
    EXPECT_EQ(compare(Disc(0.03), Disc(0.033), camera_at()).beyond, 0); // 6 px: within the range of the segments
    const auto beyond = [](double radius) { return compare(Disc(0.01), Disc(radius), camera_at()).beyond; };
    // A ring of 2 pi r points, each r - 20 - 10 px too far out, in segments of 25.
    EXPECT_NEAR(beyond(0.02), 2 * std::numbers::pi * 40 * 10 / 25, 20);
    EXPECT_NEAR(beyond(0.03), 2 * std::numbers::pi * 60 * 30 / 25, 60);
}

TEST(ContourDistance, IsThatFromACircleNearAndFar) {
    const auto mask = Disc().draw(camera_at()).mask; // radius 60 px around (179.5, 79.5)
    const video::ContourDistance distance(mask);
    for (const double radius : {20.0, 50.0, 58.5, 59.7, 60.0, 61.2, 64.0, 75.0}) {
        for (const double angle : {0.3, 2.0, 4.4}) {
            const scene::Vec2 n{std::cos(angle), std::sin(angle)};
            const video::ContourPoint point{{179.5 + radius * n[0], 79.5 + radius * n[1]}, n, 0};
            // Steps of pixels leave 0.3 px; the blur draws a circle of 60 px in by 1.5^2 / (2 * 60).
            EXPECT_NEAR(distance(point), 60 - radius, 0.45) << radius << " " << angle;
        }
    }
}

TEST(CompareFrame, DisplacementsAreOfTheSimulatedContourOutward) {
    EXPECT_NEAR(mean(compare(Disc(), Disc(), camera_at())), 0, 1e-9);
    EXPECT_NEAR(mean(compare(Disc(), Disc(0.0306), camera_at())), 1.2, 0.03);
    EXPECT_NEAR(mean(compare(Disc(), Disc(0.025), camera_at())), -10, 0.5); // far away by the nearest pixel
}

TEST(CompareFrame, MismatchesAreCountedInPixels) {
    const auto comparison = compare(Disc(), Disc(0.0306), camera_at());
    const double ring = std::numbers::pi * (61.2 * 61.2 - 60 * 60);
    EXPECT_NEAR(double(comparison.mismatches), ring, 0.05 * ring);
    EXPECT_EQ(comparison.compared, 320 * 240);
    EXPECT_EQ(comparison.simulated - comparison.observed, comparison.mismatches);
    EXPECT_DOUBLE_EQ(mismatch_objective(comparison), 0.5 * double(comparison.mismatches) / (320 * 240));
}

// Against pictures that are drawn anew with another camera.
TEST(CompareFrame, DerivativesByTheCameraAreThoseOfOtherPictures) {
    struct Change {
        int parameter;
        double step;
    };
    for (const auto& [parameter, step] :
        {Change{view_focal, 0.02}, Change{view_turn, 0.004}, Change{view_turn + 1, 0.004}, Change{view_turn + 2, 0.05},
            Change{view_position, 0.002}, Change{view_position + 1, 0.002}, Change{view_position + 2, 0.01}}) {
        Vec3 turn{0, 0, 0}, move{0, 0, 0};
        if (parameter >= view_turn && parameter < view_position) turn[std::size_t(parameter - view_turn)] = step;
        if (parameter >= view_position) move[std::size_t(parameter - view_position)] = step;
        const auto camera = camera_at(1000 * (parameter == view_focal ? 1 + step : 1), turn, move);
        const auto before = compare(Disc(), Disc(), camera_at()), after = compare(Disc(), Disc(), camera);
        ASSERT_EQ(before.segments.size(), after.segments.size());
        for (std::size_t i = 0; i < before.segments.size(); ++i) {
            const double moved = after.segments[i].displacement - before.segments[i].displacement;
            EXPECT_NEAR(moved, before.segments[i].by_view[std::size_t(parameter)] * step, 0.25)
                << view_parameters(ExperimentKind::contours)[std::size_t(parameter)].name << " segment " << i;
        }
    }
}

TEST(CompareFrame, ALaterTimeZeroShowsTheRunEarlier) {
    const auto comparison = compare(Disc(), Disc(0.03, {0.05, 0, 0}), camera_at()); // 100 px/s to the right
    for (const auto& s : comparison.segments)
        EXPECT_NEAR(s.by_view[view_time], -100 * s.normal_x, 25) << s.x << " " << s.y;
}

// A disc that moves to the right by 100 px/s, filmed with a readout of 0.1 s: its rows lie up to 3.5 px off.
TEST(CompareFrame, ARollingShuttersRowsAreComparedAtTheirOwnTime) {
    constexpr double readout = 0.1;
    const Disc disc(0.03, {0.05, 0, 0});
    double ignored = 0, included = 0;
    const auto without = compare(disc, disc, camera_at(), readout, 0),
               with = compare(disc, disc, camera_at(), readout, readout);
    for (std::size_t i = 0; i < with.segments.size(); ++i) {
        ignored = std::max(ignored, std::abs(without.segments[i].displacement));
        included = std::max(included, std::abs(with.segments[i].displacement));
        // Prediction of its derivative.
        EXPECT_NEAR(without.segments[i].displacement + readout * without.segments[i].by_view[view_readout], 0, 0.5);
    }
    EXPECT_GT(ignored, 2);
    EXPECT_LT(included, 1e-9);
}

TEST(CompareFrame, WithoutLiquidContoursAreFarAway) {
    Disc away;
    for (std::size_t i = 0; i < away.position.size(); i += 3) away.position[i] += 10;
    EXPECT_LT(mean(compare(Disc(), away, camera_at())), -390);
}

} // namespace
} // namespace treacle::identify
