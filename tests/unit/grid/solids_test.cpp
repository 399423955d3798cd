#include "grid/transport/advection.hpp"
#include "liquid.hpp"

#include <gtest/gtest.h>

namespace treacle::grid::solids_test {
namespace {

using test::ball;
using test::box;

// A resting ball and a box that flies and turns, or what they are in the plane.
rigid::BodiesSetup two_bodies(int dimensions) {
    rigid::BodiesSetup setup;
    setup.dimensions = dimensions;
    setup.spacing = 0.05;
    rigid::BodySetup resting;
    resting.name = "resting";
    resting.region = {ball({0.8, 0.3, dimensions == 3 ? 0.5 : 0}, 0.13, dimensions)};
    resting.centre = {0.8, 0.3, 0.5};
    rigid::BodySetup moving;
    moving.name = "moving";
    moving.kind = scene::BodyKind::kinematic;
    moving.centre = {0.3, 0.5, dimensions == 3 ? 0.5 : 0};
    moving.velocity = {1, 0.5, 0};
    moving.angular_velocity = {0, 0, 2};
    moving.region = {box({0.2, 0.45, dimensions == 3 ? 0.4 : -1}, {0.4, 0.55, dimensions == 3 ? 0.6 : 1}, dimensions)};
    moving.bounding_radius = 0.2;
    setup.bodies = {resting, moving};
    return setup;
}

class SolidCase : public testing::TestWithParam<int> {
protected:
    int dimensions = GetParam();
    double dx = 0.05;
    scene::Domain domain = test::make_domain(dimensions, {1, 1, 1}, dx);

    void SetUp() override { domain.faces[0].kind = domain.faces[1].kind = scene::BoundaryKind::periodic; }
    static CellBox block(const MacGrid& grid, int first, int last) {
        CellBox out = grid.cells.all();
        out.lo[1] = first;
        out.hi[1] = last;
        return out;
    }
    // Every node of the window that lies in the grid: exact near surfaces, of the right sign everywhere.
    void check(const Solids& solids, const MacGrid& grid, const rigid::RigidBodies& bodies) const {
        const auto distance = on_host(solids.distance());
        const auto number = on_host(solids.number());
        const FineNodes nodes = solids.nodes();
        const CellBox inside = intersect(nodes.window, grid.cells.all());
        for (int i = 0; i < inside.size(); ++i) {
            int c[3];
            inside.cell(i, c);
            for (int corner = 0; corner < nodes.used(); ++corner) {
                Vec3 x;
                nodes.position(c, corner, x.data());
                if (x[1] < 0 || x[1] > 1 || x[2] < 0 || x[2] > 1) continue; // beyond walls it is another distance
                const double due = solids.distance_at(x, bodies);
                const auto at = std::size_t(8 * nodes.window.index(c[0], c[1], c[2]) + corner);
                if (due < solids.band() && due > -solids.band()) {
                    ASSERT_NEAR(distance(at), due, 1e-14) << x[0] << " " << x[1] << " " << x[2];
                    ASSERT_NE(number(at), Solids::nothing);
                } else {
                    ASSERT_EQ(distance(at) < 0, due < 0);
                    ASSERT_GE(std::fabs(distance(at)), solids.band() * (1 - 1e-12));
                }
            }
        }
    }
};

} // namespace

TEST_P(SolidCase, DistancesFollowTheBodiesAndTheWindow) {
    const auto grid = make_mac_grid(domain);
    const Decomposition decomposition(Comm::world(), grid.cells);
    rigid::RigidBodies bodies(two_bodies(dimensions));
    Solids solids(grid, domain);
    CellHalo halo;
    // Up, where the body flies, and back: the windows overlap in part, and once not at all. It leaves through the
    // periodic side and comes in at the other.
    const int lasts[] = {12, 14, 14, 20, 24, 9, 24, 24, 18};
    for (const int last : lasts) {
        halo.connect(decomposition, block(grid, last - 9, last), 3);
        solids.update(halo, bodies);
        check(solids, grid, bodies);
        bodies.begin(0.3);
        bodies.move(0.3);
        solids.update(halo, bodies);
        check(solids, grid, bodies);
    }
}

TEST_P(SolidCase, VelocitiesAreThoseOfTheBodyThere) {
    const auto grid = make_mac_grid(domain);
    const Decomposition decomposition(Comm::self(), grid.cells);
    rigid::RigidBodies bodies(two_bodies(dimensions));
    bodies.begin(0.1);
    Solids solids(grid, domain);
    CellHalo halo;
    halo.connect(decomposition, grid.cells.all(), 3);
    solids.update(halo, bodies);
    const auto motion = solids.motion();
    const Array<double> found("treacle::found", 9);
    Kokkos::parallel_for(
        "velocities", 3, KOKKOS_LAMBDA(int k) {
            const double x[3] = {0.3, 0.6, 0.5};
            motion.velocity(k == 0 ? Solids::side(2) : k - 1, x, &found(3 * k));
        });
    const auto u = on_host(found);
    // Within a step along the chord of the body's turn, by 0.2 about a centre 0.1 below.
    const double due[9] = {0, 0, 0, 0, 0, 0, 1 - std::sin(0.2), 0.5 - (1 - std::cos(0.2)), 0};
    for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(u(k), due[k], 1e-12);
}

TEST_P(SolidCase, PlacesInSolidsArePushedToTheirSurface) {
    const auto grid = make_mac_grid(domain);
    const Decomposition decomposition(Comm::self(), grid.cells);
    rigid::RigidBodies bodies(two_bodies(dimensions));
    Solids solids(grid, domain);
    CellHalo halo;
    halo.connect(decomposition, grid.cells.all(), 3);
    solids.update(halo, bodies);
    const auto sampler = solids.sampler();
    const double z = dimensions == 3 ? 0.5 : 0;
    for (const Vec3& start : {Vec3{0.72, 0.28, z}, Vec3{0.21, 0.48, z}, Vec3{0.5, -0.06, z}}) {
        const Array<double> point("treacle::point", 3);
        const double x0 = start[0], x1 = start[1], x2 = start[2], clearance = 0.05 * dx;
        Kokkos::parallel_for(
            "push", 1, KOKKOS_LAMBDA(int) {
                double x[3] = {x0, x1, x2};
                push_out(sampler, clearance, x);
                for (int k = 0; k < 3; ++k) point(k) = x[k];
            });
        const auto x = on_host(point);
        // The clearance, to the error of linear interpolation on a curved surface.
        EXPECT_NEAR(solids.distance_at({x(0), x(1), x(2)}, bodies), clearance, 0.05 * dx);
    }
}

// Within two boxes that overlap the interpolated distance has a ridge, where it is flat.
TEST_P(SolidCase, PlacesWhereSolidsOverlapAreNotThrownFar) {
    const auto grid = make_mac_grid(domain);
    const Decomposition decomposition(Comm::self(), grid.cells);
    auto setup = two_bodies(dimensions);
    const double low = dimensions == 3 ? 0.3 : -1, high = dimensions == 3 ? 0.7 : 1;
    setup.bodies[0].region = {box({0.25, 0.35, low}, {0.55, 0.65, high}, dimensions)};
    setup.bodies[1].region = {box({0.45, 0.35, low}, {0.75, 0.65, high}, dimensions)};
    setup.bodies[1].kind = scene::BodyKind::fixed;
    rigid::RigidBodies bodies(setup);
    Solids solids(grid, domain);
    CellHalo halo;
    halo.connect(decomposition, grid.cells.all(), 3);
    solids.update(halo, bodies);
    const auto sampler = solids.sampler();
    const double z = dimensions == 3 ? 0.5 : 0, clearance = 0.05 * dx;
    double farthest = 0;
    Kokkos::parallel_reduce(
        "push", 41,
        KOKKOS_LAMBDA(int n, double& most) {
            double x[3] = {0.46 + 0.002 * n, 0.501, z};
            const double start[3] = {x[0], x[1], x[2]};
            push_out(sampler, clearance, x);
            double square = 0;
            for (int k = 0; k < 3; ++k) square += (x[k] - start[k]) * (x[k] - start[k]);
            most = math::max(most, math::sqrt(square));
        },
        Kokkos::Max<double>(farthest));
    // Four goes, each of at most the depth, 0.15 m, over the least slope.
    EXPECT_LT(farthest, 4 * (0.15 + clearance) / least_slope);
    EXPECT_GT(farthest, 0);
}

INSTANTIATE_TEST_SUITE_P(
    Solids, SolidCase, testing::Values(2, 3), [](const auto& info) { return std::to_string(info.param) + "D"; });

} // namespace treacle::grid::solids_test
