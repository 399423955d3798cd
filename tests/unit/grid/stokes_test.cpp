#include "../sph/solver_environment.hpp"
#include "stokes_sample.hpp"

namespace treacle::grid {
namespace {

[[maybe_unused]] const auto* const solvers = testing::AddGlobalTestEnvironment(new sph::SolverEnvironment);

class GridStokes : public ::testing::Test {
protected:
    const Comm comm = Comm::world();

    // A ball of liquid that one body partly sticks out of, and one inside of it.
    StokesSample two_bodies(double viscosity) const {
        StokesSample sample;
        sample.cells = 16;
        sample.liquid = ball({0.5, 0.5, 0.5}, 0.32);
        sample.body = {ball({0.7, 0.55, 0.5}, 0.14), ball({0.4, 0.45, 0.47}, 0.12)};
        auto first = make_body({0.7, 0.55, 0.5}, 30, 0.14), second = make_body({0.4, 0.45, 0.47}, 4, 0.12);
        first.velocity = {1, 0, 0.5};
        second.angular_velocity = {0, 3, -2};
        sample.bodies.bodies = {first, second};
        sample.viscosity = [=](const Vec3&) { return viscosity; };
        return sample;
    }
};

TEST_F(GridStokes, liquid_at_rest_over_a_tilted_floor_stays_at_rest) {
    for (const int dimensions : {2, 3}) {
        for (const double viscosity : {1.0, 1e5}) {
            StokesSample sample;
            sample.dimensions = dimensions;
            sample.walls = true;
            const auto up = static_cast<std::size_t>(dimensions - 1);
            sample.solid = [=](const Vec3& x) { return (x[up] - 0.2 - 0.37 * x[0]) / std::hypot(1, 0.37); };
            sample.liquid = [=](const Vec3& x) { return x[up] - 0.813; };
            sample.gravity[up] = -9.81;
            sample.viscosity = [=](const Vec3&) { return viscosity; };
            StokesCase run(comm, sample);
            const double dt = 0.01;
            run.set_velocity([](int, const Vec3&) { return 0.0; });
            const auto report = run.step(dt);
            EXPECT_TRUE(report.solve.converged()) << report.solve.reason;
            EXPECT_LT(run.max_speed(), 1e-8 * 9.81 * dt)
                << dimensions << " " << viscosity; // the solves' residuals, some cells deep
        }
    }
}

TEST_F(GridStokes, momentum_of_liquid_and_bodies_is_kept_and_nothing_flows_out_of_cells) {
    for (const auto& [viscosity, slips] : {std::pair{10.0, false}, {1e5, false}, {1e3, true}}) {
        auto sample = two_bodies(viscosity);
        sample.solid_slips = slips;
        sample.slip_length = 0.1;
        const double dt = 0.01;
        StokesCase run(comm, sample);
        run.set_noise();
        run.build(dt);
        const auto before = run.momentum(dt);
        const auto report = run.solve_together(dt);
        EXPECT_TRUE(report.solve.converged()) << report.solve.reason;
        const auto after = run.momentum(dt);
        double size = 0;
        for (std::size_t k = 0; k < 3; ++k) size = std::max(size, std::fabs(before[k]));
        // Where liquid slides, fluxes and forces are not at the faces' middles, nor all of them in the middle of the open parts.
        const double turns = slips ? 1e-5 : 1e-9;
        for (std::size_t k = 0; k < 6; ++k)
            EXPECT_NEAR(after[k], before[k], (k < 3 ? 1e-9 : turns) * size) << viscosity << " " << k;
        if (!slips) {
            EXPECT_LT(run.max_flux(), 1e-8) << viscosity; // of 1 m/s
        }
    }
}

TEST_F(GridStokes, is_the_projection_where_there_is_hardly_any_viscosity) {
    auto sample = two_bodies(1e-9);
    sample.body.clear(); // they would take the liquid along that they hold
    sample.bodies.bodies.clear();
    sample.solid = [](const Vec3& x) { return x[2] - 0.3 - 0.2 * x[0]; };
    StokesCase run(comm, sample);
    run.set_noise();
    run.build(0.01);
    run.project(0.01);
    FaceField projected;
    copy_faces(run.grid, run.halo.window(), run.velocity, projected);
    EXPECT_TRUE(run.solve_together(0.01).solve.converged());
    // Of faces that both solves are about: open and beside liquid.
    const auto& faces = run.pressure.system().faces();
    const double most = run.most([&](int a, std::size_t at, const Vec3&) {
        const auto below = at - static_cast<std::size_t>(faces.stride[a]);
        if (!(faces.open(a, at) > 0) || (!faces.is_liquid(at) && !faces.is_liquid(below))) return 0.0;
        return std::fabs(run.velocity.axis[a](at) - projected.axis[a](at));
    });
    EXPECT_LT(most, 1e-6); // of 1 m/s; what the viscosity does
}

TEST_F(GridStokes, is_the_same_on_one_rank_and_on_all) {
    auto sample = two_bodies(100);
    sample.gravity = {0, 0, -9.81};
    sample.bodies.gravity = sample.gravity;
    StokesCase all(comm, sample), alone(Comm::self(), sample);
    const auto found = [&](StokesCase& run) {
        run.set_noise();
        run.step(0.05);
        const auto momentum = run.momentum(0.05);
        std::vector<double> out(momentum.begin(), momentum.end());
        for (std::size_t b = 0; b < 2; ++b) {
            for (std::size_t k = 0; k < 3; ++k)
                out.insert(out.end(), {run.bodies.velocity(b)[k], run.bodies.spin(b)[k]});
        }
        out.push_back(run.max_speed());
        return out;
    };
    const auto one = found(all), other = found(alone);
    for (std::size_t k = 0; k < one.size(); ++k) EXPECT_NEAR(one[k], other[k], 1e-8 * (1 + std::fabs(other[k]))) << k;
}

// A box without air, its lower half a hundred million times as viscous as the upper one, with a ball across the border.
TEST_F(GridStokes, converges_in_a_full_box_with_a_jump_of_viscosity) {
    StokesSample sample;
    sample.walls = true;
    sample.viscosity = [](const Vec3& x) { return x[2] < 0.5 ? 1e6 : 1e-2; };
    sample.body = {ball({0.5, 0.45, 0.5}, 0.2)};
    auto body = make_body({0.5, 0.45, 0.5}, 100, 0.2);
    body.angular_velocity = {0, 0, 5};
    sample.bodies.bodies = {body};
    sample.gravity = {0, 0, -9.81};
    sample.bodies.gravity = sample.gravity;
    sample.stokes.residual = 1e-8;
    StokesCase run(comm, sample);
    run.set_noise();
    const auto report = run.step(0.01);
    EXPECT_TRUE(report.solve.converged()) << report.solve.reason << " " << report.solve.relative_residual;
    EXPECT_LT(report.solve.iterations, 200);
}

// A ball over a pool between walls that slip: nothing holds the pool to its floor but the pressure.
TEST_F(GridStokes, takes_as_many_iterations_for_stiff_liquid_as_for_thin) {
    int most = 0, least = 1000;
    for (const double stiffness : {1.0, 1e3, 1e6}) { // nu dt/dx^2
        StokesSample sample;
        sample.cells = 20;
        sample.walls = sample.solid_slips = true;
        sample.liquid = [](const Vec3& x) { return std::min(x[2] - 0.17, ball({0.5, 0.55, 0.5}, 0.25)(x)); };
        const double dt = 0.01, viscosity = stiffness * sample.density / (dt * sample.cells * sample.cells);
        sample.viscosity = [=](const Vec3&) { return viscosity; };
        sample.gravity = {0, 0, -9.81};
        sample.stokes.residual = 1e-8;
        StokesCase run(comm, sample);
        run.set_velocity([](int, const Vec3&) { return 0.0; });
        const auto report = run.step(dt);
        EXPECT_TRUE(report.solve.converged()) << report.solve.reason << " " << stiffness;
        most = std::max(most, report.solve.iterations);
        least = std::min(least, report.solve.iterations);
    }
    // 16 to 22 on 1 to 3 ranks, with a margin for other roundings.
    EXPECT_LE(most, 30);
    EXPECT_LE(most, 1.6 * least);
}

// A column of liquid that hangs from the ceiling and has come to creep, 8 cells wide: a plane sheet stretches by the
// extensional viscosity 4 eta, so that its tip sinks by rho g H^2/(8 eta). One after the other, pressure and viscosity
// let it go twice as fast.
TEST_F(GridStokes, a_hanging_sheet_stretches_by_its_extensional_viscosity) {
    StokesSample sample;
    sample.dimensions = 2;
    sample.cells = 64;
    const double half_width = 4.0 / 64, length = 0.85, ceiling = 0.95;
    sample.solid = [=](const Vec3& x) { return ceiling - x[1]; };
    sample.liquid = [=](const Vec3& x) {
        return std::max(std::fabs(x[0] - 0.5) - half_width, ceiling - length - x[1]);
    };
    sample.gravity = {0, -9.81, 0};
    sample.viscosity = [](const Vec3&) { return 1e4; };
    sample.stokes.residual = 1e-10;
    const double expected = 1000 * 9.81 * length * length / (8 * 1e4), dt = 100;
    const auto tip = [&](bool together) {
        StokesCase run(comm, sample);
        run.set_velocity([](int, const Vec3&) { return 0.0; });
        if (together) {
            EXPECT_TRUE(run.step(dt).solve.converged());
        } else {
            run.split_step(dt);
        }
        return run.most([&](int a, std::size_t at, const Vec3& x) {
            return a == 1 && std::fabs(x[0] - 0.5) < half_width && std::fabs(x[1] - (ceiling - length)) < 0.6 / 64
                       ? -run.velocity.axis[a](at)
                       : 0.0;
        });
    };
    EXPECT_NEAR(tip(true) / expected, 1, 0.04); // the ceiling holds the sheet's upper end together
    EXPECT_GT(tip(false) / expected, 1.7);
}

} // namespace
} // namespace treacle::grid
