#include "parts.hpp"

namespace treacle::sph::solids_test {
namespace {

constexpr double dt = 1e-3; // [s]

Sample space(const SphOptions& options = {}) {
    return {make_setup(make_domain(3, {-1, -1, -1}, {1, 1, 1}), options), {}, {}};
}

void add_plane(Sample& sample, double z, int half) {
    for (int j = -half; j <= half; ++j) {
        for (int i = -half; i <= half; ++i) sample.solid.push_back({{i * spacing, j * spacing, z}, 0});
    }
}

// Liquid on its lattice above a wall, all at one pressure; what the pressure force gives the particle in the middle of
// the first layer [m/s].
double push_of_wall(double wall_pressure_factor) {
    constexpr int half = 4;
    auto sample = space();
    const auto& c = sample.setup.constants;
    const double gap = equilibrium_wall_distance({KernelKind::cubic_spline, 3, c.support, spacing, spacing}, {});
    sample.setup.constants.wall_pressure_factor = wall_pressure_factor;
    for (int k = 0; k < half; ++k) {
        for (int j = -half; j <= half; ++j) {
            for (int i = -half; i <= half; ++i) {
                sample.liquid.push_back({{i * spacing, j * spacing, k * spacing}, {0, 0, 0}, 1000});
            }
        }
    }
    add_plane(sample, -gap, half);
    Parts parts(Comm::self(), sample);
    parts.predict_roles(LastPressures::known, dt);
    parts.push(dt);
    constexpr int middle = half * (2 * half + 1) + half;
    return all_states(parts.comm, parts.liquid).at(id_of(middle)).u[2];
}

double length(double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); }

} // namespace

// Two particles of which one touches a solid (dissertation, section 2.4.5), in the signs of chapter 3:
// p_i = (a (c_i + c_j) + b_j c_i) / (a (b_i + b_j) + b_i b_j).
TEST(SolidTerms, TwoParticlesOnASolidHaveTheirClosedFormPressures) {
    for (const auto term : {SolidTerm::decomposed, SolidTerm::unified}) {
        SphOptions options;
        options.pressure.solid_term = term;
        auto sample = space(options);
        const double h = sample.setup.constants.support;
        sample.liquid.push_back({{0, 0, 0}, {0, 0, -300}});
        sample.liquid.push_back({{0.2 * spacing, 0, 0.9 * spacing}, {0, 0, -900}});
        sample.solid.push_back({{0, 0.1 * spacing, -0.8 * spacing}, 0});
        Parts parts(Comm::self(), sample);
        ASSERT_EQ(parts.predict_roles(LastPressures::known, dt).poisson, 2);
        ASSERT_EQ(parts.anchor(), 0);
        parts.assemble();
        const auto system = gather_system(parts);

        const auto& c = parts.setup.constants;
        const auto rho = by_id(parts.comm, parts.liquid, parts.liquid.density());
        const auto i = id_of(0), j = id_of(1);
        const CubicSpline<3> kernel(h);
        const double r = length(0.2 * spacing, 0, 0.9 * spacing), rs = length(0, 0.1 * spacing, 0.8 * spacing);
        const double rs_j = length(0.2 * spacing, 0.1 * spacing, 1.7 * spacing);
        const double vs = 1 / kernel.value(0.0); // alone in its layer
        const double vi = c.mass / rho.at(i), vj = c.mass / rho.at(j);
        const double a = -(vi + vj) * r * r * kernel.gradient(r) / (r * r + 0.01 * h * h);
        // Eq. 2.10 and Eq. 3.2 from their definitions; the solid is within reach of both particles.
        const Vec3 pair{0.2 * spacing, 0, 0.9 * spacing}; // from i to j
        const auto wall_term = [&](const Vec3& from_solid, double distance, double side, double density) {
            const double s = vs * kernel.gradient(distance), f = side * 0.5 * (vi + vj) * kernel.gradient(r);
            const double square = s * s * distance * distance;
            const double product =
                s * f * (pair[0] * from_solid[0] + pair[1] * from_solid[1] + pair[2] * from_solid[2]);
            if (term == SolidTerm::decomposed) return std::max(0.0, square + product);
            return c.rest_density * c.rest_density / (density * density) * square;
        };
        const double bi = wall_term({0, -0.1 * spacing, 0.8 * spacing}, rs, -1, rho.at(i));
        const double bj = wall_term({0.2 * spacing, -0.1 * spacing, 1.7 * spacing}, rs_j, 1, rho.at(j));
        const auto source = by_id(parts.comm, parts.liquid, parts.liquid.source());
        const double ci = source.at(i), cj = source.at(j);
        const double below = a * (bi + bj) + bi * bj;

        const Eigen::VectorXd p = system.matrix.ldlt().solve(system.right_hand_side);
        const double scale = p.cwiseAbs().maxCoeff();
        const auto row = [&](std::int64_t id) {
            return std::lower_bound(system.ids.begin(), system.ids.end(), id) - system.ids.begin();
        };
        // Positions are rounded to the domain's quantum: 1e-15 of a spacing, times the condition of 2 by 2.
        EXPECT_NEAR(p(row(i)), (a * (ci + cj) + bj * ci) / below, 1e-11 * scale);
        EXPECT_NEAR(p(row(j)), (a * (ci + cj) + bi * cj) / below, 1e-11 * scale);
        EXPECT_NEAR(system.matrix(row(i), row(i)), a + bi, 1e-12 * (a + bi));
    }
}

TEST(SolidTerms, ASeparatedParticleIsKickedToTheRestDensityExactly) {
    for (const auto term : {SolidTerm::unified, SolidTerm::amplified, SolidTerm::exact}) {
        SphOptions options;
        options.pressure.solid_term = term;
        auto sample = space(options);
        sample.liquid.push_back({{0.1 * spacing, -0.2 * spacing, 0.7 * spacing}, {3, 2, -60}});
        add_plane(sample, 0, 4);
        Parts parts(Comm::self(), sample);
        const auto roles = parts.predict_roles(LastPressures::known, dt);
        ASSERT_EQ(roles.separated, 1);
        const double before = test::on_host(parts.liquid.source())(0) * dt * dt / rest_density;
        ASSERT_GT(before, 0.05) << "it is predicted to be compressed";
        EXPECT_EQ(parts.anchor(), 0) << "it is no unknown";
        parts.assemble();
        EXPECT_EQ(parts.system.rows(), 0);
        parts.system.store_pressure(parts.liquid);
        EXPECT_GT(test::on_host(parts.liquid.pressure())(0), 0);
        parts.push(dt);
        parts.predict_roles(LastPressures::known, dt);
        EXPECT_NEAR(test::on_host(parts.liquid.source())(0) * dt * dt / rest_density, 0, 1e-12);
    }
}

TEST(SolidTerms, AParticleWithoutNeighboursIsAtZeroPressure) {
    auto sample = space();
    sample.liquid.push_back({{0, 0, 0}, {0, 0, -5}, 77.0});
    Parts parts(Comm::self(), sample);
    EXPECT_EQ(parts.predict_roles(LastPressures::known, dt).dirichlet, 1);
    parts.assemble();
    parts.system.store_pressure(parts.liquid);
    EXPECT_EQ(test::on_host(parts.liquid.pressure())(0), 0);
}

// Eqs. 2.1-2.3 by the loops over particles against the sums over lattices.
TEST(Densities, OfALatticeBesideAWallAreThoseOfTheWallMeasurement) {
    for (const auto kind : {DensityKind::smooth, DensityKind::spiky, DensityKind::blended}) {
        SphOptions options;
        options.kernel = KernelKind::mueller;
        options.support_ratio = 2;
        options.density.kind = kind;
        auto sample = space(options);
        const WallSetup wall{options.kernel, 3, 2 * spacing * (1 - 1e-10), spacing, spacing};
        sample.setup.constants.support *= 1 - 1e-10; // neighbours at exactly two spacings have no weight
        const double gap = equilibrium_wall_distance(wall, options.density);
        add_block(sample, {{-3 * spacing, -3 * spacing, gap}, {7, 7, 4}});
        add_plane(sample, 0, 6);
        Parts parts(Comm::self(), sample);
        const auto blended = by_id(parts.comm, parts.liquid, parts.liquid.blended_density());
        // The middle of the first layer and of the second; 1e-8 from the support and positions like i *
        // spacing.
        EXPECT_NEAR(blended.at(id_of(3 + 7 * 3)) / rest_density, 1, 1e-8) << "at its rest gap";
        const auto density = by_id(parts.comm, parts.liquid, parts.liquid.density());
        EXPECT_NEAR(density.at(id_of(3 + 7 * 3 + 49)) / rest_density, 1, gap > spacing ? 1e-8 : 1);
    }
}

TEST(Densities, OfASquareLatticeAtAWallAreTheGoldenNumbers) {
    SphOptions options;
    options.kernel = KernelKind::mueller;
    options.support_ratio = 2 * (1 - 1e-10);
    const double golden[][2] = {{1.0, 1.1536}, {1.1, 1.0705}, {1.2, .9957}, {1.3, .9318}}; // gap, rho / rho0
    for (const auto& [gap, ratio] : golden) {
        Sample sample{make_setup(make_domain(2, {-1, -1, 0}, {1, 1, 0}), options), {}, {}};
        add_block(sample, {{-3 * spacing, gap * spacing, 0}, {7, 4, 1}});
        for (int i = -7; i <= 7; ++i) sample.solid.push_back({{i * spacing, 0, 0}, 0});
        const Parts parts(Comm::self(), sample);
        const auto density = by_id(parts.comm, parts.liquid, parts.liquid.density());
        EXPECT_NEAR(density.at(id_of(3)) / rest_density, ratio, 0.51e-4) << "gap " << gap;
    }
}

TEST(Densities, OfAFullLatticeAreTheRestDensity) {
    for (const auto kernel : {KernelKind::cubic_spline, KernelKind::wendland_c2, KernelKind::mueller}) {
        for (const auto kind : {DensityKind::smooth, DensityKind::spiky}) {
            SphOptions options;
            options.kernel = kernel;
            options.density.kind = kind;
            auto sample = space(options);
            add_block(sample, {{0, 0, 0}, {7, 7, 7}});
            const Parts parts(Comm::self(), sample);
            const auto rho = by_id(parts.comm, parts.liquid, parts.liquid.blended_density());
            EXPECT_NEAR(rho.at(id_of(3 + 7 * 3 + 49 * 3)), rest_density, 1e-9 * rest_density);
            EXPECT_LT(rho.at(id_of(0)), 0.6 * rest_density) << "a corner has an eighth of the neighbours";
        }
    }
}

TEST(SolidVolumes, OfAPlaneAreThoseOfTheWallMeasurement) {
    auto sample = space();
    add_plane(sample, 0.2, 5);
    sample.solid.push_back({{0, 0, -0.7}, 1}); // and one alone: the inverse of W(0)
    const Parts parts(Comm::self(), sample);
    const auto volume = test::on_host(parts.solid.volume());
    const auto id = test::on_host(parts.solid.id());
    const double h = parts.setup.constants.support;
    const double plane = compute_wall_sums({KernelKind::cubic_spline, 3, h, spacing, spacing}, spacing).wall_volume;
    int seen = 0;
    for (int i = 0; i < parts.solid.store.owned(); ++i) {
        if (id(i) == id_of(5 + 11 * 5)) {
            EXPECT_NEAR(volume(i), plane, 1e-12 * plane);
            ++seen;
        }
        if (id(i) == id_of(121)) {
            EXPECT_NEAR(volume(i), 1 / CubicSpline<3>(h).value(0.0), 1e-12 * plane);
            ++seen;
        }
    }
    EXPECT_EQ(seen, 2);
}

TEST(WallForce, BalancedKeepsTheFirstLayerOfALatticeAtRestAndOneSidedDoesNot) {
    const auto defaults = make_setup(make_domain(3, {-1, -1, -1}, {1, 1, 1}), {}).constants;
    const double balanced = wall_pressure_factor({KernelKind::cubic_spline, 3, defaults.support, spacing, spacing}, {});
    EXPECT_NEAR(balanced, 1.588, 1e-3); // summed by hand over the two lattices at 2.5 d
    const double sinking = push_of_wall(1);
    EXPECT_LT(sinking, 0);
    // Densities of the layers differ by half a per cent from the lattice's, and so do their p / rho^2.
    EXPECT_LT(std::abs(push_of_wall(balanced)), 0.05 * std::abs(sinking));
}

} // namespace treacle::sph::solids_test
