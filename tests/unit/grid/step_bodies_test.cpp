#include "../total_momentum.hpp"
#include "step_sample.hpp"

#include <gtest/gtest.h>

namespace treacle::grid::step_bodies_test {
namespace {

class StepsWithSolids : public testing::Test {
protected:
    const Comm comm = Comm::world();
};

// Honey is pulled past a ball at rest in a periodic box, and sticks to it: the pull less the drag is what it gains.
TEST_F(StepsWithSolids, AreHeldUpByABodyAtRest) {
    auto sample = sample_of(16, 3);
    auto& setup = sample.setup;
    for (auto& face : setup.domain.faces) face.kind = scene::BoundaryKind::periodic;
    setup.domain.gravity = setup.rigid.gravity = {0.1, 0, 0};
    setup.viscosity = 1000;
    auto ball = ball_body({0.513, 0.513, 0.513}, 0.25, 1000);
    ball.kind = scene::BodyKind::fixed;
    setup.rigid.bodies = {ball};
    setup.slip = {{scene::Slip::no_slip}, {0}};
    sample.liquid = [](const Vec3& x) { return 0.25 - from({0.513, 0.513, 0.513}, x); };
    auto step = started(comm, sample);
    const double dt = 0.25 / (16 * 16); // nu dt / dx^2 = 1/4
    for (int k = 0; k < 10; ++k) step->advance(dt);
    const auto totals = step->totals();
    const double pulled = totals.mass * 0.1 * 10 * dt;
    EXPECT_GT(totals.momentum[0], 0.3 * pulled); // a ball of half the box' width soon holds it up
    EXPECT_LT(totals.momentum[0], 0.95 * pulled);
    EXPECT_LT(std::fabs(totals.momentum[1]) + std::fabs(totals.momentum[2]), 0.01 * pulled);
}

// Syrup spreads over a floor that grips, or that it slides along.
TEST_F(StepsWithSolids, LetParticlesAtAFloorMoveAsItHoldsThem) {
    for (const auto slip : {scene::Slip::no_slip, scene::Slip::free_slip}) {
        auto sample = sample_of(32, 2);
        sample.setup.viscosity = 20;
        sample.setup.domain.faces[2].slip = slip;
        sample.liquid = [](const Vec3& x) { return std::max(x[0] - 0.3, x[1] - 0.4); };
        auto step = started(comm, sample);
        const double dx = sample.setup.domain.spacing;
        for (double time = 0; time < 0.5;) {
            const double dt = std::min(0.02, step->stable_step(1));
            step->advance(dt);
            time += dt;
        }
        double low = 0, most = 0; // fastest of the particles below a quarter of a cell, and of all, behind the front
        for (const auto& [id, state] : states(*step)) {
            if (state[0] > 0.3) continue;
            most = std::max(most, std::fabs(state[3]));
            if (state[1] < 0.25 * dx) low = std::max(low, std::fabs(state[3]));
        }
        const double ratio = comm.max(low) / comm.max(most);
        RecordProperty(slip == scene::Slip::no_slip ? "gripped" : "sliding", std::to_string(ratio));
        if (slip == scene::Slip::no_slip) {
            EXPECT_LT(ratio, 0.25);
        } else {
            EXPECT_GT(ratio, 0.8);
        }
    }
}

// Liquid falls around a ball that grips, or that it slides along.
TEST_F(StepsWithSolids, TreatAStaticBodyAsOneThatIsMovedNowhere) {
    for (const auto slip : {scene::Slip::no_slip, scene::Slip::free_slip}) {
        std::vector<double> energies;
        for (const auto kind : {scene::BodyKind::fixed, scene::BodyKind::kinematic}) {
            auto sample = sample_of(12, 3);
            sample.setup.viscosity = 10;
            sample.liquid = [](const Vec3& x) { return from({0.5, 0.5, 0.6}, x) - 0.3; };
            auto ball = ball_body({0.5, 0.5, 0.35}, 0.2, 1000);
            ball.kind = kind;
            sample.setup.rigid.bodies = {ball};
            sample.setup.slip = {{slip}, {0}};
            auto step = started(comm, sample);
            for (int k = 0; k < 3; ++k) step->advance(0.02);
            energies.push_back(step->totals().kinetic_energy);
        }
        EXPECT_GT(energies[0], 0);
        EXPECT_NEAR(energies[0], energies[1], 1e-12 * energies[0]); // the same numbers but for the order of a few
    }
}

// A ball that flies and spins in a blob in free space, beside its middle: what the liquid loses the ball gets. That
// particles weigh the faces at surfaces otherwise than the solves do, and read faces beyond them, took 1 % in ten steps.
TEST_F(StepsWithSolids, KeepTheMomentumOfLiquidAndBody) {
    struct Case {
        scene::Slip slip;
        double viscosity;
        int dimensions;
    };
    for (const auto& [slip, viscosity, dimensions] :
        {Case{scene::Slip::no_slip, 5, 3}, Case{scene::Slip::free_slip, 1e5, 2}, Case{scene::Slip::no_slip, 0, 2},
            Case{scene::Slip::slip_length, 100, 2}}) {
        auto sample = sample_of(20, dimensions);
        for (auto& face : sample.setup.domain.faces) face.kind = scene::BoundaryKind::open;
        sample.setup.domain.gravity = sample.setup.rigid.gravity = {0, 0, 0};
        sample.setup.viscosity = viscosity;
        const double z = dimensions == 3 ? 0.5 : 0;
        auto ball = ball_body({0.5, 0.55, z}, 0.13, 2500);
        ball.velocity = {0.4, 0, 0};
        ball.angular_velocity = {0, 0, 3};
        sample.setup.rigid.bodies = {ball};
        sample.setup.rigid.dimensions = dimensions;
        sample.setup.slip = {{slip}, {0.05}};
        sample.liquid = [=](const Vec3& x) {
            return std::max(from({0.5, 0.5, z}, x) - 0.32, 0.13 - from({0.5, 0.55, z}, x));
        };
        auto step = started(comm, sample);
        const auto first = total_momentum(*step);
        for (int k = 0; k < 10; ++k) step->advance(0.01);
        const auto last = total_momentum(*step);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(last[k], first[k], 1e-10 * std::fabs(first[0])) << viscosity;
        EXPECT_NEAR(last[5], first[5], 2e-4 * std::fabs(first[5])) << viscosity;
        if (viscosity > 0) {
            EXPECT_LT(step->bodies().velocity(0)[0], 0.35);
        }
    }
}

// Two blobs of water meet off their middles and splash, away from a ball that flies by: pieces that touch no solid keep what they
// have too. What each drop's faces weigh beside its particles took 1e-3.
TEST_F(StepsWithSolids, KeepTheMomentumOfPiecesThatTouchNothing) {
    for (const int dimensions : {2, 3}) {
        auto sample = sample_of(dimensions == 3 ? 16 : 32, dimensions);
        for (auto& face : sample.setup.domain.faces) face.kind = scene::BoundaryKind::open;
        sample.setup.domain.gravity = sample.setup.rigid.gravity = {0, 0, 0};
        sample.setup.viscosity = 0.001;
        const double z = dimensions == 3 ? 0.5 : 0;
        auto ball = ball_body({0.12, 0.12, z}, 0.08, 2500);
        ball.velocity = {0.3, 0, 0};
        sample.setup.rigid.bodies = {ball};
        sample.setup.slip = {{scene::Slip::no_slip}, {0}};
        sample.liquid = [=](const Vec3& x) {
            return std::min(from({0.32, 0.57, z}, x), from({0.68, 0.63, z}, x)) - 0.15;
        };
        sample.velocity = [](const Vec3& x) { return Vec3{x[0] < 0.5 ? 1.0 : -1.0, 0, 0}; };
        const auto step = started(comm, sample);
        const auto first = total_momentum(*step);
        const double mass = step->totals().mass, energy = step->totals().kinetic_energy;
        for (int k = 0; k < 10; ++k) {
            step->advance(0.01);
            const auto now = total_momentum(*step);
            // Over the momentum of one blob.
            for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(now[axis], first[axis], 1e-11 * mass) << k;
            EXPECT_NEAR(now[5], first[5], 1e-3 * std::fabs(first[5])) << k;
        }
        EXPECT_LT(step->totals().kinetic_energy, 0.9 * energy) << "they have met";
    }
}

} // namespace
} // namespace treacle::grid::step_bodies_test
