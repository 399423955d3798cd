#include "base/text/error.hpp"
#include "video/picture/colour.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

using namespace treacle;
using namespace treacle::video;

namespace {
double luminance(const Rgb8& colour) {
    const Vec3f c = to_linear(colour);
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}
} // namespace

TEST(Colour, EncodingIsTheInverseOfDecoding) {
    for (int v = 0; v < 256; ++v) {
        const Rgb8 grey{std::uint8_t(v), std::uint8_t(v), std::uint8_t(v)};
        EXPECT_EQ(to_display(to_linear(grey)), grey);
    }
}

TEST(Colour, ViridisRunsFromDarkVioletToYellowAndOnlyGetsBrighter) {
    EXPECT_EQ(colour_of(ColourMap::viridis, 0), (Rgb8{68, 1, 84}));
    EXPECT_EQ(colour_of(ColourMap::viridis, 1), (Rgb8{253, 231, 37}));
    for (int k = 1; k <= 100; ++k)
        EXPECT_GT(luminance(colour_of(ColourMap::viridis, k / 100.0)),
            luminance(colour_of(ColourMap::viridis, (k - 1) / 100.0)));
}

TEST(Colour, DivergingMapIsBlueThenPaleThenRed) {
    const Rgb8 low = colour_of(ColourMap::diverging, 0), high = colour_of(ColourMap::diverging, 1);
    EXPECT_GT(low[2], 2 * low[0]);
    EXPECT_GT(high[0], 2 * high[2]);
    EXPECT_GT(luminance(colour_of(ColourMap::diverging, 0.5)), 0.8);
}

TEST(Colour, RobustRangeIgnoresWildValues) {
    std::vector<double> values;
    for (int k = 0; k < 1000; ++k) values.push_back(k / 999.0);
    values[17] = 1e9;
    const auto range = robust_range(values, ColourMap::viridis);
    EXPECT_NEAR(range.low, 0.01, 0.002); // one value moves a percentile of 1000 values by 1/1000
    EXPECT_NEAR(range.high, 0.99, 0.002);
}

TEST(Colour, DivergingRangeIsSymmetric) {
    const auto range = robust_range(std::vector<double>{-1, 0, 3}, ColourMap::diverging);
    EXPECT_EQ(range.low, -range.high);
    EXPECT_EQ(range.high, 3);
}

TEST(Colour, ConstantFieldsAndNoValuesHaveARange) {
    for (const double value : {0.0, 5.0, -2e-9}) {
        const auto range = robust_range(std::vector<double>{value, value}, ColourMap::viridis);
        EXPECT_LT(range.low, value);
        EXPECT_GT(range.high, value);
    }
    const auto none = robust_range({}, ColourMap::viridis);
    EXPECT_LT(none.low, none.high);
}

TEST(Colour, ValuesThatAreNotFiniteAreRefused) {
    const std::vector<double> values{0, std::numeric_limits<double>::quiet_NaN()};
    EXPECT_THROW(robust_range(values, ColourMap::viridis), SimulationError);
}

TEST(Colour, TicksAreFewRoundAndInside) {
    for (const ValueRange range : {ValueRange{0, 1}, {-3.7, 9.2}, {0, 23456}, {1e-7, 3e-7}, {998, 1002}, {-5, -4.99}}) {
        const auto ticks = nice_ticks(range);
        ASSERT_GE(ticks.size(), 2u);
        EXPECT_LE(ticks.size(), 7u);
        const double step = ticks[1] - ticks[0];
        const double digit = step / std::pow(10, std::floor(std::log10(step * 1.001)));
        EXPECT_LT(std::min({std::abs(digit - 1), std::abs(digit - 2), std::abs(digit - 5)}), 1e-6) << step;
        for (const double tick : ticks) {
            EXPECT_GE(tick, range.low - 1e-6 * step);
            EXPECT_LE(tick, range.high + 1e-6 * step);
        }
    }
}
