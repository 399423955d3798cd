#include "sample.hpp"
#include "solver_environment.hpp"

#include "base/text/error.hpp"

#include <gtest/gtest.h>

namespace treacle::sph::step_test {
namespace {

[[maybe_unused]] const auto* const environment = testing::AddGlobalTestEnvironment(new SolverEnvironment);

constexpr double dt = 4e-3; // [s]; 0.25 d / sqrt(g H) is 7 ms

SphOptions tight() {
    SphOptions options;
    options.pressure.stop = StoppingRule::residual;
    options.pressure.residual = 1e-13;
    options.density.kind = DensityKind::blended; // presses the liquid against its solids from the start
    return options;
}

// A column of 6 x 6 x 6 particles in the corner of a tank three times as long, periodic across, on a floor
// and between walls at the distance at which the liquid rests.
Sample dam_break() {
    const auto domain =
        make_domain(3, {0, 0, 0}, {18 * spacing, 6 * spacing, 10 * spacing}, {.periodic = {false, true, false}});
    Sample sample{make_setup(domain, tight()), {}, {}};
    const auto& c = sample.setup.constants;
    sample.setup.forces.gravity = {0, 0, -9.81};
    sample.setup.forces.artificial = 0.1 * c.support * 1.9; // sqrt(g H) is 1.9 m/s
    add_block(sample, {{spacing / 2, spacing / 2, spacing / 2}, {6, 6, 6}});
    const double gap = equilibrium_wall_distance(
        {sample.setup.options.kernel, 3, c.support, spacing, spacing}, sample.setup.options.density);
    const double out = gap - spacing / 2;
    for (int j = 0; j < 6; ++j) {
        const double y = (j + 0.5) * spacing;
        for (int i = 0; i < 18; ++i) sample.solid.push_back({{(i + 0.5) * spacing, y, -out}, 0});
        for (int k = 0; k < 10; ++k) {
            sample.solid.push_back({{-out, y, (k + 0.5) * spacing}, 0});
            sample.solid.push_back({{18 * spacing + out, y, (k + 0.5) * spacing}, 1});
        }
    }
    return sample;
}

std::map<std::int64_t, State> run(const Comm& comm, const Sample& sample, int steps) {
    const auto step = started(comm, sample);
    for (int k = 0; k < steps; ++k) step->advance(dt);
    return all_states(comm, step->liquid());
}

// Largest distance between the positions of the same particles [m].
double apart(const std::map<std::int64_t, State>& a, const std::map<std::int64_t, State>& b) {
    EXPECT_EQ(a.size(), b.size());
    double most = 0;
    for (const auto& [id, state] : a) {
        if (b.count(id) == 0) return 1e300;
        for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::abs(state.x[k] - b.at(id).x[k]));
    }
    return most;
}

// The same on each rank by itself.
std::map<std::int64_t, State> run_alone(const Sample& sample, int steps) { return run(Comm::self(), sample, steps); }

} // namespace

TEST(IsphStep, ADamBreakIsTheSameOnAnyNumberOfRanks) {
    const auto sample = dam_break();
    const auto many = run(Comm::world(), sample, 20), one = run_alone(sample, 20);
    // The solver leaves 1e-13 of the right-hand side; chaos multiplies it, by less than 1e6 in 20 steps.
    EXPECT_LT(apart(many, one), 1e-6 * spacing);
    double moved = 0;
    for (std::size_t k = 0; k < sample.liquid.size(); ++k)
        moved = std::max(moved, one.at(id_of(k)).x[0] - sample.liquid[k].x[0]);
    EXPECT_GT(moved, 0.2 * spacing) << "the column does collapse";
}

TEST(IsphStep, ARepeatedRunIsEqualBitForBit) {
    const auto sample = dam_break();
    EXPECT_EQ(run(Comm::world(), sample, 8), run(Comm::world(), sample, 8));
}

TEST(IsphStep, LiquidThatIsReadForOutputMovesAsBefore) {
    const auto sample = dam_break();
    const auto step = started(Comm::world(), sample);
    for (int k = 0; k < 8; ++k) {
        step->refresh();
        step->advance(dt);
    }
    EXPECT_EQ(all_states(Comm::world(), step->liquid()), run(Comm::world(), sample, 8));
}

// A block without solids, and steps of unlike lengths.
TEST(IsphStep, FreeFallIsAParabolaAndItsVelocityThatOfTheTimeStated) {
    const auto comm = Comm::world();
    const double g = 9.81;
    Sample sample{
        make_setup(make_domain(3, {0, 0, 0}, {18 * spacing, 6 * spacing, 40 * spacing}, {}), tight()), {}, {}};
    sample.setup.options.pressure.recovery = DensityRecovery::positions;
    sample.setup.forces.gravity = {0, 0, -g};
    add_block(sample, {{spacing, spacing, 33.5 * spacing}, {4, 4, 4}});
    const auto step = started(comm, sample);
    const auto start = all_states(comm, step->liquid());
    double t = 0;
    for (const double length : {4e-3, 4e-3, 1e-3, 3e-3, 0.5e-3, 4e-3}) {
        step->advance(length);
        t += length;
        for (const auto& [id, state] : all_states(comm, step->liquid())) {
            ASSERT_NEAR(state.x[2], start.at(id).x[2] - g * t * t / 2, 1e-13) << "at " << t << " s";
        }
        const auto u = test::on_host(step->liquid().end_velocity());
        for (int i = 0; i < step->liquid().store.owned(); ++i) ASSERT_NEAR(u(i, 2), -g * t, 1e-12);
        const auto totals = step->totals();
        EXPECT_NEAR(totals.momentum[2], -g * t * totals.mass, 1e-11 * totals.mass);
    }
}

TEST(IsphStep, ARestoredRunContinuesBitForBit) {
    const auto comm = Comm::world();
    const auto sample = dam_break();
    const auto straight = started(comm, sample);
    for (int k = 0; k < 5; ++k) straight->advance(dt);
    const auto state = straight->decomposition_state();
    IsphStep resumed(comm, sample.setup);
    const auto copy = [](const ParticleStore& from, ParticleStore& to) {
        to.resize_owned(from.owned());
        for (std::size_t f = 0; f < from.fields().size(); ++f) {
            if (from.fields()[f].role != FieldRole::state) continue;
            std::visit(
                [&](const auto& view) {
                    const auto& target = std::get<std::decay_t<decltype(view)>>(to.fields()[f].array);
                    const auto source = test::on_host(view);
                    test::edit(target, [&](auto& v) {
                        for (int i = 0; i < from.owned(); ++i) {
                            if constexpr (std::decay_t<decltype(view)>::rank == 1) {
                                v(i) = source(i);
                            } else {
                                for (int k = 0; k < 3; ++k) v(i, k) = source(i, k);
                            }
                        }
                    });
                },
                from.fields()[f].array);
        }
    };
    copy(straight->liquid().store, resumed.liquid().store);
    copy(straight->solid().store, resumed.solid().store);
    resumed.restore_history(straight->history());
    resumed.restore(state);
    for (int k = 0; k < 5; ++k) {
        straight->advance(dt);
        resumed.advance(dt);
    }
    EXPECT_EQ(all_states(comm, straight->liquid()), all_states(comm, resumed.liquid()));
}

TEST(IsphStep, RanksWithoutLiquidTakePart) {
    // Three particles: with more ranks than that some are empty.
    Sample sample{make_setup(make_domain(3, {0, 0, 0}, {24 * spacing, 24 * spacing, 24 * spacing}), tight()), {}, {}};
    sample.setup.forces.gravity = {0, 0, -9.81};
    sample.liquid = {{{2 * spacing, spacing, spacing}}, {{2.8 * spacing, spacing, spacing}, {-2, 0, 0}},
        {{20 * spacing, 9 * spacing, 9 * spacing}}};
    for (int i = 0; i < 6; ++i) sample.solid.push_back({{i * spacing, spacing, 0.1 * spacing}, 0});
    EXPECT_LT(apart(run(Comm::world(), sample, 10), run_alone(sample, 10)), 1e-6 * spacing);
    // And none at all.
    Sample none = sample;
    none.liquid.clear();
    none.solid.clear();
    const auto step = started(Comm::world(), none);
    const auto report = step->advance(dt);
    EXPECT_EQ(report.roles.poisson + report.roles.dirichlet + report.roles.separated, 0);
    EXPECT_EQ(report.imbalance, 1);
}

// A small body at one place of a bar of liquid after the other, so that it stands beside every border of
// ranks.
TEST(IsphStep, LiquidMeetsTheSolidsOfOtherRanksWhereItsOwnRankHasNone) {
    const auto solids_around = [](const Comm& comm, const Sample& sample) {
        const auto step = started(comm, sample);
        step->advance(1e-6);
        const auto offset = test::on_host(step->neighbours().solid.offset);
        const int n = step->liquid().store.owned();
        const Array<int> counts("treacle::counts", std::size_t(n));
        test::edit(counts, [&](auto& v) {
            for (int i = 0; i < n; ++i) v(i) = int(offset(i + 1) - offset(i));
        });
        return by_id(comm, step->liquid(), counts);
    };
    for (int index = 4; index < 28; index += 2) {
        Sample sample{make_setup(make_domain(3, {0, 0, 0}, {32 * spacing, 8 * spacing, 8 * spacing}), tight()), {}, {}};
        add_block(sample, {{spacing, 2 * spacing, 2 * spacing}, {30, 4, 4}});
        add_shell(sample, {(index + 0.5) * spacing, 6 * spacing, 3 * spacing}, {1, 2, 2}, 1);
        const auto one = solids_around(Comm::self(), sample);
        double pairs = 0;
        for (const auto& [id, n] : one) pairs += n;
        ASSERT_GT(pairs, 30);
        EXPECT_EQ(solids_around(Comm::world(), sample), one) << "the body at " << index;
    }
}

TEST(IsphStep, ReportsRolesCompressionAndLoadsOfAllRanks) {
    const auto sample = dam_break();
    const auto many = started(Comm::world(), sample), one = started(Comm::self(), sample);
    for (int k = 0; k < 3; ++k) {
        const auto a = many->advance(dt), b = one->advance(dt);
        EXPECT_EQ(a.roles.poisson + a.roles.dirichlet + a.roles.separated, std::int64_t(sample.liquid.size()));
        EXPECT_EQ(a.roles.poisson, b.roles.poisson);
        EXPECT_GT(a.roles.poisson, 0);
        EXPECT_EQ(a.pinned, b.pinned);
        EXPECT_NEAR(a.mean_compression, b.mean_compression, 1e-9);
        EXPECT_NEAR(a.max_compression, b.max_compression, 1e-9);
        ASSERT_EQ(a.loads.size(), 12u);
        // The solver leaves 1e-13 of the source; the loads are those of the whole column, some 10 N.
        for (std::size_t l = 0; l < 12; ++l) EXPECT_NEAR(a.loads[l], b.loads[l], 1e-6 * std::abs(b.loads[2]));
        EXPECT_LT(b.loads[2], 0) << "the floor is pushed down";
        EXPECT_GE(a.imbalance, 1);
        EXPECT_EQ(a.lost_by_cause, (std::array<std::int64_t, loss_causes>{}));
    }
}

TEST(IsphStep, AnUnconvergedSolveEndsTheRunOnEveryRank) {
    auto sample = dam_break();
    sample.setup.options.pressure.max_iterations = 1;
    const auto step = started(Comm::world(), sample);
    int code = 0;
    try {
        for (int k = 0; k < 3; ++k) step->advance(dt);
    } catch (const SimulationError& error) {
        code = static_cast<int>(error.code());
        EXPECT_NE(std::string(error.what()).find("pressure"), std::string::npos);
    }
    EXPECT_EQ(code, 3);
}

TEST(Step, SolidsOutsideTheGridCountForItsNearestCell) {
    const auto boxes = [](double below) {
        auto sample = dam_break();
        for (int k = 0; k < 2000; ++k) {
            const double x = (17 + 0.5 * k / 2000) * spacing;
            sample.solid.push_back({{x, 3.1 * spacing, -below}, 1});
        }
        const auto step = started(Comm::world(), sample);
        EXPECT_EQ(step->comm().sum(std::int64_t(step->solid().store.owned())), std::int64_t(sample.solid.size()));
        std::vector<int> out;
        for (const auto& box : step->decomposition().boxes()) {
            out.insert(out.end(), box.lo, box.lo + 3);
            out.insert(out.end(), box.hi, box.hi + 3);
        }
        return out;
    };
    EXPECT_EQ(boxes(20 * spacing), boxes(0.5 * spacing));
}

} // namespace treacle::sph::step_test
