#include "../sph/solver_environment.hpp"
#include "grid/transport/inflow.hpp"
#include "step_sample.hpp"

#include <gtest/gtest.h>

namespace treacle::grid::inflow_test {
namespace {

constexpr double dx = 1.0 / 16, spacing = dx / 2; // [m]
constexpr double speed = 1;                       // [m/s]

// An opening of `across` particles, in space squared.
flow::InletSetup square_inlet(
    const Vec3& centre, const Vec3& direction, const Vec3& along, int across, int dimensions) {
    flow::InletSetup inlet;
    inlet.centre = centre;
    inlet.direction = direction;
    inlet.along = along;
    inlet.speed = speed;
    const Vec3 second = rigid::cross(direction, along);
    for (int j = 0; j < (dimensions == 3 ? across : 1); ++j) {
        for (int i = 0; i < across; ++i) {
            const double a = (i - 0.5 * (across - 1)) * spacing,
                         b = dimensions == 3 ? (j - 0.5 * (across - 1)) * spacing : 0;
            Vec3 point;
            for (std::size_t k = 0; k < 3; ++k) point[k] = a * along[k] + b * second[k];
            inlet.points.push_back(point);
        }
    }
    return inlet;
}

// Empty space with an inlet.
StepSample pouring(int dimensions, const flow::InletSetup& inlet) {
    auto sample = sample_of(16, dimensions);
    auto& setup = sample.setup;
    for (auto& face : setup.domain.faces) face.kind = scene::BoundaryKind::open;
    setup.domain.gravity = setup.rigid.gravity = {0, 0, 0};
    setup.options.pressure.residual = setup.options.viscosity.residual = 1e-12;
    setup.inflow.inlets = {inlet};
    setup.inflow.first_id = 100000;
    setup.rigid.bodies = make_inlet_bodies(setup.inflow, make_mac_grid(setup.domain));
    setup.slip = {{scene::Slip::no_slip}, {0}};
    sample.liquid = [](const Vec3&) { return 1.0; };
    return sample;
}

double along(const flow::InletSetup& inlet, const std::array<double, 6>& state) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += (state[k] - inlet.centre[k]) * inlet.direction[k];
    return sum;
}

[[maybe_unused]] const auto* const solvers = testing::AddGlobalTestEnvironment(new sph::SolverEnvironment);

class Inlet : public testing::Test {
protected:
    const Comm comm = Comm::world();
};

// Wherever the opening is among the cells and its direction: what flows in moves on as a whole.
TEST_F(Inlet, AJetWithoutForcesKeepsItsSpeedAndLeavesNoGap) {
    const double c = std::cos(0.5), s = std::sin(0.5);
    const std::pair<Vec3, Vec3> ways[] = {{{1, 0, 0}, {0, 1, 0}}, {{0, 0, -1}, {1, 0, 0}}, {{c, s, 0}, {0, 0, 1}}};
    for (const double viscosity : {0.0, 10.0}) {
        for (const auto& [direction, row] : ways) {
            const auto inlet =
                square_inlet({0.52 - 0.2 * direction[0], 0.47 - 0.2 * direction[1], 0.55 - 0.2 * direction[2]},
                    direction, row, 6, 3);
            auto sample = pouring(3, inlet);
            sample.setup.viscosity = viscosity;
            auto step = started(comm, sample);
            double time = 0;
            for (int k = 0; k < 10; ++k) {
                const double dt = dx * (k % 3 == 0 ? 0.5 : 1); // steps that differ
                step->advance(dt);
                time += dt;
            }
            const std::int64_t layers = flow::layers_until(inlet, layers_of(step->grid()), time);
            EXPECT_EQ(step->emitted(), 36 * layers);
            EXPECT_EQ(step->totals().particles, 36 * layers);
            std::array<std::int64_t, 64> in_slice{};
            for (const auto& [id, state] : states(*step)) {
                double u = 0;
                for (std::size_t k = 0; k < 3; ++k) u += state[3 + k] * direction[k];
                EXPECT_NEAR(u, speed, 1e-6) << id; // the solves' residuals
                ASSERT_GT(along(inlet, state), -1e-9);
                ++in_slice[std::size_t(along(inlet, state) / dx)];
            }
            comm.sum(std::span<std::int64_t>(in_slice));
            // Slices of two layers: one of them may be on either side but for what the correction of places moved.
            for (std::size_t k = 0; double(k + 2) * dx < speed * time; ++k)
                EXPECT_NEAR(double(in_slice[k]), 72, 40) << k;
        }
    }
}

// A stiff rope hangs from its inlet: where its weight would make it fall at g t, it keeps the inlet's speed but for what it
// strains by, rho g L^2 / (4 mu) in the plane.
TEST_F(Inlet, HoldsAStiffRope) {
    const auto inlet = square_inlet({0.5, 0.75, 0}, {0, -1, 0}, {1, 0, 0}, 6, 2);
    auto sample = pouring(2, inlet);
    sample.setup.domain.gravity = sample.setup.rigid.gravity = {0, -9.81, 0};
    sample.setup.viscosity = 1e5;
    auto step = started(comm, sample);
    double time = 0;
    for (int k = 0; k < 20; ++k) {
        step->advance(0.25 * dx / speed);
        time += 0.25 * dx / speed;
    }
    const double strain = 1000 * 9.81 * time * time / (4 * 1e5);
    for (const auto& [id, state] : states(*step)) {
        EXPECT_NEAR(state[4], -speed, 2 * strain * speed + 1e-3) << id;
        EXPECT_NEAR(state[3], 0, 2 * strain * speed + 1e-3) << id;
    }
}

// From shortly above the floor, and in the end from below the surface.
TEST_F(Inlet, FillsATankByItsFlowRate) {
    const auto inlet = square_inlet({0.3, 0.3, 0}, {0, -1, 0}, {1, 0, 0}, 6, 2);
    auto sample = pouring(2, inlet);
    sample.setup.options.pressure.residual = sample.setup.options.viscosity.residual =
        1e-8;             // nothing is compared to more
    const double end = 3; // [s]
    for (auto& face : sample.setup.domain.faces) face.kind = scene::BoundaryKind::wall;
    sample.setup.domain.gravity = sample.setup.rigid.gravity = {0, -9.81, 0};
    sample.setup.inflow.inlets[0].end = end;
    sample.setup.rigid.bodies = make_inlet_bodies(sample.setup.inflow, make_mac_grid(sample.setup.domain));
    sample.setup.viscosity = 50;
    auto step = started(comm, sample);
    double time = 0;
    while (time < end + 1) {
        const double dt = std::min(0.02, step->stable_step(1));
        const auto report = step->advance(dt);
        EXPECT_EQ(report.lost_by_cause[0] + report.lost_by_cause[1] + report.lost_by_cause[2], 0);
        time += dt;
    }
    const auto totals = step->totals();
    const double poured = 6 * spacing * speed * end; // [m2]
    EXPECT_EQ(totals.particles, step->emitted());
    EXPECT_NEAR(totals.mass, double(step->emitted()) * 1000 * spacing * spacing, 1e-9 * totals.mass);
    EXPECT_NEAR(totals.mass, 1000 * poured, 1000 * 6 * spacing * spacing); // a layer
    // At rest, a level surface of the volume over the floor of 1 m. Nine cells high; seen 2 %.
    EXPECT_NEAR(2 * totals.potential_energy / (9.81 * totals.mass), poured, 0.04 * poured);
}

TEST_F(Inlet, IsTheSameOnOneRankAndOnAll) {
    auto sample = pouring(3, square_inlet({0.45, 0.52, 0.7}, {0, 0, -1}, {1, 0, 0}, 6, 3));
    sample.setup.domain.gravity = sample.setup.rigid.gravity = {0, 0, -9.81};
    for (auto& face : sample.setup.domain.faces) {
        face.kind = scene::BoundaryKind::wall;
        face.slip = scene::Slip::no_slip;
    }
    sample.setup.viscosity = 3;
    sample.setup.inflow.outlets = {{true, {0, 0, 0}, {1, 1, 0.1}, {}, {}}};
    auto together = started(comm, sample), alone = started(Comm::self(), sample);
    std::int64_t out = 0;
    for (int k = 0; k < 30; ++k) {
        const double dt = std::min(0.02, alone->stable_step(1));
        out += together->advance(dt).lost_by_cause[0];
        alone->advance(dt);
    }
    EXPECT_GT(out, 0);
    const auto all = states(*alone);
    double most = 0;
    for (const auto& [id, state] : states(*together)) {
        ASSERT_TRUE(all.contains(id)) << id;
        for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::fabs(state[k] - all.at(id)[k]));
    }
    EXPECT_EQ(together->totals().particles, std::int64_t(all.size()));
    EXPECT_EQ(together->emitted(), out + std::int64_t(all.size()));
    // The solves' residuals, and what the steps make of them.
    EXPECT_LT(comm.max(most), 1e-6);
}

} // namespace
} // namespace treacle::grid::inflow_test
