#include "identify/experiment/observation.hpp"

#include "../own_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>

namespace treacle::identify {
namespace {

video::Mask disc(double radius, std::uint8_t strip = video::mask_background) {
    video::Mask mask{200, 150, std::vector<std::uint8_t>(200 * 150, video::mask_background)};
    for (int row = 0; row < 150; ++row) {
        for (int column = 0; column < 200; ++column) {
            auto& pixel = mask.pixels[std::size_t(row) * 200 + std::size_t(column)];
            if (std::hypot(column - 100, row - 75) < radius) pixel = video::mask_liquid;
            if (column < 60 && strip != video::mask_background) pixel = strip;
        }
    }
    return mask;
}

class ObservedFramesTest : public testing::Test {
protected:
    ObservedFramesTest() {
        std::ofstream table(folder_.path() / "silhouettes.csv");
        table << "frame,time [s],area [px]\n";
        for (int k = 0; k < 10; ++k) {
            table << k << "," << 0.1 * k << ",0\n";
            char name[32];
            std::snprintf(name, sizeof name, "mask_%06d.png", k);
            video::write_mask(folder_.path() / name, disc(30));
        }
    }
    static std::vector<int> numbers(const std::vector<ObservedFrame>& frames) {
        std::vector<int> out;
        for (const auto& frame : frames) out.push_back(frame.number);
        return out;
    }
    const test::OwnFolder folder_;
    Experiment experiment_;
};

TEST_F(ObservedFramesTest, GoByTheScenesTime) {
    experiment_.time_zero = 0.25;
    experiment_.to = 0.5;
    const auto frames = observed_frames(experiment_, folder_.path());
    EXPECT_EQ(numbers(frames), (std::vector<int>{3, 4, 5, 6, 7}));
    EXPECT_NEAR(frames[0].time, 0.05, 1e-12);
    experiment_.every = 2;
    EXPECT_EQ(numbers(observed_frames(experiment_, folder_.path())), (std::vector<int>{3, 5, 7}));
}

TEST_F(ObservedFramesTest, SayWhatIsMissing) {
    experiment_.where = "study.yaml:7";
    experiment_.from = 5;
    EXPECT_THROW(observed_frames(experiment_, folder_.path()), std::exception);
    experiment_.from = 0;
    std::filesystem::remove(folder_.path() / "mask_000004.png");
    try {
        observed_frames(experiment_, folder_.path());
        FAIL();
    } catch (const std::exception& error) {
        EXPECT_NE(std::string(error.what()).find("mask_000004.png is not there"), std::string::npos) << error.what();
    }
    std::filesystem::remove(folder_.path() / "silhouettes.csv");
    EXPECT_THROW(observed_frames(experiment_, folder_.path()), std::exception);
}

TEST(ContourSegments, CoverTheContourOnceInPiecesOfTheirLength) {
    const auto segments = contour_segments(disc(50));
    double points = 0;
    for (const auto& segment : segments) {
        points += double(segment.points.size());
        for (const auto& point : segment.points)
            EXPECT_NEAR(std::hypot(point.pixel[0] - 100, point.pixel[1] - 75), 50, 0.6);
    }
    EXPECT_NEAR(double(segments.size()), 2 * 3.14159 * 50 / 25, 2);
    EXPECT_GT(points, 0.7 * 2 * 3.14159 * 50); // a diagonal step of pixels is one point on 1.4 px
    EXPECT_TRUE(contour_segments(disc(0)).empty());
}

// The border of what is excluded is none of the liquid's.
TEST(ContourSegments, LeaveTheBorderOfExcludedPixelsOut) {
    for (const auto& segment : contour_segments(disc(50, video::mask_excluded))) {
        for (const auto& point : segment.points) EXPECT_GT(point.pixel[0], 63);
    }
    EXPECT_LT(contour_segments(disc(50, video::mask_excluded)).size(), contour_segments(disc(50)).size());
}

} // namespace
} // namespace treacle::identify
