#include "base/text/error.hpp"
#include "scene/sampling/sampling.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <set>

using namespace treacle;
using namespace treacle::scene;

namespace {

constexpr auto W = Side::wall;
constexpr auto O = Side::open;
constexpr auto P = Side::periodic;

WallSampling walls(const Vec3& max, double d, double outset, std::array<Side, 6> sides, int dimensions = 3) {
    return {{d, {0, 0, 0}, max, dimensions}, sides, outset, {}};
}

// Largest distance from a point of the closed layer around the domain to its nearest sample, in spacings.
double largest_gap(const WallSampling& s, const WallSamples& samples) {
    double worst = 0;
    const int n = 40;
    const int dims = s.lattice.dimensions;
    for (int side = 0; side < 2 * dims; ++side)
        for (int j = 0; j <= (dims == 3 ? n : 0); ++j)
            for (int i = 0; i <= n; ++i) {
                const double fraction[2] = {double(i) / n, double(j) / n};
                Vec3 x{0, 0, 0};
                for (int a = 0, t = 0; a < dims; ++a) {
                    const double low = s.lattice.min[a] - s.outset, high = s.lattice.max[a] + s.outset;
                    x[a] = a == side / 2 ? (side % 2 ? high : low) : low + fraction[t++] * (high - low);
                }
                double best = 1e300;
                for (const Vec3& p : samples.positions)
                    best = std::min(best, std::hypot(p[0] - x[0], p[1] - x[1], p[2] - x[2]));
                worst = std::max(worst, best);
            }
    return worst / s.lattice.spacing;
}

} // namespace

TEST(WallSampling, LiesOnTheLatticeOfTheLiquidAlongTheFace) {
    const auto s = walls({1, 1, 1}, 0.1, 0.07, {O, O, W, O, O, O});
    const auto samples = sample_domain_walls(s);
    ASSERT_EQ(samples.positions.size(), 100u);
    std::set<Vec3> positions(samples.positions.begin(), samples.positions.end());
    for (int k = 0; k < 10; ++k)
        for (int i = 0; i < 10; ++i) {
            Vec3 x = s.lattice.position({i, 0, k});
            x[1] = -0.07;
            EXPECT_TRUE(positions.count(x)) << i << " " << k;
        }
    for (const Vec3& n : samples.normals) EXPECT_EQ(n, (Vec3{0, 1, 0}));
}

TEST(WallSampling, ATankIsClosedAtEdgesAndCornersWithoutDoubles) {
    for (const double outset : {0.0, 0.03, 0.05, 0.071, 0.1, 0.16})
        for (const Vec3& max : {Vec3{1, 0.5, 0.7}, Vec3{0.96, 0.53, 0.69}}) {
            const auto s = walls(max, 0.1, outset, {W, W, W, W, W, W});
            const auto samples = sample_domain_walls(s);
            EXPECT_EQ(samples.positions.size(), count_domain_walls(s));
            // A square lattice of step d leaves 0.707 d.
            EXPECT_LE(largest_gap(s, samples), 0.7072) << outset;
            double least = 1;
            for (std::size_t i = 0; i < samples.positions.size(); ++i)
                for (std::size_t j = 0; j < i; ++j) {
                    const Vec3 &a = samples.positions[i], &b = samples.positions[j];
                    least = std::min(least, std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
                }
            EXPECT_GE(least, 0.05 - 1e-9) << outset; // no step is cut shorter than half a spacing
        }
}

TEST(WallSampling, APlaneTankIsClosed) {
    for (const double outset : {0.0, 0.05, 0.08}) {
        const auto s = walls({1, 0.5, 0}, 0.1, outset, {W, W, W, W, O, O}, 2);
        const auto samples = sample_domain_walls(s);
        EXPECT_LE(largest_gap(s, samples), 0.5 + 1e-9) << outset; // half a step of a line
        for (const Vec3& x : samples.positions) EXPECT_EQ(x[2], 0);
    }
    // Two walls of 10, two of 5, four corners; at half a spacing the corners are lattice points.
    EXPECT_EQ(sample_domain_walls(walls({1, 0.5, 0}, 0.1, 0.05, {W, W, W, W, O, O}, 2)).positions.size(), 34u);
}

TEST(WallSampling, EndsWithTheDomainNextToOpenAndPeriodicSides) {
    for (const Side end : {O, P}) {
        const auto samples = sample_domain_walls(walls({1, 1, 1}, 0.1, 0.07, {end, end, W, W, O, O}));
        EXPECT_EQ(samples.positions.size(), 200u);
        for (const Vec3& x : samples.positions) {
            EXPECT_GE(x[0], 0.05 - 1e-12);
            EXPECT_LE(x[0], 0.95 + 1e-12);
        }
    }
}

TEST(WallSampling, APeriodicEdgeMustFitTheLattice) {
    try {
        sample_domain_walls(walls({1.04, 1, 1}, 0.1, 0.07, {P, P, W, W, O, O}));
        FAIL() << "a lattice that does not close was accepted";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("along x"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("make it 1 m"), std::string::npos) << error.what();
    }
}

TEST(WallSampling, NormalsOfEdgesAndCornersPointIntoTheDomain) {
    const auto samples = sample_domain_walls(walls({1, 1, 1}, 0.1, 0.05, {W, W, W, W, W, W}));
    const auto corner = std::find(samples.positions.begin(), samples.positions.end(), Vec3{-0.05, -0.05, -0.05});
    ASSERT_NE(corner, samples.positions.end());
    const Vec3 n = samples.normals[std::size_t(corner - samples.positions.begin())];
    for (const double c : n) EXPECT_NEAR(c, 1 / std::sqrt(3), 1e-15);
    EXPECT_EQ(samples.faces[std::size_t(corner - samples.positions.begin())], 0);
}

TEST(WallSampling, AnyCutOfTheDomainGivesTheSameParticlesBitForBit) {
    auto s = walls({1, 0.6, 0.8}, 0.1, 0.07, {W, W, W, O, W, W});
    const auto whole = sample_domain_walls(s);
    std::map<std::uint64_t, Vec3> expected;
    for (std::size_t i = 0; i < whole.ids.size(); ++i) expected[whole.ids[i]] = whole.positions[i];
    ASSERT_EQ(expected.size(), count_domain_walls(s));
    EXPECT_EQ(expected.rbegin()->first, expected.size() - 1);
    const double cuts[3][4] = {{0, 0.25, 0.61, 1}, {0, 0.15, 0.3, 0.6}, {0, 0.4, 0.41, 0.8}};
    std::map<std::uint64_t, Vec3> together;
    std::size_t count = 0;
    for (int p = 0; p < 27; ++p) {
        const int at[3] = {p % 3, p / 3 % 3, p / 9};
        for (int a = 0; a < 3; ++a) {
            s.part.min[a] = cuts[a][at[a]];
            s.part.max[a] = cuts[a][at[a] + 1];
        }
        const auto samples = sample_domain_walls(s);
        count += samples.ids.size();
        for (std::size_t i = 0; i < samples.ids.size(); ++i) together[samples.ids[i]] = samples.positions[i];
    }
    EXPECT_EQ(count, expected.size());
    EXPECT_EQ(together, expected);
}
