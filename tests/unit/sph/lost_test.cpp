#include "sample.hpp"

#include <gtest/gtest.h>
#include <limits>

namespace treacle::sph::lost_test {
namespace {

constexpr double dt = 0.01; // [s]

// Particles out of each other's reach; x_max is open, y periodic, the rest walls.
Sample scattered() {
    auto domain =
        make_domain(3, {0, 0, 0}, {24 * spacing, 24 * spacing, 24 * spacing}, {.periodic = {false, true, false}});
    domain.faces[1].kind = scene::BoundaryKind::open;
    domain.faces[1].outflow = true;
    Sample sample{make_setup(domain), {}, {}};
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 4; ++j) {
            for (int k = 0; k < 4; ++k)
                sample.liquid.push_back({{(4 * i + 1) * spacing, (6 * j + 1) * spacing, (6 * k + 1) * spacing}});
        }
    }
    return sample;
}

struct Outcome {
    StepReport report;
    std::map<std::int64_t, LossCause> lost; // of all ranks
    std::map<std::int64_t, State> left;
};
Outcome advance(const Sample& sample) {
    const auto comm = Comm::world();
    IsphStep step(comm, sample.setup);
    put(comm, sample, step.liquid(), step.solid());
    step.start();
    Outcome out{step.advance(dt), {}, {}};
    std::vector<std::int64_t> entries;
    for (const auto& particle : out.report.lost) {
        entries.push_back(particle.id);
        entries.push_back(static_cast<std::int64_t>(particle.cause));
    }
    entries = comm.all_gather(std::span<const std::int64_t>(entries));
    for (std::size_t k = 0; k + 1 < entries.size(); k += 2) out.lost[entries[k]] = LossCause(entries[k + 1]);
    step.advance(dt); // the rest goes on
    out.left = all_states(comm, step.liquid());
    return out;
}

} // namespace

TEST(LostParticles, AreTakenOutAndCountedByCause) {
    auto sample = scattered();
    auto& liquid = sample.liquid;
    const std::size_t out = 95, leaking = 0, wild = 40, not_a_number = 17, around = 60, infinite = 71;
    liquid[out].u = {4 * spacing / dt, 0, 0};      // through the open side
    liquid[leaking].u = {0, 0, -3 * spacing / dt}; // beyond the wall by more than the leak depth
    liquid[not_a_number].u[1] = std::numeric_limits<double>::quiet_NaN();
    liquid[infinite].u[2] = std::numeric_limits<double>::infinity();
    liquid[wild].u = {0, 60 * spacing / dt, 0};   // farther than the period in one step
    liquid[around].u = {0, 20 * spacing / dt, 0}; // around the periodic side: not lost
    const auto outcome = advance(sample);
    const std::map<std::int64_t, LossCause> expected{{id_of(leaking), LossCause::leak}, {id_of(wild), LossCause::leak},
        {id_of(not_a_number), LossCause::non_finite}, {id_of(infinite), LossCause::non_finite}};
    EXPECT_EQ(outcome.lost, expected); // what flows out is no loss
    EXPECT_EQ(outcome.report.lost_by_cause, (std::array<std::int64_t, loss_causes>{1, 2, 2, 0}));
    EXPECT_EQ(outcome.left.size(), liquid.size() - 5);
    for (const auto& [id, cause] : expected) EXPECT_EQ(outcome.left.count(id), 0u);
    EXPECT_EQ(outcome.left.count(id_of(out)), 0u);
    const auto& box = sample.setup.domain;
    const auto& y = outcome.left.at(id_of(around)).x[1];
    EXPECT_GE(y, box.lo[1]);
    EXPECT_LT(y, box.hi[1]);
}

TEST(LostParticles, WhatLeavesThroughAnOpenSideThatLetsNothingGoIsLost) {
    auto sample = scattered();
    auto domain =
        make_domain(3, {0, 0, 0}, {24 * spacing, 24 * spacing, 24 * spacing}, {.periodic = {false, true, false}});
    domain.faces[1].kind = scene::BoundaryKind::open;
    sample.setup = make_setup(domain);
    sample.liquid[95].u = sample.liquid[94].u = {4 * spacing / dt, 0, 0};
    auto outcome = advance(sample);
    EXPECT_EQ(outcome.report.lost_by_cause, (std::array<std::int64_t, loss_causes>{0, 0, 0, 2}));
    EXPECT_EQ(outcome.lost,
        (std::map<std::int64_t, LossCause>{{id_of(94), LossCause::open_side}, {id_of(95), LossCause::open_side}}));
    EXPECT_EQ(outcome.left.size(), sample.liquid.size() - 2);
    // An outlet in front of it takes them.
    sample.setup.inflow.outlets = {{.box = false, .point = {24 * spacing, 0, 0}, .normal = {-1, 0, 0}}};
    outcome = advance(sample);
    EXPECT_EQ(outcome.report.lost_by_cause, (std::array<std::int64_t, loss_causes>{2, 0, 0, 0}));
    EXPECT_TRUE(outcome.lost.empty());
}

TEST(LostParticles, ReportsSayWhereTheyWere) {
    auto sample = scattered();
    const double speed = -3 * spacing / dt;
    sample.liquid[0].u = {speed, 0, 0};
    const auto comm = Comm::world();
    IsphStep step(comm, sample.setup);
    put(comm, sample, step.liquid(), step.solid());
    step.start();
    const auto report = step.advance(dt);
    EXPECT_EQ(comm.sum(std::int64_t(report.lost.size())), 1);
    for (const auto& particle : report.lost) {
        EXPECT_EQ(particle.velocity[0], speed);
        EXPECT_NEAR(particle.position[0], sample.liquid[0].x[0] + speed * dt, 1e-12);
    }
}

TEST(LostParticles, AWallHoldsThemUpToTheLeakDepthAndAnOpenSideNotAtAll) {
    auto sample = scattered();
    const double into_wall = (1 + 1.4) * spacing / dt, past = (1 + 1.6) * spacing / dt; // leak depth is 1.5 d
    sample.liquid[0].u = {0, 0, -into_wall};
    sample.liquid[4].u = {0, 0, -past};
    sample.liquid[95].u = {(24 - 21 + 0.01) * spacing / dt, 0, 0};
    const auto outcome = advance(sample);
    EXPECT_EQ(outcome.lost, (std::map<std::int64_t, LossCause>{{id_of(4), LossCause::leak}}));
    EXPECT_EQ(outcome.report.lost_by_cause[0], 1);
}

TEST(Totals, AreSumsOverTheParticlesOfAllRanks) {
    auto sample = scattered();
    test::Random random(2);
    double p[3] = {}, l[3] = {}, kinetic = 0, potential = 0, fastest = 0;
    const double m = sample.setup.constants.mass;
    for (auto& point : sample.liquid) {
        for (double& u : point.u) u = random.unit() - 0.5;
        const auto& [x, u, pressure, which] = point;
        double u2 = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] += m * u[k];
            l[k] += m * (x[(k + 1) % 3] * u[(k + 2) % 3] - x[(k + 2) % 3] * u[(k + 1) % 3]);
            u2 += u[k] * u[k];
        }
        kinetic += 0.5 * m * u2;
        potential += m * 9.81 * x[2];
        fastest = std::max(fastest, std::sqrt(u2));
    }
    const auto comm = Comm::world();
    LiquidParticles liquid;
    SolidParticles solid;
    put(comm, sample, liquid, solid);
    const auto totals = measure_totals(comm, liquid, sample.setup.constants, {0, 0, -9.81}, liquid.velocity());
    EXPECT_EQ(totals.particles, std::int64_t(sample.liquid.size()));
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(totals.momentum[k], p[k], 1e-12 * m * 96);
        EXPECT_NEAR(totals.angular_momentum[k], l[k], 1e-12 * m * 96 * 1.5);
    }
    EXPECT_NEAR(totals.mass, 96 * m, 1e-12 * 96 * m);
    EXPECT_NEAR(totals.kinetic_energy, kinetic, 1e-12 * kinetic);
    EXPECT_NEAR(totals.potential_energy, potential, 1e-12 * potential);
    EXPECT_NEAR(totals.max_speed, fastest, 1e-14 * fastest);
    const LiquidParticles none;
    EXPECT_EQ(measure_totals(comm, none, sample.setup.constants, {0, 0, -9.81}, none.velocity()).max_speed, 0);
}

} // namespace treacle::sph::lost_test
