#include "ball_mesh.hpp"
#include "video/film/film_raster.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

using namespace treacle;
using namespace treacle::video;
using treacle::video::test::make_ball;

namespace {
scene::CameraModel camera() { return {"test", {320, 240, 400, 400, 159.5, 119.5, {}}, {}}; } // looks along z from 0

double covered(const FilmDrawing& drawing) {
    double sum = 0;
    for (const float a : drawing.light.coverage) sum += double(a);
    return sum;
}

std::array<double, 2> centroid(const Mask& mask) {
    double x = 0, y = 0, n = 0;
    for (int row = 0; row < mask.height; ++row)
        for (int column = 0; column < mask.width; ++column)
            if (mask.liquid(column, row)) x += column, y += row, ++n;
    return {x / n, y / n};
}
} // namespace

// A ball's outline in a pinhole is an ellipse: half axes f tan(asin(r/z)) in the middle of the picture.
TEST(FilmRaster, BallHasTheAreaOfItsOutline) {
    const auto ball = make_ball({0, 0, 1}, 0.2, 5);
    const auto drawing = draw_liquid(ball.mesh(), camera(), {}, {});
    const double half = 400 * std::tan(std::asin(0.2)), area = std::numbers::pi * half * half;
    EXPECT_NEAR(covered(drawing), area, 0.002 * area);
    EXPECT_NEAR(double(drawing.mask.area()), area, 0.004 * area);
    EXPECT_NEAR(centroid(drawing.mask)[0], 159.5, 0.02);
    EXPECT_NEAR(centroid(drawing.mask)[1], 119.5, 0.02);
}

// Two triangles of a square: no sample twice, none between them. Mask and middle samples are one.
TEST(FilmRaster, SquareCoversExactlyItsPixels) {
    const double left = (9.5 - 159.5) / 400, right = (29.5 - 159.5) / 400, top = (19.5 - 119.5) / 400,
                 bottom = (24.5 - 119.5) / 400;
    const std::vector<double> corners = {left, top, 1, right, top, 1, right, bottom, 1, left, bottom, 1};
    const std::vector<std::array<int, 3>> triangles = {{0, 1, 2}, {0, 2, 3}};
    const auto drawing = draw_liquid({3, corners, {}, {}, triangles}, camera(), {}, {});
    EXPECT_EQ(drawing.mask.area(), 100u);
    EXPECT_TRUE(drawing.mask.liquid(10, 20));
    EXPECT_TRUE(drawing.mask.liquid(29, 24));
    EXPECT_FALSE(drawing.mask.liquid(30, 24));
    EXPECT_NEAR(covered(drawing), 100, 1e-3);
}

TEST(FilmRaster, MotionBlurIsCentredOnTheMask) {
    const auto ball = make_ball({0, 0, 1}, 0.1, 4,
        {1, 0, 0}); // 400 px a second; the outline of a ball off the axis is 1 / (1 - 0.1^2) further out
    FilmShot shot;
    shot.offset = 0.01;
    shot.exposure = 0.02;
    shot.instants = 5;
    const auto drawing = draw_liquid(ball.mesh(), camera(), shot, {});
    EXPECT_NEAR(centroid(drawing.mask)[0], 159.5 + 4 / 0.99, 0.02);
    double x = 0, sum = 0;
    for (int row = 0; row < 240; ++row)
        for (int column = 0; column < 320; ++column) {
            const auto a = double(drawing.light.coverage[std::size_t(320 * row + column)]);
            x += a * column;
            sum += a;
        }
    EXPECT_NEAR(x / sum, 159.5 + 4 / 0.99, 0.02);
    EXPECT_GT(*std::ranges::max_element(drawing.light.coverage), 0.999F);
}

// The row y of a rolling shutter is at (y / height - 1/2) readout: a falling edge shears by speed times readout over height.
TEST(FilmRaster, RollingShutterShearsWhatMovesSideways) {
    const auto ball = make_ball({0, 0, 1}, 0.2, 5, {1, 0, 0});
    FilmShot shot;
    shot.readout = 0.02; // 8 px over the picture's height
    const auto drawing = draw_liquid(ball.mesh(), camera(), shot, {});
    const auto middle_of_row = [&](int row) {
        double x = 0, n = 0;
        for (int column = 0; column < 320; ++column)
            if (drawing.mask.liquid(column, row)) x += column, ++n;
        return x / n;
    };
    EXPECT_NEAR(middle_of_row(179) - middle_of_row(60), 8.0 * 119 / 239, 0.5);
    EXPECT_NEAR(centroid(drawing.mask)[0], 159.5, 0.1);
}

TEST(FilmRaster, SolidsInFrontHideLiquid) {
    const auto ball = make_ball({0, 0, 1}, 0.2, 4);
    const auto wall = [](const Vec3& x) {
        return std::max(x[0], std::abs(x[2] - 0.5) - 0.01);
    }; // the left half, nearer
    const auto solids = draw_solids(camera(), wall, 5);
    EXPECT_NEAR(double(solids.depth[120 * 320 + 10]), 0.49, 1e-3);
    EXPECT_GT(double(solids.depth[120 * 320 + 310]), 1e20);
    const auto all = draw_liquid(ball.mesh(), camera(), {}, {}),
               seen = draw_liquid(ball.mesh(), camera(), {}, solids.depth);
    EXPECT_NEAR(double(seen.mask.area()), 0.5 * double(all.mask.area()), 0.01 * double(all.mask.area()));
    EXPECT_FALSE(seen.mask.liquid(140, 120));
    EXPECT_TRUE(seen.mask.liquid(180, 120));
}

TEST(FilmRaster, LiquidBehindTheCameraIsCutAway) {
    const auto ball = make_ball({0, 0, 0}, 0.5, 3); // the camera is in it
    const auto drawing = draw_liquid(ball.mesh(), camera(), {}, {});
    EXPECT_EQ(drawing.mask.area(), std::size_t(320 * 240));
    EXPECT_EQ(draw_liquid(make_ball({0, 0, -2}, 0.5, 3).mesh(), camera(), {}, {}).mask.area(), 0u);
}

TEST(FilmRaster, PlaneLiquidWithAHoleIsFilledBetweenItsSegments) {
    const std::vector<double> points = {-0.2, -0.1, 1, 0.2, -0.1, 1, 0.2, 0.1, 1, -0.2, 0.1, 1, // outer
        -0.05, -0.05, 1, -0.05, 0.05, 1, 0.05, 0.05, 1, 0.05, -0.05, 1}; // inner, the other way round
    const std::vector<std::array<int, 3>> segments = {
        {0, 1, -1}, {1, 2, -1}, {2, 3, -1}, {3, 0, -1}, {4, 5, -1}, {5, 6, -1}, {6, 7, -1}, {7, 4, -1}};
    const auto drawing = draw_liquid({2, points, {}, {}, segments}, camera(), {}, {});
    EXPECT_NEAR(covered(drawing), 160 * 80 - 40 * 40, 1);
    EXPECT_TRUE(drawing.mask.liquid(100, 120));
    EXPECT_FALSE(drawing.mask.liquid(160, 120));
}
