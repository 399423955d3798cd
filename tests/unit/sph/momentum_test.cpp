#include "change.hpp"

namespace treacle::sph::momentum_test {
namespace {

constexpr double dt = 0.5; // [s]

// A jittered block that fills several ranks, with random pressures and velocities.
Sample blob(int dimensions, std::array<bool, 3> periodic) {
    const int nz = dimensions == 3 ? 7 : 1;
    const Vec3 size{10 * spacing, 8 * spacing, nz * spacing};
    Sample sample{make_setup(make_domain(dimensions, {0, 0, 0}, size, {scene::BoundaryKind::open, periodic})), {}, {}};
    add_block(sample, {{spacing / 2, spacing / 2, spacing / 2}, {10, 8, nz}, spacing, 0.3});
    test::Random random(4);
    for (auto& point : sample.liquid) {
        point.p = 1000 * random.unit();
        for (int k = 0; k < dimensions; ++k) point.u[std::size_t(k)] = 2 * random.unit() - 1;
    }
    return sample;
}

} // namespace

// Round-off of some thousand pair forces: 1e-16 times the root of their number, of the sum of their sizes.
constexpr double tolerance = 1e-12;

TEST(Momentum, PressureForcesOfTheLiquidOnItselfCancel) {
    for (const bool periodic : {false, true}) {
        for (const int dimensions : {2, 3}) {
            auto sample = blob(dimensions, {periodic, periodic, false});
            for (auto& point : sample.liquid) point.u = {0, 0, 0};
            Parts parts(Comm::world(), sample);
            const auto before = all_states(parts.comm, parts.liquid);
            parts.push(dt);
            const auto sum = change(parts, before);
            ASSERT_GT(sum.size, 1);
            for (const double p : sum.momentum) EXPECT_NEAR(p, 0, tolerance * sum.size);
            if (periodic) continue; // images have other lever arms
            for (const double l : sum.angular) EXPECT_NEAR(l, 0, tolerance * sum.size);
        }
    }
}

TEST(Momentum, ViscousForcesOfTheLiquidOnItselfCancelAndSlowItDown) {
    auto sample = blob(3, {false, false, false});
    sample.setup.forces.viscosity = 0.5;
    sample.setup.forces.artificial = 0.02;
    Parts parts(Comm::world(), sample);
    const auto before = all_states(parts.comm, parts.liquid);
    const double step = 0.1 * viscous_step_limit(parts.setup.constants, 0.5);
    apply_forces(parts.step(), parts.setup.forces, step);
    const auto sum = change(parts, before);
    ASSERT_GT(sum.size, 1e-3);
    for (const double p : sum.momentum) EXPECT_NEAR(p, 0, tolerance * sum.size);
    for (const double l : sum.angular) EXPECT_NEAR(l, 0, tolerance * sum.size);
    double gained = 0;
    for (const auto& [id, now] : all_states(parts.comm, parts.liquid)) {
        for (std::size_t k = 0; k < 3; ++k) gained += now.u[k] * now.u[k] - before.at(id).u[k] * before.at(id).u[k];
    }
    EXPECT_LT(gained, 0) << "kinetic energy falls";
}

TEST(Momentum, LiquidAndBodiesExchangeEqualForcesAndTorques) {
    auto sample = blob(3, {false, false, false});
    std::erase_if(sample.liquid, [](const auto& point) {
        return point.x[0] > 3 * spacing && point.x[0] < 6 * spacing && point.x[1] < 4 * spacing;
    });
    add_shell(sample, {4 * spacing, 0.5 * spacing, 0.6 * spacing}, {3, 3, 5}, 1);
    for (int j = 0; j < 8; ++j) {
        for (int i = 0; i < 10; ++i)
            sample.solid.push_back({{(i + .5) * spacing, (j + .5) * spacing, -0.6 * spacing}, 0});
    }
    Parts parts(Comm::world(), sample);
    const auto before = all_states(parts.comm, parts.liquid);
    const auto loads = parts.push(dt);
    const auto sum = change(parts, before);
    ASSERT_EQ(loads.size(), 12u);
    double size = 0;
    for (const double l : loads) size += std::abs(l);
    EXPECT_GT(std::abs(loads[2]), 1e-3 * size) << "the floor is pushed";
    EXPECT_LT(loads[2], 0) << "downwards";
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(sum.momentum[k] / dt + loads[k] + loads[6 + k], 0, tolerance * sum.size / dt);
        EXPECT_NEAR(sum.angular[k] / dt + loads[3 + k] + loads[9 + k], 0, tolerance * sum.size / dt);
    }
    // And the loads are no accident of the division among the ranks.
    Parts alone(Comm::self(), sample);
    const auto expected = alone.push(dt);
    for (std::size_t k = 0; k < loads.size(); ++k) EXPECT_NEAR(loads[k], expected[k], tolerance * size);
}

TEST(Momentum, XsphMovesNoMomentum) {
    auto sample = blob(3, {true, false, false});
    sample.setup.options.viscosity.xsph = 0.3;
    Parts parts(Comm::world(), sample);
    compute_xsph(parts.setup.options, parts.setup.constants, parts.liquid, parts.solid, parts.neighbours);
    const auto c = test::on_host(parts.liquid.acceleration());
    double sum[4] = {0, 0, 0, 0};
    for (int i = 0; i < parts.liquid.store.owned(); ++i) {
        for (int k = 0; k < 3; ++k) {
            sum[k] += c(i, k);
            sum[3] += std::abs(c(i, k));
        }
    }
    parts.comm.sum(std::span<double>(sum));
    ASSERT_GT(sum[3], 1);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum[k], 0, tolerance * sum[3]);
}

} // namespace treacle::sph::momentum_test
