#include "search/problem/box.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace treacle::search {
namespace {

const double infinite = std::numeric_limits<double>::infinity();

std::vector<Axis> kinds() {
    return {
        {-1, 3, 0, 0.5}, {-1, infinite, 0, 1}, {-infinite, 2, 0, 1}, {0, 0.1, 0.05, 1}, {-infinite, infinite, 0, 1}};
}

TEST(Box, MapsEverythingInside) {
    for (const Axis& axis : kinds())
        for (double y = -9; y < 9; y += 0.0137) {
            const double x = Box({axis}).inside({y})[0];
            EXPECT_GE(x, axis.lower);
            EXPECT_LE(x, axis.upper);
        }
}

TEST(Box, IsContinuousWithItsSlope) {
    const double h = 1e-5;
    for (const Axis& axis : kinds()) {
        const Box box({axis});
        for (double y = -9; y < 9; y += 0.0137) {
            const double before = box.inside({y - h})[0], here = box.inside({y})[0], after = box.inside({y + h})[0];
            EXPECT_LE(std::abs(after - here), 1.001 * h);
            // The curvature is at most 1 / (2 a), and a is at least 0.05.
            EXPECT_LE(std::abs(after - 2 * here + before), 10.1 * h * h + 1e-15);
        }
    }
}

TEST(Box, ReachesEveryPointBoundsIncluded) {
    for (const Axis& axis : kinds()) {
        const Box box({axis});
        const double low = std::max(axis.lower, -5.0), high = std::min(axis.upper, 5.0);
        for (int k = 0; k <= 50; ++k) {
            const double x = low + (high - low) * k / 50;
            EXPECT_NEAR(box.inside(box.preimage({x}))[0], x, 1e-14);
        }
    }
}

TEST(Box, ChangesNothingAwayFromBounds) {
    const Box box({{-1, 3, 0, 0.5}});
    for (const double x : {-0.75, 0.0, 1.0, 2.75}) EXPECT_EQ(box.inside({x})[0], x); // a is half a step
}

} // namespace
} // namespace treacle::search
