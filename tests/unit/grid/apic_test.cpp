#include "grid/mac/extrapolation.hpp"
#include "grid/transport/advection.hpp"
#include "liquid.hpp"

#include <functional>
#include <gtest/gtest.h>

namespace treacle::grid::apic_test {
namespace {

using test::Liquid;
using Field = std::function<Vec3(const Vec3&)>;

class TransferCase : public testing::TestWithParam<int> {
protected:
    int dimensions = GetParam();
    double dx = 1.0 / 16;
    Liquid liquid{Comm::world(), test::make_domain(dimensions, {1, 1, 1}, dx)};

    // A blob in the middle of the domain.
    void fill(Liquid& to, bool two_liquids = false) const {
        Seeding seeding;
        seeding.liquids = {{test::ball({0.47, 0.52, dimensions == 3 ? 0.44 : 0}, 0.26, dimensions)}};
        seeding.viscosities = {2, 50};
        if (two_liquids)
            seeding.liquids.insert(seeding.liquids.begin(), {test::box({0, 0, -1}, {0.5, 1, 1}, dimensions)});
        to.fill(seeding);
    }
    // Velocity and affine matrix of all particles, ghosts too; the same numbers whatever the ranks.
    static void set_affine(const Liquid& to, const Vec3& u0, const std::array<Vec3, 3>& gradient) {
        const auto x = on_host(to.particles.position()), u = on_host(to.particles.velocity());
        for (std::size_t i = 0; i < std::size_t(to.particles.store.total()); ++i) {
            for (std::size_t a = 0; a < 3; ++a) {
                u(i, a) = u0[a];
                for (std::size_t k = 0; k < 3; ++k) u(i, a) += gradient[a][k] * x(i, k);
            }
        }
        Kokkos::deep_copy(to.particles.velocity(), u);
        for (int a = 0; a < 3; ++a) {
            const auto c = on_host(to.particles.affine(a));
            for (std::size_t i = 0; i < std::size_t(to.particles.store.total()); ++i)
                for (std::size_t k = 0; k < 3; ++k) c(i, k) = gradient[std::size_t(a)][k];
            Kokkos::deep_copy(to.particles.affine(a), c);
        }
    }
    // Velocities without any order, by the particles' ids.
    static void set_wild(const Liquid& to) {
        const auto u = on_host(to.particles.velocity());
        const auto id = on_host(to.particles.id());
        const int d = to.grid.dimensions;
        for (std::size_t i = 0; i < std::size_t(to.particles.store.total()); ++i)
            for (int a = 0; a < 3; ++a) u(i, std::size_t(a)) = a < d ? std::sin(double(id(i) % 1000) * (1.7 + a)) : 0;
        Kokkos::deep_copy(to.particles.velocity(), u);
    }
    void gather_particles(Liquid& of) const {
        auto& p = of.particles;
        of.halo.gather(p.store, {p.velocity_field(), p.affine_field(0), p.affine_field(1), p.affine_field(2)});
    }
    // mass, linear momentum, angular momentum about the origin, on the faces.
    std::array<double, 7> grid_momentum(const Liquid& of, const FaceField& mass, const FaceField& u) const {
        std::array<double, 7> out{};
        const CellBox owned = of.faces.owned();
        for (int a = 0; a < dimensions; ++a) {
            const auto m = on_host(mass.axis[a]), v = on_host(u.axis[a]);
            for (int i = 0; i < owned.size(); ++i) {
                int c[3];
                Vec3 x;
                owned.cell(i, c);
                of.grid.face(a, c, x.data());
                const auto at = std::size_t(of.faces.window().index(c[0], c[1], c[2]));
                const double p = m(at) * v(at);
                const auto axis = std::size_t(a), b = (axis + 1) % 3, d = (axis + 2) % 3;
                out[0] += a == 0 ? m(at) : 0;
                out[1 + axis] += p;
                out[4 + b] += x[d] * p;
                out[4 + d] -= x[b] * p;
            }
        }
        for (auto& v : out) v = of.decomposition.comm().sum(v);
        return out;
    }
};

} // namespace

TEST_P(TransferCase, AnAffineFieldGoesToTheFacesAndBackUnchanged) {
    fill(liquid);
    const Vec3 u0{0.3, -0.2, dimensions == 3 ? 0.7 : 0};
    std::array<Vec3, 3> gradient{Vec3{1, -2, 0.5}, Vec3{0.25, 3, -1}, Vec3{2, 1, -4}};
    if (dimensions == 2) gradient = {Vec3{1, -2, 0}, Vec3{0.25, 3, 0}, Vec3{0, 0, 0}};
    set_affine(liquid, u0, gradient);
    FaceField mass, velocity;
    particles_to_faces(
        liquid.grid, {liquid.particles, liquid.cells, liquid.mass}, liquid.faces.window(), mass, velocity);
    for (int a = 0; a < dimensions; ++a) {
        const auto m = on_host(mass.axis[a]), u = on_host(velocity.axis[a]);
        const CellBox owned = liquid.faces.owned();
        for (int i = 0; i < owned.size(); ++i) {
            int c[3];
            Vec3 x;
            owned.cell(i, c);
            liquid.grid.face(a, c, x.data());
            const auto at = std::size_t(liquid.faces.window().index(c[0], c[1], c[2]));
            double due = u0[std::size_t(a)];
            for (std::size_t k = 0; k < 3; ++k) due += gradient[std::size_t(a)][k] * x[k];
            ASSERT_NEAR(u(at), m(at) > 0 ? due : 0, 1e-12); // sums of about a hundred numbers of order one
        }
        liquid.faces.gather({velocity.axis[a]});
    }
    faces_to_particles(liquid.grid, liquid.faces.window(), velocity, liquid.particles);
    const auto x = on_host(liquid.particles.position()), u = on_host(liquid.particles.velocity());
    for (std::size_t i = 0; i < std::size_t(liquid.particles.store.owned()); ++i) {
        for (std::size_t a = 0; a < std::size_t(dimensions); ++a) {
            const auto c = on_host(liquid.particles.affine(int(a)));
            double due = u0[a];
            for (std::size_t k = 0; k < 3; ++k) due += gradient[a][k] * x(i, k);
            ASSERT_NEAR(u(i, a), due, 1e-12);
            for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(c(i, k), gradient[a][k], 1e-12 / dx);
        }
    }
}

TEST_P(TransferCase, BothDirectionsKeepMassAndMomentum) {
    fill(liquid);
    set_wild(liquid);
    FaceField mass, velocity;
    const auto to_faces = [&] {
        particles_to_faces(
            liquid.grid, {liquid.particles, liquid.cells, liquid.mass}, liquid.faces.window(), mass, velocity);
    };
    to_faces();
    const auto before = grid_momentum(liquid, mass, velocity);
    const double count = double(liquid.decomposition.comm().sum(std::int64_t(liquid.particles.store.owned())));
    EXPECT_NEAR(before[0], 1000 * particle_volume(liquid.grid) * count, 1e-12 * before[0]);
    for (int round = 0; round < 3; ++round) {
        for (int a = 0; a < dimensions; ++a) liquid.faces.gather({velocity.axis[a]});
        faces_to_particles(liquid.grid, liquid.faces.window(), velocity, liquid.particles);
        gather_particles(liquid);
        to_faces();
    }
    const auto after = grid_momentum(liquid, mass, velocity);
    // Round-off of sums over the blob's mass times a speed of one and a lever of one.
    for (std::size_t k = 0; k < 7; ++k) EXPECT_NEAR(after[k], before[k], 1e-13 * before[0]) << k;
}

TEST_P(TransferCase, FacesHaveTheNumbersOfOneRank) {
    Liquid one(Comm::self(), test::make_domain(dimensions, {1, 1, 1}, dx));
    fill(liquid);
    fill(one);
    set_wild(liquid);
    set_wild(one);
    FaceField mass, velocity, mass1, velocity1;
    particles_to_faces(
        liquid.grid, {liquid.particles, liquid.cells, liquid.mass}, liquid.faces.window(), mass, velocity);
    particles_to_faces(one.grid, {one.particles, one.cells, one.mass}, one.faces.window(), mass1, velocity1);
    FaceValidity known, known1;
    mark_faces(liquid.grid, liquid.faces.window(), mass, 0, known);
    mark_faces(one.grid, one.faces.window(), mass1, 0, known1);
    extrapolate(liquid.grid, liquid.faces, velocity, known, 4);
    extrapolate(one.grid, one.faces, velocity1, known1, 4);
    const CellBox both = intersect(liquid.faces.window(), liquid.faces.active());
    for (int a = 0; a < dimensions; ++a) {
        const auto u = on_host(velocity.axis[a]), u1 = on_host(velocity1.axis[a]);
        const auto k = on_host(known.axis[a]), k1 = on_host(known1.axis[a]);
        int layers = 0;
        for (int i = 0; i < both.size(); ++i) {
            int c[3];
            both.cell(i, c);
            const auto at = std::size_t(liquid.faces.window().index(c[0], c[1], c[2]));
            const auto at1 = std::size_t(one.faces.window().index(c[0], c[1], c[2]));
            ASSERT_EQ(k(at), k1(at1));
            ASSERT_EQ(u(at), u1(at1)); // the order of the sums is that of the grid
            layers = std::max(layers, k(at));
        }
        EXPECT_EQ(liquid.decomposition.comm().max(std::int64_t(layers)), 5);
    }
}

TEST_P(TransferCase, ViscositiesAreHarmonicMeansOfTheParticlesAround) {
    fill(liquid, true);
    Array<double> centres("treacle::viscosity", 0);
    EdgeField edges;
    harmonic_viscosities(
        liquid.grid, {liquid.particles, liquid.cells, liquid.mass}, liquid.faces.window(), centres, edges);
    const auto eta = on_host(centres), shear = on_host(edges.axis[2]);
    const CellBox owned = liquid.faces.owned();
    std::int64_t pure[2] = {0, 0}, mixed = 0;
    for (int i = 0; i < owned.size(); ++i) {
        int c[3];
        Vec3 x;
        owned.cell(i, c);
        liquid.grid.centre(c, x.data());
        const double here = eta(std::size_t(liquid.faces.window().index(c[0], c[1], c[2])));
        if (here == 0) continue;
        ASSERT_GE(here, 2 * (1 - 1e-14));
        ASSERT_LE(here, 50 * (1 + 1e-14));
        if (x[0] < 0.5 - 1.01 * dx) {
            ASSERT_NEAR(here, 2, 1e-13 * 2);
        }
        if (x[0] > 0.5 + 1.01 * dx) {
            ASSERT_NEAR(here, 50, 1e-13 * 50);
        }
        (here < 2.001 ? pure[0] : here > 49.999 ? pure[1] : mixed) += 1;
        liquid.grid.edge(2, c, x.data());
        const double edge = shear(std::size_t(liquid.faces.window().index(c[0], c[1], c[2])));
        if (edge != 0 && x[0] > 0.5 + 1.01 * dx) {
            ASSERT_NEAR(edge, 50, 1e-13 * 50);
        }
    }
    for (const auto n : {pure[0], pure[1], mixed}) EXPECT_GT(liquid.decomposition.comm().sum(n), 0);
}

// Velocities of the middle of a step lead along the chords of circles: a turn is exact, and the gradient turns with it.
TEST_P(TransferCase, ChordsTurnParticlesAndTheirGradientsExactly) {
    fill(liquid);
    const Vec3 centre{0.5, 0.5, 0};
    const double angle = 0.3, sine = std::sin(angle), versine = 1 - std::cos(angle);
    FaceField velocity;
    const CellBox window = liquid.faces.window();
    for (int a = 0; a < dimensions; ++a) {
        velocity.axis[a] = Array<double>("treacle::velocity", std::size_t(window.size()));
        const auto u = on_host(velocity.axis[a]);
        for (int i = 0; i < window.size(); ++i) {
            int c[3];
            Vec3 x;
            window.cell(i, c);
            liquid.grid.face(a, c, x.data());
            const double rx = x[0] - centre[0], ry = x[1] - centre[1];
            u(std::size_t(i)) = a == 0 ? -versine * rx - sine * ry : a == 1 ? sine * rx - versine * ry : 0;
        }
        Kokkos::deep_copy(velocity.axis[a], u);
    }
    faces_to_particles(liquid.grid, window, velocity, liquid.particles);
    Array3 kept("treacle::kept", liquid.particles.position().extent(0));
    Kokkos::deep_copy(kept, liquid.particles.position());
    const auto departures = advect({FaceSampler(liquid.grid, window, velocity), liquid.solids.sampler(),
                                       make_domain_sides(liquid.grid, liquid.domain), {}, {}},
        liquid.particles, 1);
    EXPECT_EQ(departures.lost + departures.outflow, 0);
    const auto from = on_host(kept), to = on_host(liquid.particles.position());
    const auto gx = on_host(liquid.particles.affine(0)), gy = on_host(liquid.particles.affine(1));
    double worst = 0;
    for (std::size_t i = 0; i < std::size_t(liquid.particles.store.owned()); ++i) {
        const double x = from(i, 0) - 0.5, y = from(i, 1) - 0.5;
        worst = std::max({worst, std::abs(to(i, 0) - 0.5 - (x * std::cos(angle) - y * sine)),
            std::abs(to(i, 1) - 0.5 - (x * sine + y * std::cos(angle))), std::abs(gx(i, 0) - versine),
            std::abs(gx(i, 1) + sine), std::abs(gy(i, 0) - sine), std::abs(gy(i, 1) - versine)});
    }
    EXPECT_LT(worst, 1e-13);
}

TEST_P(TransferCase, WallsPushParticlesBackAndOpenSidesLetThemGo) {
    auto domain = test::make_domain(dimensions, {1, 1, 1}, dx);
    domain.faces[1].kind = scene::BoundaryKind::open;
    domain.faces[1].outflow = true;
    domain.faces[2].kind = domain.faces[3].kind = scene::BoundaryKind::periodic;
    Liquid tank(Comm::world(), domain);
    Seeding seeding;
    seeding.liquids = {{test::box({0, 0, -1}, {1, 1, dimensions == 3 ? 0.2 : 1}, dimensions)}};
    seeding.solid_distance = [&](const Vec3& x) { return tank.solids.distance_at(x, tank.bodies); };
    tank.fill(seeding);
    const auto go = [&](const Vec3& u) {
        const CellBox window = tank.faces.window();
        FaceField velocity;
        for (int a = 0; a < dimensions; ++a) {
            velocity.axis[a] = Array<double>("treacle::velocity", std::size_t(window.size()));
            Kokkos::deep_copy(velocity.axis[a], u[std::size_t(a)]);
        }
        faces_to_particles(tank.grid, window, velocity, tank.particles);
        const auto out = advect({FaceSampler(tank.grid, window, velocity), tank.solids.sampler(),
                                    make_domain_sides(tank.grid, domain), {}, {}},
            tank.particles, dx);
        return std::pair(tank.decomposition.comm().sum(std::int64_t(out.lost)),
            tank.decomposition.comm().sum(std::int64_t(out.outflow)));
    };
    const auto all = tank.decomposition.comm().sum(std::int64_t(tank.particles.store.owned()));
    // Down and to the wall on the left, along the periodic axis: nothing is lost.
    EXPECT_EQ(go({-2, 1.5, -2}), std::pair(std::int64_t(0), std::int64_t(0)));
    const auto x = on_host(tank.particles.position());
    for (std::size_t i = 0; i < std::size_t(tank.particles.store.owned()); ++i) {
        ASSERT_GE(x(i, 0), 0.049 * dx);
        ASSERT_GE(x(i, 1), 0);
        ASSERT_LT(x(i, 1), 1);
        if (dimensions == 3) {
            ASSERT_GE(x(i, 2), 0.049 * dx);
        }
    }
    // To the open side: what is nearer than the way leaves, and is reported with its cause.
    tank.settle();
    const auto before = on_host(tank.particles.position());
    std::int64_t due = 0;
    for (std::size_t i = 0; i < std::size_t(tank.particles.store.owned()); ++i)
        due += before(i, 0) + 2 * dx > 1 ? 1 : 0;
    EXPECT_EQ(go({2, 0, 0}), std::pair(std::int64_t(0), tank.decomposition.comm().sum(due)));
    const auto cause = on_host(tank.particles.cause());
    const auto moved = on_host(tank.particles.position());
    for (std::size_t i = 0; i < std::size_t(tank.particles.store.owned()); ++i)
        EXPECT_EQ(cause(i) == int(LossCause::outflow), moved(i, 0) > 1);
    EXPECT_TRUE(remove_departed(tank.particles).empty()); // what flows out is not lost
    EXPECT_EQ(tank.decomposition.comm().sum(std::int64_t(tank.particles.store.owned()) + due), all);
    // An open side that lets nothing go loses them, but for what an outlet takes.
    tank.settle();
    domain.faces[1].outflow = false;
    due = 0;
    const auto still_there = on_host(tank.particles.position());
    for (std::size_t i = 0; i < std::size_t(tank.particles.store.owned()); ++i)
        due += still_there(i, 0) + 0.5 * dx > 1 ? 1 : 0;
    due = tank.decomposition.comm().sum(due);
    EXPECT_GT(due, 0);
    EXPECT_EQ(go({0.5, 0, 0}), std::pair(due, std::int64_t(0)));
    const auto lost = remove_departed(tank.particles);
    EXPECT_EQ(tank.decomposition.comm().sum(std::int64_t(lost.size())), due);
    for (const auto& particle : lost) EXPECT_EQ(particle.cause, LossCause::open_side);
    // A velocity that is not a number loses the particle, not the run.
    tank.settle();
    const auto left = tank.particles.store.owned();
    if (left > 0) {
        Kokkos::deep_copy(tank.particles.velocity(), 0.0);
        const auto bad = on_host(tank.particles.velocity());
        bad(0, 0) = std::nan("");
        Kokkos::deep_copy(tank.particles.velocity(), bad);
        FaceField still;
        for (int a = 0; a < dimensions; ++a)
            still.axis[a] = Array<double>("treacle::velocity", std::size_t(tank.faces.window().size()));
        const auto out = advect({FaceSampler(tank.grid, tank.faces.window(), still), tank.solids.sampler(),
                                    make_domain_sides(tank.grid, domain), {}, {}},
            tank.particles, dx);
        EXPECT_EQ(out.lost, 1);
        const auto gone = remove_departed(tank.particles);
        ASSERT_EQ(gone.size(), 1u);
        EXPECT_EQ(gone[0].cause, LossCause::non_finite);
        EXPECT_EQ(tank.particles.store.owned(), left - 1);
    }
}

// A ball in the middle: what the border of another rank's part of the domain cuts is no solid at the sides.
TEST_P(TransferCase, BeyondAPeriodicSideParticlesMeetTheSolidsThatAreThere) {
    auto domain = test::make_domain(dimensions, {1, 1, 1}, dx);
    domain.faces[0].kind = domain.faces[1].kind = scene::BoundaryKind::periodic;
    rigid::BodySetup ball;
    ball.centre = {0.5, 0.5, dimensions == 3 ? 0.5 : 0};
    ball.region = {test::ball(ball.centre, 0.4, dimensions)};
    rigid::BodiesSetup bodies;
    bodies.dimensions = dimensions;
    bodies.spacing = dx;
    bodies.bodies = {ball};
    Liquid tank(Comm::world(), domain, bodies);
    Seeding seeding;
    seeding.liquids = {{test::box({0, 0, -1}, {1, 1, 1}, dimensions)}};
    seeding.solid_distance = [&](const Vec3& x) { return tank.solids.distance_at(x, tank.bodies); };
    tank.fill(seeding);
    for (const double speed : {-1.0, 1.0}) {
        Array3 kept("treacle::kept", tank.particles.position().extent(0));
        Kokkos::deep_copy(kept, tank.particles.position());
        FaceField velocity;
        for (int a = 0; a < dimensions; ++a) {
            velocity.axis[a] = Array<double>("treacle::velocity", std::size_t(tank.faces.window().size()));
            Kokkos::deep_copy(velocity.axis[a], a == 0 ? speed : 0.0);
        }
        faces_to_particles(tank.grid, tank.faces.window(), velocity, tank.particles);
        const auto out = advect({FaceSampler(tank.grid, tank.faces.window(), velocity), tank.solids.sampler(),
                                    make_domain_sides(tank.grid, domain), {}, {}},
            tank.particles, dx);
        EXPECT_EQ(out.lost, 0);
        const auto from = on_host(kept), to = on_host(tank.particles.position());
        for (std::size_t i = 0; i < std::size_t(tank.particles.store.owned()); ++i) {
            const double x = from(i, 0) + speed * dx;
            if (x >= 0 && x < 1) continue;
            EXPECT_NEAR(to(i, 0), x - speed, 1e-12);
            for (int k = 1; k < dimensions; ++k) EXPECT_NEAR(to(i, std::size_t(k)), from(i, std::size_t(k)), 1e-12);
        }
        tank.settle();
    }
}

TEST_P(TransferCase, SeedsDoNotDependOnTheRanks) {
    Liquid one(Comm::self(), test::make_domain(dimensions, {1, 1, 1}, dx));
    fill(liquid);
    fill(one);
    EXPECT_EQ(
        liquid.decomposition.comm().sum(std::int64_t(liquid.particles.store.owned())), one.particles.store.owned());
    const auto key = [](const Liquid& of) {
        const auto x = on_host(of.particles.position());
        const auto id = on_host(of.particles.id());
        std::vector<std::array<double, 4>> out;
        for (std::size_t i = 0; i < std::size_t(of.particles.store.owned()); ++i)
            out.push_back({double(id(i)), x(i, 0), x(i, 1), x(i, 2)});
        std::sort(out.begin(), out.end());
        return out;
    };
    const auto mine = key(liquid), all = key(one);
    EXPECT_TRUE(std::includes(all.begin(), all.end(), mine.begin(), mine.end()));
    for (std::size_t i = 0; i + 1 < all.size(); ++i) ASSERT_NE(all[i][0], all[i + 1][0]);
}

INSTANTIATE_TEST_SUITE_P(
    Transfer, TransferCase, testing::Values(2, 3), [](const auto& info) { return std::to_string(info.param) + "D"; });

} // namespace treacle::grid::apic_test
