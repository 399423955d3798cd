#include "search/problem/random.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace treacle::search {
namespace {

using Counter = std::array<std::uint32_t, 4>;

// The vectors that come with the authors' Random123.
TEST(Random, IsPhilox) {
    EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Counter{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
    EXPECT_EQ(philox({~0U, ~0U, ~0U, ~0U}, {~0U, ~0U}), (Counter{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
    EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
        (Counter{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, QuantilesInvertTheDistribution) {
    for (const double p : {1e-300, 1e-20, 1e-12, 1e-5, 0.01, 0.07, 0.1, 0.3, 0.5, 0.6, 0.93, 0.99, 1 - 1e-9})
        EXPECT_NEAR(normal_distribution(normal_quantile(p)) / p, 1, 2e-13) << p; // |x|^2 times round-off
    EXPECT_EQ(normal_quantile(0.5), 0);
    EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-15);
}

// Tolerances: four standard errors of the moments of 60 000 numbers.
TEST(Random, NormalNumbersHaveTheirMomentsAndNoCorrelation) {
    const Random random(7);
    constexpr int n = 20000;
    double sum = 0, squares = 0, fourth = 0, neighbours = 0;
    for (std::uint32_t k = 0; k < n; ++k) {
        double before = 0;
        for (std::uint32_t i = 0; i < 3; ++i) {
            const double z = random.normal(Purpose::candidate, 5, k, i);
            sum += z;
            squares += z * z;
            fourth += z * z * z * z;
            neighbours += before * z;
            before = z;
        }
    }
    const double count = 3 * n;
    EXPECT_NEAR(sum / count, 0, 4 / std::sqrt(count));
    EXPECT_NEAR(squares / count, 1, 4 * std::sqrt(2 / count));
    EXPECT_NEAR(fourth / count, 3, 4 * std::sqrt(96 / count));
    EXPECT_NEAR(neighbours / (2 * n), 0, 4 / std::sqrt(2.0 * n));
}

TEST(Random, EachPlaceHasItsOwnNumber) {
    const Random random(7), other(8);
    const double u = random.uniform(Purpose::candidate, 1, 2, 3);
    EXPECT_EQ(u, random.uniform(Purpose::candidate, 1, 2, 3));
    EXPECT_NE(u, other.uniform(Purpose::candidate, 1, 2, 3));
    EXPECT_NE(u, random.uniform(Purpose::start, 1, 2, 3));
    EXPECT_NE(u, random.uniform(Purpose::candidate, 2, 1, 3));
    EXPECT_NE(u, random.uniform(Purpose::candidate, 1, 3, 2));
}

} // namespace
} // namespace treacle::search
