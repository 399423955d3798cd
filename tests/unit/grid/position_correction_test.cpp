#include "grid/volume/position_correction.hpp"
#include "liquid.hpp"

#include <gtest/gtest.h>

namespace treacle::grid::position_correction_test {
namespace {

using test::Liquid;

// A cube of 16 particles an edge on a lattice, closer than at rest by `compression` in volume and shifted at random by up to
// `jitter` spacings.
void fill_block(Liquid& liquid, double compression, double jitter) {
    Seeding seeding;
    const double low = 0.25, high = 0.75; // 8 cells of 1/16
    const int dimensions = liquid.grid.dimensions;
    seeding.liquids = {
        {test::box({low, low, dimensions == 3 ? low : -1}, {high, high, dimensions == 3 ? high : 1}, dimensions)}};
    seeding.jitter = 2 * jitter;
    liquid.fill(seeding);
    const double scale = std::pow(1 - compression, 1.0 / dimensions);
    const auto x = on_host(liquid.particles.position());
    for (std::size_t i = 0; i < std::size_t(liquid.particles.store.owned()); ++i) {
        for (std::size_t k = 0; k < std::size_t(dimensions); ++k) x(i, k) = 0.5 + scale * (x(i, k) - 0.5);
    }
    Kokkos::deep_copy(liquid.particles.position(), x);
    liquid.settle();
}

struct Corrected {
    PositionReport report;
    std::array<double, 3> moment{}; // sum of m dx [kg m]
};
Corrected correct(Liquid& liquid, const PositionOptions& options, double gravity = 0) {
    Array3 before("treacle::before", liquid.particles.position().extent(0));
    Kokkos::deep_copy(before, liquid.particles.position());
    PositionCorrection correction(liquid.grid);
    Corrected out;
    out.report = correction.apply(options, liquid.particles,
        {liquid.cells, liquid.halo, liquid.decomposition.comm(), liquid.solids, liquid.mass, {0, -gravity, 0}});
    const auto from = on_host(before), to = on_host(liquid.particles.position());
    const double mass = 1000 * particle_volume(liquid.grid);
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < std::size_t(liquid.particles.store.owned()); ++i)
            out.moment[k] += mass * (to(i, k) - from(i, k));
        out.moment[k] = liquid.decomposition.comm().sum(out.moment[k]);
    }
    return out;
}

class CorrectionCase : public testing::TestWithParam<int> {
protected:
    int dimensions = GetParam();
    double dx = 1.0 / 16;
    scene::Domain domain = test::make_domain(dimensions, {1, 1, 1}, dx);
    Liquid liquid{Comm::world(), domain};
};

} // namespace

TEST_P(CorrectionCase, ALatticeStaysWhereItIs) {
    fill_block(liquid, 0, 0);
    const auto out = correct(liquid, {});
    EXPECT_NEAR(out.report.density_before, 0, 1e-12); // round-off of the sum over the neighbours
    EXPECT_EQ(out.report.largest_move, 0);
    EXPECT_EQ(out.report.iterations, 0);
}

TEST_P(CorrectionCase, ACompressedBlockIsSpreadInAFewIterationsAndItsCentreStays) {
    fill_block(liquid, 0.07, 0.1);
    PositionOptions options;
    options.cap = 1; // none here: a cap holds back one of a pair
    const auto out = correct(liquid, options, 10);
    EXPECT_GT(out.report.density_before, 0.1);
    EXPECT_LT(out.report.density_after, 0.1);
    EXPECT_LE(out.report.iterations, 6);
    RecordProperty("iterations_" + std::to_string(dimensions) + "D", out.report.iterations);
    for (const double m : out.moment) EXPECT_NEAR(m, 0, 1e-13); // round-off: thousands of moves of 1e-4 kg m
    EXPECT_NEAR(out.report.energy, 10 * out.moment[1], 1e-12);
}

TEST_P(CorrectionCase, OwnConstraintsAloneAreSlower) {
    int iterations[2];
    for (const int both : {0, 1}) {
        Liquid block(Comm::world(), domain);
        fill_block(block, 0.07, 0.1);
        PositionOptions options;
        options.iterations = 30;
        options.neighbour_constraints = both == 1;
        iterations[both] = correct(block, options).report.iterations;
    }
    if (dimensions == 3) {
        EXPECT_GE(iterations[0], 2 * iterations[1]); // 13 and 6
    }
    EXPECT_GE(iterations[0], iterations[1]);
}

TEST_P(CorrectionCase, NoParticleMovesFartherThanTheCap) {
    fill_block(liquid, 0.15, 0.1);
    PositionOptions options;
    options.cap = 0.05;
    const auto out = correct(liquid, options);
    EXPECT_LE(out.report.largest_move, 0.05 * dx * (1 + 1e-12));
    EXPECT_GT(out.report.largest_move, 0.049 * dx);
    EXPECT_LT(out.report.density_after, out.report.density_before);
}

TEST_P(CorrectionCase, AHeavierLiquidMovesLessAndTheCentreOfMassStays) {
    fill_block(liquid, 0.07, 0.1);
    const auto which = on_host(liquid.particles.liquid());
    const auto id = on_host(liquid.particles.id());
    for (std::size_t i = 0; i < std::size_t(liquid.particles.store.total()); ++i) which(i) = id(i) % 2 == 0 ? 0 : 1;
    Kokkos::deep_copy(liquid.particles.liquid(), which);
    const auto mass = on_host(liquid.mass);
    mass(1) = 5 * mass(0);
    Kokkos::deep_copy(liquid.mass, mass);
    Array3 before("treacle::before", liquid.particles.position().extent(0));
    Kokkos::deep_copy(before, liquid.particles.position());
    PositionOptions options;
    options.cap = 1;
    const auto out = correct(liquid, options);
    EXPECT_LT(out.report.density_after, 0.1);
    const auto from = on_host(before), to = on_host(liquid.particles.position());
    double moment[3] = {0, 0, 0}, way[2] = {0, 0};
    for (std::size_t i = 0; i < std::size_t(liquid.particles.store.owned()); ++i) {
        double square = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            moment[k] += mass(std::size_t(which(i))) * (to(i, k) - from(i, k));
            square += (to(i, k) - from(i, k)) * (to(i, k) - from(i, k));
        }
        way[which(i)] += std::sqrt(square);
    }
    const auto& comm = liquid.decomposition.comm();
    for (const double m : moment) EXPECT_NEAR(comm.sum(m), 0, 1e-12); // as above, five times the mass
    EXPECT_GT(comm.sum(way[0]), 2 * comm.sum(way[1]));
}

TEST_P(CorrectionCase, APoolInATankKeepsItsVolumeAndItsPotentialEnergy) {
    Seeding seeding;
    Vec3 top{2, 2, 2};
    top[std::size_t(dimensions - 1)] = 0.5;
    seeding.liquids = {{test::box({-1, -1, -1}, top, dimensions)}};
    seeding.solid_distance = [&](const Vec3& x) { return liquid.solids.distance_at(x, liquid.bodies); };
    liquid.fill(seeding);
    FractionBuilder builder;
    Fractions fractions;
    const auto volume = [&] {
        builder.build(liquid.solids.nodes(), liquid.solids.distance(), liquid.surface.distance(),
            FractionMethod::consistent, fractions);
        return liquid.sum(fractions.cell_liquid_clipped);
    };
    PositionOptions options;
    options.tolerance = 0.05;
    double energy = 0, before = 0;
    for (int frame = 0; frame < 20; ++frame) {
        energy += correct(liquid, options, 10).report.energy;
        liquid.settle();
        // The seeds lie at random, for which the level set has less liquid: from where they have been spread.
        if (frame == 4) before = volume();
    }
    // Half a per cent of the volume, and as much of the energy of raising the pool by its height.
    EXPECT_NEAR(volume() / before, 1, 0.005);
    RecordProperty("volume_" + std::to_string(dimensions) + "D", std::to_string(volume() / before));
    const double count = double(liquid.decomposition.comm().sum(std::int64_t(liquid.particles.store.owned())));
    EXPECT_NEAR(energy, 0, 0.005 * 10 * 0.5 * 1000 * particle_volume(liquid.grid) * count);
}

TEST_P(CorrectionCase, ItIsTheSameOnAnyRanks) {
    Liquid one(Comm::self(), domain);
    fill_block(liquid, 0.07, 0.1);
    fill_block(one, 0.07, 0.1);
    for (const auto method : {PositionMethod::density, PositionMethod::distance}) {
        PositionOptions options;
        options.method = method;
        const auto many = correct(liquid, options), alone = correct(one, options);
        EXPECT_EQ(many.report.iterations, alone.report.iterations);
        EXPECT_NEAR(many.report.density_after, alone.report.density_after, 1e-12); // order of the neighbours of ghosts
        EXPECT_NEAR(many.report.largest_move, alone.report.largest_move, 1e-14);
        liquid.settle();
        one.settle();
    }
}

INSTANTIATE_TEST_SUITE_P(Correction, CorrectionCase, testing::Values(2, 3),
    [](const auto& info) { return std::to_string(info.param) + "D"; });

} // namespace treacle::grid::position_correction_test
