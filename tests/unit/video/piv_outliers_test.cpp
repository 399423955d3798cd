#include "video/piv/piv_outliers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace treacle::video {
namespace {

// A field with a steep jet, noise of 2 % of its speed, and some vectors that point anywhere.
struct Noisy {
    PivField field;
    std::set<std::size_t> outliers;

    explicit Noisy(double fraction, int seed = 1) {
        std::mt19937 generator{std::uint32_t(seed)};
        std::normal_distribution<double> normal(0, 0.02);
        std::uniform_real_distribution<double> any(-1, 1), chance(0, 1);
        for (int row = 0; row < 30; ++row) {
            for (int column = 0; column < 24; ++column) {
                const double x = column - 12, y = row - 15, far = 1 / (1 + 0.05 * (x * x + y * y));
                const auto i = field.x.size();
                field.x.push_back(0.5 * column);
                field.y.push_back(15 - 0.5 * row);
                field.u.push_back(0.3 * x * y / 100 * far + normal(generator));
                field.v.push_back(-far + normal(generator));
                field.valid.push_back(1);
                if (chance(generator) >= fraction) continue;
                field.u[i] = any(generator);
                field.v[i] = any(generator);
                outliers.insert(i);
            }
        }
    }
};

TEST(RejectOdd, FindsOutliersAndSparesTheRest) {
    std::size_t found = 0, all = 0, spared = 0, good = 0;
    for (int seed = 1; seed <= 5; ++seed) {
        Noisy noisy(0.05, seed);
        reject_odd(noisy.field, 2, 0.04);
        for (std::size_t i = 0; i < noisy.field.x.size(); ++i) {
            const bool outlier = noisy.outliers.contains(i);
            (outlier ? all : good) += 1;
            (outlier ? found : spared) += (noisy.field.valid[i] == 0) == outlier;
        }
    }
    // Those that point where their neighbours do, within some noises, cannot be detected: a circle of 0.1 in a square
    // of 2 x 2.
    EXPECT_GE(double(found), 0.95 * double(all));
    EXPECT_GE(double(spared), 0.97 * double(good));
}

TEST(RejectOdd, WithoutNoiseOrOutliersNothingIsLost) {
    PivField uniform;
    for (int i = 0; i < 100; ++i) {
        uniform.x.push_back(i % 10);
        uniform.y.push_back(i / 10);
        uniform.u.push_back(0.1 * (i % 10));
        uniform.v.push_back(1);
        uniform.valid.push_back(1);
    }
    EXPECT_EQ(reject_odd(uniform, 2, 0.02), 0u);
    uniform.v[55] = -1;
    uniform.valid[54] = 0; // not measured: no neighbour
    EXPECT_EQ(reject_odd(uniform, 2, 0.02), 1u);
    EXPECT_EQ(uniform.valid[55], 0);
}

TEST(RejectOdd, AVectorWithoutNeighboursIsKept) {
    PivField lonely{{0, 10, 20}, {0, 10, 20}, {1, -1, 1}, {0, 0, 5}, {1, 1, 1}, "m", "m/s", "CSV"};
    EXPECT_EQ(reject_odd(lonely, 2, 0.01), 0u);
}

} // namespace
} // namespace treacle::video
