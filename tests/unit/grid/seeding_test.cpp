#include "liquid.hpp"

#include "base/median.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>

namespace treacle::grid {
namespace {
using test::ball;
using test::box;

// Particles of liquids in a domain, times their volume [m3, in the plane m2 times dx], by liquid.
std::vector<double> volumes(const scene::Domain& domain, const std::vector<scene::Regions>& liquids,
    std::function<double(const Vec3&)> solids = {}) {
    const MacGrid grid = make_mac_grid(domain);
    const Decomposition decomposition(Comm::self(), grid.cells);
    GridParticles particles;
    Seeding seeding;
    seeding.liquids = liquids;
    seeding.solid_distance = solids;
    seed(seeding, grid, decomposition, particles);
    std::vector<double> out(liquids.size(), 0.0);
    const auto liquid = on_host(particles.liquid());
    const auto x = on_host(particles.position());
    for (int i = 0; i < particles.store.owned(); ++i) {
        const auto row = static_cast<std::size_t>(i), which = static_cast<std::size_t>(liquid(row));
        double nearest = 1;
        for (const auto& region : liquids[which])
            nearest = std::min(nearest, region.distance({x(row, 0), x(row, 1), x(row, 2)}));
        EXPECT_LT(nearest, 0) << "a particle lies out of its liquid";
        if (solids) {
            EXPECT_GE(solids({x(row, 0), x(row, 1), x(row, 2)}), seeding.clearance * grid.dx * (1 - 1e-9));
        }
        out[which] += particle_volume(grid);
    }
    return out;
}

TEST(Seeding, ABlockHasItsVolumeAtAnySpacing) {
    for (int k = 0; k < 30; ++k) {
        const double dx = 0.0035 + 0.00012 * k;
        const Vec3 min{0, 0, 0}, max{0.06, 0.04, 0.05};
        const double volume = volumes(test::make_domain(3, {0.09, 0.06, 0.08}, dx), {{box(min, max, 3)}})[0];
        EXPECT_NEAR(volume / (0.06 * 0.04 * 0.05), 1, 0.003) << dx;
        const double area = volumes(test::make_domain(2, {0.09, 0.06, 0}, dx), {{box(min, max, 2)}})[0] / dx;
        EXPECT_NEAR(area / (0.06 * 0.04), 1, 0.75 * dx * dx / (0.06 * 0.04)) << dx; // three particles
    }
}

// Holes in the outer layer of parts of cells do not leave a face rough: depths of the outermost particles of columns, and of those
// after them, by the width of a part.
TEST(Seeding, FlatFacesAreSmoothAtAnySpacing) {
    for (int k = 0; k < 12; ++k) {
        const double dx = 0.0035 + 0.00012 * k, top = 0.05, width = 0.5 * dx;
        const MacGrid grid = make_mac_grid(test::make_domain(3, {0.09, 0.06, 0.08}, dx));
        GridParticles particles;
        Seeding seeding;
        seeding.liquids = {{box({0, 0, 0}, {0.06, 0.04, top}, 3)}};
        seed(seeding, grid, Decomposition(Comm::self(), grid.cells), particles);
        const auto x = on_host(particles.position());
        const auto id = on_host(particles.id());
        std::map<std::array<int, 2>, std::vector<double>> columns;
        for (int i = 0; i < particles.store.owned(); ++i) {
            const auto row = static_cast<std::size_t>(i);
            const int part = int(id(row) % 8), cell = int(id(row) / 8), line = cell / grid.cells.count[0];
            const std::array column{
                2 * (cell % grid.cells.count[0]) + part % 2, 2 * (line % grid.cells.count[1]) + part / 2 % 2};
            const bool full = grid.lower[0] + (column[0] + 1) * width < 0.06 + 1e-9 &&
                              grid.lower[1] + (column[1] + 1) * width < 0.04 + 1e-9;
            if (full) columns[column].push_back((top - x(row, 2)) / width);
        }
        for (auto& [column, depths] : columns) {
            std::ranges::sort(depths);
            EXPECT_LT(depths[0], 0.9) << dx; // 1.7 where a hole is not spread
            EXPECT_GT(depths[1], 0.8) << dx;
        }
    }
}

// As far as a round wall is seen from its side: the outermost particle of each layer, by the width of a part, the median of all layers.
TEST(Seeding, RoundFacesAreSmoothAtAnySpacing) {
    for (int k = 0; k < 12; ++k) {
        const double dx = 0.0035 + 0.00021 * k, radius = 0.03, width = 0.5 * dx;
        const MacGrid grid = make_mac_grid(test::make_domain(3, {0.08, 0.08, 0.06}, dx));
        scene::Shape cylinder;
        cylinder.kind = scene::ShapeKind::cylinder;
        cylinder.centre = {0.04, 0.04, 0.025};
        cylinder.axis = {0, 0, 1};
        cylinder.radius = radius;
        cylinder.height = 0.05;
        GridParticles particles;
        Seeding seeding;
        seeding.liquids = {{scene::SolidRegion(cylinder)}};
        seed(seeding, grid, Decomposition(Comm::self(), grid.cells), particles);
        const auto x = on_host(particles.position());
        std::map<int, double> farthest;
        for (int i = 0; i < particles.store.owned(); ++i) {
            const auto row = static_cast<std::size_t>(i);
            auto& most = farthest[int(x(row, 2) / width)];
            most = std::max(most, x(row, 0) - 0.04);
        }
        std::vector<double> depths;
        for (const auto& [layer, most] : farthest) depths.push_back((radius - most) / width);
        EXPECT_NEAR(upper_median(depths), 0.4, 0.08) << dx; // 0.13 to 0.33 where holes are not spread
    }
}

TEST(Seeding, ABallHasItsVolumeWhereverItIs) {
    constexpr double radius = 0.03, dx = 0.0067, exact = 4 * 3.14159265358979 / 3 * radius * radius * radius;
    for (int k = 0; k < 20; ++k) {
        const Vec3 centre{0.05 + 0.1 * dx * k, 0.05 - 0.07 * dx * k, 0.05 + 0.03 * dx * k};
        EXPECT_NEAR(
            volumes(test::make_domain(3, {0.12, 0.1, 0.1}, dx), {{ball(centre, radius, 3)}})[0] / exact, 1, 0.015)
            << k;
    }
}

TEST(Seeding, ThinSheetsHaveTheirVolume) {
    constexpr double dx = 0.01;
    for (const double thickness : {0.25 * dx, 0.3 * dx, 0.6 * dx}) {
        for (const double offset : {0.0, 0.11 * dx, 0.37 * dx, 0.48 * dx}) {
            const double bottom = 5 * dx + offset;
            const double volume = volumes(test::make_domain(3, {0.4, 0.4, 0.1}, dx),
                {{box({0, 0, bottom}, {0.4, 0.4, bottom + thickness}, 3)}})[0];
            EXPECT_NEAR(volume / (0.16 * thickness), 1, 0.02) << thickness / dx << " at " << offset / dx;
        }
    }
}

// The faces coincide, and lie anywhere in the cells.
TEST(Seeding, LiquidsOnEachOtherAndOnSolidsShareTheSpace) {
    constexpr double dx = 0.01;
    for (int k = 0; k < 10; ++k) {
        const double floor = 0.02 + 0.1 * dx * k, between = floor + 0.031, top = between + 0.027;
        const auto found = volumes(test::make_domain(3, {0.2, 0.2, 0.1}, dx),
            {{box({0, 0, floor}, {0.2, 0.2, between}, 3)}, {box({0, 0, floor}, {0.2, 0.2, top}, 3)}},
            [&](const Vec3& x) { return x[2] - floor; });
        EXPECT_NEAR(found[0] / (0.04 * 0.031), 1, 0.005) << k;
        EXPECT_NEAR(found[1] / (0.04 * 0.027), 1, 0.005) << k;
    }
}

// Along x the domain is open on both sides, along y it has a wall first.
TEST(Cells, BeginAtAWallAndAsFarBeyondOneOpenSideAsBeyondTheOther) {
    for (int k = 0; k < 30; ++k) {
        const double dx = 0.0035 + 0.00012 * k;
        auto domain = test::make_domain(3, {0.09, 0.06, 0.08}, dx);
        domain.faces[0].kind = domain.faces[1].kind = domain.faces[3].kind = scene::BoundaryKind::open;
        const MacGrid grid = make_mac_grid(domain);
        const auto begin = [&](int axis) { return grid.lower[axis] + MacGrid::padding * dx; };
        const auto end = [&](int axis) { return grid.lower[axis] + (grid.cells.count[axis] - MacGrid::padding) * dx; };
        EXPECT_NEAR(begin(0) + end(0), 0.09, 1e-12) << dx;
        EXPECT_GE(end(0), 0.09 - 1e-6 * dx) << dx;
        EXPECT_LT(end(0) - begin(0), 0.09 + dx) << dx;
        EXPECT_NEAR(begin(1), 0, 1e-12) << dx;
        EXPECT_GE(end(1), 0.06 - 1e-6 * dx) << dx;
    }
}

} // namespace
} // namespace treacle::grid
