#include "liquid.hpp"
#include "step_sample.hpp"

#include <gtest/gtest.h>

namespace treacle::grid::rheology_test {
namespace {

constexpr double density = 1000, pull = 1; // [kg/m3], [m/s2] along x
constexpr double half_width = 0.5;         // [m]

flow::ViscosityModel curve_of(scene::ViscosityModelKind law, double viscosity, double exponent) {
    scene::Liquid liquid;
    liquid.viscosity = viscosity;
    liquid.rheology.law = law;
    liquid.rheology.exponent = exponent;
    return flow::make_viscosity_model(liquid);
}

// A channel along x between walls that hold the liquid.
StepSample channel(int cells, const flow::ViscosityModel& curve) {
    auto sample = sample_of(cells, 2);
    auto& domain = sample.setup.domain;
    domain.max = {8.0 / cells, 1, 1};
    domain.gravity = {pull, 0, 0};
    domain.faces[0].kind = domain.faces[1].kind = scene::BoundaryKind::periodic;
    domain.faces[2].slip = domain.faces[3].slip = scene::Slip::no_slip;
    sample.setup.rigid.gravity = domain.gravity;
    sample.setup.rheology = {curve};
    sample.setup.viscosity_varies = true;
    sample.liquid = [](const Vec3&) { return -1.0; };
    return sample;
}

// Largest error of the faces' velocity along the channel, over the largest velocity of the profile.
double profile_error(const Comm& comm, GridStep& step, const std::function<double(double)>& profile) {
    const auto& grid = step.grid();
    const auto u = on_host(step.velocity().axis[0]);
    const CellBox owned = step.halo().owned();
    double error = 0;
    for (int n = 0; n < owned.size(); ++n) {
        int c[3];
        double x[3];
        owned.cell(n, c);
        grid.face(0, c, x);
        if (x[1] < 0 || x[1] > 1) continue;
        const auto i = static_cast<std::size_t>(step.halo().window().index(c[0], c[1], c[2]));
        error = std::max(error, std::fabs(u(i) - profile(std::fabs(x[1] - half_width))));
    }
    return comm.max(error) / profile(0);
}

class Channel : public testing::Test {
protected:
    const Comm comm = Comm::world();
    std::unique_ptr<GridStep> run(const StepSample& sample, double dt, int steps) {
        auto step = started(comm, sample);
        for (int k = 0; k < steps; ++k) step->advance(dt);
        return step;
    }
};

// u = n/(n+1) (rho g/K)^(1/n) (h^(1+1/n) - |y|^(1+1/n)).
TEST_F(Channel, APowerLawLiquidTakesItsProfile) {
    for (const double n : {0.5, 1.5}) {
        const double consistency = 400; // [Pa s^n]
        const auto step = run(channel(20, curve_of(scene::ViscosityModelKind::power_law, consistency, n)), 0.02, 120);
        const auto profile = [&](double y) {
            const double power = 1 + 1 / n;
            return n / (n + 1) * std::pow(density * pull / consistency, 1 / n) *
                   (std::pow(half_width, power) - std::pow(y, power));
        };
        EXPECT_LT(profile_error(comm, *step, profile), 0.02) << n; // seen 0.7 and 0.2 %
    }
}

// A Bingham liquid: a plug where the stress rho g |y| is below the yield stress, a parabola beyond.
TEST_F(Channel, ALiquidWithAYieldStressHasAPlug) {
    auto curve = curve_of(scene::ViscosityModelKind::herschel_bulkley, 400, 1);
    curve.yield_stress = 200;
    curve.regularisation = 1000; // the plug creeps by a thousandth of the largest velocity
    const auto step = run(channel(20, curve), 0.02, 150);
    const double plug = curve.yield_stress / (density * pull);
    const auto profile = [&](double y) {
        const auto squared = [](double x) { return x * x; };
        return density * pull / (2 * curve.viscosity) * (squared(half_width - plug) - squared(std::max(0.0, y - plug)));
    };
    EXPECT_LT(profile_error(comm, *step, profile), 0.03); // seen 1.7 %
}

// Two liquids, the one newtonian, side by side: each has its own stress.
TEST_F(Channel, OfTwoLiquidsEachHasItsOwnViscosity) {
    auto sample = channel(20, curve_of(scene::ViscosityModelKind::power_law, 400, 0.5));
    sample.setup.liquids = 2;
    sample.setup.rheology.push_back(curve_of(scene::ViscosityModelKind::newtonian, 200, 1));
    auto step = started(comm, sample);
    auto& particles = step->particles();
    for (int i = 0; i < particles.store.owned(); ++i) {
        particles.liquid()(i) = particles.position()(i, 1) > 0.5 ? 1 : 0;
        particles.viscosity()(i) = 200;
    }
    for (int k = 0; k < 150; ++k) step->advance(0.02);
    // Stress tau = tau_0 - rho g y: walls at rest, velocities that meet at y = 1/2, by quadrature and bisection for tau_0.
    const auto rate = [&](double y, double tau) {
        return y > 0.5 ? tau / 200 : std::copysign(std::pow(std::fabs(tau) / 400, 2), tau);
    };
    const auto at = [&](double y, double tau_0) {
        double u = 0;
        constexpr int parts = 2000;
        for (int k = 0; k < parts; ++k) {
            const double middle = y * (k + 0.5) / parts;
            u += y / parts * rate(middle, tau_0 - density * pull * middle);
        }
        return u;
    };
    double low = 0, high = 1000;
    for (int k = 0; k < 60; ++k) {
        const double middle = (low + high) / 2;
        (at(1, middle) > 0 ? high : low) = middle;
    }
    const auto u = on_host(step->velocity().axis[0]);
    const CellBox owned = step->halo().owned();
    double error = 0, most = 0;
    for (int n = 0; n < owned.size(); ++n) {
        int c[3];
        double x[3];
        owned.cell(n, c);
        step->grid().face(0, c, x);
        if (x[1] < 0 || x[1] > 1) continue;
        const auto i = static_cast<std::size_t>(step->halo().window().index(c[0], c[1], c[2]));
        const double expected = at(x[1], low);
        most = std::max(most, expected);
        error = std::max(error, std::fabs(u(i) - expected));
    }
    // Between two liquids the viscosity is a mean of theirs; seen 0.5 %.
    EXPECT_LT(comm.max(error), 0.02 * comm.max(most));
}

TEST_F(Channel, IsTheSameOnOneRankAndOnAll) {
    auto sample = sample_of(12, 3);
    sample.setup.options.pressure.residual = sample.setup.options.viscosity.residual = 1e-12;
    for (auto& face : sample.setup.domain.faces) face.slip = scene::Slip::no_slip;
    sample.setup.rheology = {curve_of(scene::ViscosityModelKind::power_law, 30, 0.5)};
    sample.setup.viscosity_varies = true;
    sample.liquid = [](const Vec3& x) { return std::max({x[0] - 0.42, x[2] - 0.55}); };
    auto together = started(comm, sample), alone = started(Comm::self(), sample);
    for (int k = 0; k < 6; ++k) {
        together->advance(0.02);
        alone->advance(0.02);
    }
    const auto all = states(*alone);
    double most = 0;
    for (const auto& [id, state] : states(*together)) {
        for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::fabs(state[k] - all.at(id)[k]));
    }
    // The solves' residuals, and what six steps make of them.
    EXPECT_LT(comm.max(most), 1e-7);
}

// A velocity that is linear in space strains the same everywhere; where it turns as a whole, nothing strains.
TEST_F(Channel, ShearRatesOfLinearVelocitiesAreExact) {
    const Vec3 columns[3] = {{0.3, -1, 0.5}, {0.2, 0.4, 2}, {-0.7, 0.1, -0.7}}; // du_a / dx_k = columns[k][a]
    for (const bool turns : {false, true}) {
        test::Liquid tank(comm, test::make_domain(3, {1, 1, 1}, 0.1));
        Seeding seeding;
        seeding.liquids = {{test::box({0, 0, 0}, {1, 1, 0.6}, 3)}};
        tank.fill(seeding);
        const auto gradient = [&](int a, int k) {
            const auto at = [&](int i, int j) { return columns[j][std::size_t(i)]; };
            return turns ? at(a, k) - at(k, a) : at(a, k);
        };
        const CellBox window = tank.faces.window();
        FaceField u;
        for (int a = 0; a < 3; ++a) {
            u.axis[a] = Array<double>("treacle::velocity", std::size_t(window.size()));
            for (int n = 0; n < window.size(); ++n) {
                int c[3];
                double x[3];
                window.cell(n, c);
                tank.grid.face(a, c, x);
                for (int k = 0; k < 3; ++k) u.axis[a](std::size_t(n)) += gradient(a, k) * x[k];
            }
        }
        FractionBuilder builder;
        Fractions fractions;
        builder.build(tank.solids.nodes(), tank.solids.distance(), tank.surface.distance(), FractionMethod::consistent,
            fractions);
        // As if the liquid slid along all walls: no face is partly theirs.
        Fractions free = fractions;
        free.cell_fluid = Array<double>("treacle::all", std::size_t(window.size()));
        Kokkos::deep_copy(free.cell_fluid, 1.0);
        for (int a = 0; a < 3; ++a) free.face_fluid.axis[a] = free.edge_fluid.axis[a] = free.cell_fluid;
        Rheology rheology({curve_of(scene::ViscosityModelKind::power_law, 1, 0.5)});
        const FaceBodyFractions none;
        const BodyMotion motion;
        rheology.compute_rates({tank.grid, tank.faces, fractions, free, none, motion, {}}, u);
        double square = 0;
        for (int a = 0; a < 3; ++a) {
            for (int k = 0; k < 3; ++k) square += 0.5 * std::pow(gradient(a, k) + gradient(k, a), 2);
        }
        const double expected = std::sqrt(square);
        const auto centre = on_host(rheology.rate());
        int looked_at = 0;
        const CellBox owned = tank.faces.owned();
        for (int n = 0; n < owned.size(); ++n) {
            int c[3];
            owned.cell(n, c);
            const auto i = std::size_t(window.index(c[0], c[1], c[2]));
            if (fractions.cell_liquid_clipped(i) < 0.5) continue;
            ++looked_at;
            EXPECT_NEAR(centre(i), expected, 1e-12);
            for (int e = 0; e < 3; ++e) {
                if (fractions.edge_liquid_clipped.axis[e](i) < 0.5) continue;
                EXPECT_NEAR(rheology.edge_rate().axis[e](i), expected, 1e-12);
            }
        }
        EXPECT_GT(comm.sum(std::int64_t(looked_at)), 300);
    }
}

} // namespace
} // namespace treacle::grid::rheology_test
