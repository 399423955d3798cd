#include "identify/compare/velocity_sampler.hpp"

#include <gtest/gtest.h>

#include <random>

namespace treacle::identify {
namespace {

// A block of particles, not quite on a lattice, with a velocity by their place.
struct Block {
    std::vector<double> positions, velocities;
    static constexpr double spacing = 0.01;

    template <class Velocity>
    Block(int dimensions, const Velocity& velocity) {
        std::mt19937 generator{5};
        std::uniform_real_distribution<double> jitter(-0.2 * spacing, 0.2 * spacing);
        const int n = 10, deep = dimensions == 2 ? 1 : n;
        for (int i = 0; i < n * n * deep; ++i) {
            const Vec3 x{(0.5 + i % n) * spacing + jitter(generator), (0.5 + i / n % n) * spacing + jitter(generator),
                dimensions == 2 ? 0 : (0.5 + i / n / n) * spacing + jitter(generator)};
            const Vec3 u = velocity(x);
            positions.insert(positions.end(), x.begin(), x.end());
            velocities.insert(velocities.end(), u.begin(), u.end());
        }
    }
};

Vec3 linear(const Vec3& x) { return {1 + 2 * x[0] - x[1], 3 * x[2], 0.5 - x[0]}; }

TEST(VelocitySampler, LinearFieldsAreExactWithTheirGradient) {
    const Block block(3, linear);
    const VelocitySampler sampler(block.positions, block.velocities, Block::spacing, 3);
    for (const Vec3 x : {Vec3{0.05, 0.05, 0.05}, Vec3{0.041, 0.063, 0.002}, Vec3{0, 0.05, 0.05}}) {
        const auto local = sampler.at(x);
        ASSERT_TRUE(local);
        const auto u = linear(x);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(local->velocity[k], u[k], 1e-10);
        EXPECT_NEAR(local->gradient[0][1], -1, 1e-8);
        EXPECT_NEAR(local->gradient[1][2], 3, 1e-8);
        EXPECT_NEAR(local->gradient[2][2], 0, 1e-8);
    }
}

TEST(VelocitySampler, InThePlaneTheThirdDirectionIsLeftOut) {
    const Block block(2, [](const Vec3& x) { return Vec3{x[1], -2 * x[0], 0}; });
    const VelocitySampler sampler(block.positions, block.velocities, Block::spacing, 2);
    const auto local = sampler.at({0.05, 0.04, 0});
    ASSERT_TRUE(local);
    EXPECT_NEAR(local->velocity[0], 0.04, 1e-12);
    EXPECT_NEAR(local->gradient[1][0], -2, 1e-9);
    EXPECT_EQ(local->gradient[0][2], 0);
}

TEST(VelocitySampler, OutsideOfTheLiquidThereIsNothing) {
    const Block block(3, linear);
    const VelocitySampler sampler(block.positions, block.velocities, Block::spacing, 3);
    EXPECT_FALSE(sampler.at({0.05, 0.05, 0.112}));
    EXPECT_FALSE(sampler.at({0.5, 0.5, 0.5}));
    EXPECT_TRUE(sampler.at({0.05, 0.05, 0.098}));
}

} // namespace
} // namespace treacle::identify
