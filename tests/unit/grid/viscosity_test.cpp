#include "viscous_sample.hpp"

namespace treacle::grid::viscosity_test {
namespace {

class SolverEnvironment : public testing::Environment {
    void SetUp() override { runtime_ = std::make_unique<solve::SolveRuntime>(); }
    void TearDown() override { runtime_.reset(); }
    std::unique_ptr<solve::SolveRuntime> runtime_;
};
[[maybe_unused]] const auto* const environment = testing::AddGlobalTestEnvironment(new SolverEnvironment);

// Of size 1 about the middle.
double from_middle(const Vec3& x) { return std::hypot(x[0] - 0.52, x[1] - 0.47, x[2] - 0.49); }
ViscousDistance ball(double radius) {
    return [=](const Vec3& x) { return from_middle(x) - radius; };
}
double spin(int a, const Vec3& x) {
    const Vec3 w{0.3, -0.7, 1.1};
    const auto b = static_cast<std::size_t>(a + 1) % 3, c = static_cast<std::size_t>(a + 2) % 3;
    return w[b] * x[c] - w[c] * x[b] + 0.2 * a;
}

class GridViscosity : public ::testing::Test {
protected:
    const Comm comm = Comm::world();
};

TEST_F(GridViscosity, matrix_is_symmetric_to_the_bit) {
    ViscousSample sample;
    sample.liquid = [](const Vec3& x) { return x[1] - 0.6; };
    sample.solid = [](const Vec3& x) { return 0.9 * x[1] + 0.4 * x[0] - 0.35; };
    sample.viscosity = [](const Vec3& x) { return 1 + 100 * x[0]; };
    sample.walls = true;
    ViscousCase run(comm, sample);
    run.set_noise();
    run.solve(0.01);
    const auto& a = run.viscosity.matrix()->blocks();
    const auto value = [&](int i, int j) {
        for (int k = a.diagonal_offsets[i]; k < a.diagonal_offsets[i + 1]; ++k) {
            if (a.diagonal_columns[k] == j) return a.diagonal_values[k];
        }
        return 0.0;
    };
    for (int i = 0; i < a.rows; ++i) {
        for (int k = a.diagonal_offsets[i]; k < a.diagonal_offsets[i + 1]; ++k) {
            ASSERT_EQ(a.diagonal_values[k], value(a.diagonal_columns[k], i)) << i << " " << a.diagonal_columns[k];
        }
    }
}

TEST_F(GridViscosity, free_liquid_in_rigid_rotation_stays_as_it_is) {
    for (const double viscosity : {1.0, 1e6}) {
        ViscousSample sample;
        sample.liquid = ball(0.3);
        sample.viscosity = [=](const Vec3& x) { return viscosity * (1 + x[0]); };
        // Round-off of the terms of a row, which the viscous ones exceed those of inertia by.
        const double stiffness = 24 * 2 * viscosity / 1000 * 0.01 * 16 * 16;
        sample.options.residual = 1e-13 + 1e-15 * stiffness;
        ViscousCase run(comm, sample);
        run.set_velocity(spin);
        const auto report = run.solve(0.01);
        EXPECT_EQ(report.solve.iterations, 0);
        EXPECT_LE(report.solve.relative_residual, sample.options.residual);
    }
}

TEST_F(GridViscosity, step_keeps_linear_and_angular_momentum) {
    for (const double viscosity : {10.0, 1e5}) {
        ViscousSample sample;
        sample.liquid = ball(0.27);
        sample.viscosity = [=](const Vec3& x) { return viscosity * (1 + 5 * x[1]); };
        sample.options.residual = 1e-13;
        ViscousCase run(comm, sample);
        run.set_noise();
        const auto before = run.liquid_momentum();
        run.solve(0.01);
        const auto after = run.liquid_momentum();
        const double size = 1000 * 4.2 * std::pow(0.27, 3); // of the mass, at about 1 m/s
        for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(after[k], before[k], 1e-10 * size) << k;
    }
}

// A channel along x between walls at `low` and `low` + height.
ViscousSample channel(int cells, double low, double height) {
    ViscousSample sample;
    sample.cells = cells;
    sample.dimensions = 2;
    sample.periodic = {true, false, false};
    sample.solid = [=](const Vec3& x) { return std::min(x[1] - low, low + height - x[1]); };
    sample.viscosity = [](const Vec3&) { return 1000.0; };
    sample.options.residual = 1e-12;
    return sample;
}

TEST_F(GridViscosity, couette_start_up_decays_by_nu_pi2_over_h2) {
    const double height = 0.7, dt = 1e-3;
    for (const double low : {0.125, 0.125 + 0.3 / 40, 0.125 + 0.6 / 40, 0.125 + 0.9 / 40}) {
        ViscousCase run(comm, channel(40, low, height));
        const auto mode = [&](const Vec3& x) { return std::sin(std::numbers::pi * (x[1] - low) / height); };
        run.set_velocity([&](int a, const Vec3& x) { return a == 0 ? mode(x) : 0.0; });
        const auto amplitude = [&] {
            return run.sum([&](int a, std::size_t at, const Vec3& x) {
                return a == 0 && x[1] > low + 0.05 && x[1] < low + height - 0.05 ? run.velocity.axis[a](at) * mode(x)
                                                                                 : 0.0;
            });
        };
        const double before = amplitude();
        run.solve(dt);
        const double rate = (before / amplitude() - 1) / dt, expected = std::pow(std::numbers::pi / height, 2);
        EXPECT_NEAR(rate, expected, 0.01 * expected) << low;
    }
}

TEST_F(GridViscosity, poiseuille_flow_is_right_with_walls_anywhere) {
    const double height = 0.7;
    for (const double low : {0.125, 0.125 + 0.3 / 40, 0.125 + 0.6 / 40, 0.125 + 0.9 / 40}) {
        ViscousCase run(comm, channel(40, low, height));
        const double dt = 1e5; // no inertia is left
        run.set_velocity([&](int a, const Vec3&) { return a == 0 ? dt : 0.0; });
        run.solve(dt);
        const double most = run.most([&](int a, std::size_t at, const Vec3&) {
            return a == 0 && run.fractions.face_liquid_clipped.axis[a](at) > 0 ? run.velocity.axis[a](at) : 0.0;
        });
        EXPECT_NEAR(most, height * height / 8, 0.01 * height * height / 8) << low;
    }
}

// Of channels along (2, 1), which repeat with the period of the square.
double rotated_error(const Comm& comm, int cells, double shift, double half = 0.16) { // of the width [m]
    const double root = std::sqrt(5.0);
    const auto across = [=](const Vec3& x) {
        const double s = (2 * x[1] - x[0]) - shift;
        return (s - std::floor(s) - 0.5) / root;
    };
    ViscousSample sample;
    sample.cells = cells;
    sample.dimensions = 2;
    sample.periodic = {true, true, false};
    sample.solid = [=](const Vec3& x) { return half - std::fabs(across(x)); };
    sample.viscosity = [](const Vec3&) { return 1000.0; };
    ViscousCase run(comm, sample);
    const double dt = 1e5;
    const auto along = [=](int a) { return (a == 0 ? 2 : 1) / root; };
    run.set_velocity([&](int a, const Vec3&) { return dt * along(a); });
    run.solve(dt);
    const double sum = run.sum([&](int a, std::size_t at, const Vec3& x) {
        const double wet = run.fractions.face_liquid_clipped.axis[a](at);
        if (!(wet > 0)) return 0.0;
        const double y = across(x), exact = along(a) * std::max(0.0, half * half - y * y) / 2;
        return wet * std::fabs(run.velocity.axis[a](at) - exact);
    });
    return sum / (cells * cells) / (half * half / 2);
}

TEST_F(GridViscosity, rotated_poiseuille_flow_converges_with_order_one_and_a_half) {
    // The mean of several places of the walls within the cells.
    const auto error = [&](int cells) {
        double sum = 0;
        for (int k = 0; k < 8; ++k) sum += rotated_error(comm, cells, 0.17 + 0.019 * k) / 8;
        return sum;
    };
    const double coarse = error(16), middle = error(32), fine = error(64);
    EXPECT_GT(std::log2(coarse / fine) / 2, 1.5) << coarse << " " << middle << " " << fine;
}

// Between such channels walls of 1.1 to 1.9 cells. With walls of less than 1.3 cells along the axes four and a half times as
// much flowed at half of their places, since each side took the other along.
TEST_F(GridViscosity, thin_walls_hold_liquid_on_both_sides) {
    for (const double thickness : {1.05, 1.2, 1.5, 1.9}) {
        const double half = 0.5 * (1 / std::sqrt(5.0) - thickness / 32);
        for (int k = 0; k < 8; ++k) EXPECT_LT(rotated_error(comm, 32, 0.17 + 0.019 * k, half), 0.03) << thickness << k;
    }
}

TEST_F(GridViscosity, converges_across_a_jump_of_1e8) {
    ViscousSample sample;
    sample.cells = 24;
    sample.walls = true;
    sample.liquid = [](const Vec3& x) { return std::min(x[1] - 0.4, from_middle(x) - 0.3); };
    sample.viscosity = [](const Vec3& x) { return x[0] < 0.5 ? 1.0 : 1e8; };
    ViscousCase run(comm, sample);
    run.set_noise();
    const auto report = run.solve(0.01);
    EXPECT_LT(report.solve.iterations, 60); // 25 where the viscosity is the same everywhere
}

TEST_F(GridViscosity, free_slip_leaves_flow_along_a_tilted_wall_alone) {
    ViscousSample sample;
    sample.dimensions = 2;
    sample.periodic = {true, false, false};
    sample.solid = [](const Vec3& x) { // a saw of one tooth, away from the liquid, and a tilted floor beneath it
        return 0.8 * (x[1] - 0.3) + 0.6 * (x[0] - 0.5);
    };
    sample.liquid = [](const Vec3& x) { return std::hypot(x[0] - 0.5, x[1] - 0.35) - 0.25; };
    sample.solid_slips = true;
    sample.viscosity = [](const Vec3&) { return 1e4; };
    sample.options.residual = 1e-12;
    ViscousCase run(comm, sample);
    const auto along = [](int a) { return a == 0 ? 0.8 : -0.6; };
    run.set_velocity([&](int a, const Vec3&) { return along(a); });
    run.solve(0.1);
    const double change = run.most([&](int a, std::size_t at, const Vec3&) {
        return run.fractions.face_liquid_clipped.axis[a](at) > 1e-6 ? std::fabs(run.velocity.axis[a](at) - along(a))
                                                                    : 0.0;
    });
    EXPECT_LT(change, 1e-10); // of 1 m/s: the solve's
}

TEST_F(GridViscosity, navier_slip_moves_the_wall_by_the_slip_length) {
    const double height = 0.7, slip = 0.1;
    for (const double low : {0.125, 0.125 + 0.3 / 40, 0.125 + 0.6 / 40, 0.125 + 0.9 / 40}) {
        auto sample = channel(40, low, height);
        sample.solid_slips = true;
        sample.slip_length = slip;
        ViscousCase run(comm, sample);
        const double dt = 1e5;
        run.set_velocity([&](int a, const Vec3&) { return a == 0 ? dt : 0.0; });
        run.solve(dt);
        const double most = run.most([&](int a, std::size_t at, const Vec3&) {
            return a == 0 && run.fractions.face_liquid_clipped.axis[a](at) > 0 ? run.velocity.axis[a](at) : 0.0;
        });
        const double expected = height * height / 8 + height * slip / 2;
        EXPECT_NEAR(most, expected, 0.01 * expected) << low;
    }
}

// Largest speed after a second of liquid thrown at 1 m/s along y, of the faces across `first_axis` and above with more liquid than a fraction.
double left_of_a_throw(const Comm& comm, const ViscousSample& sample, double fraction, int first_axis) {
    ViscousCase run(comm, sample);
    run.set_velocity([&](int a, const Vec3&) { return a == 1 ? 1.0 : 0.0; });
    run.solve(1.0);
    return run.most([&](int a, std::size_t at, const Vec3&) {
        const bool counts = a >= first_axis && run.fractions.face_liquid_clipped.axis[a](at) > fraction;
        return counts ? std::fabs(run.velocity.axis[a](at)) : 0.0;
    });
}

TEST_F(GridViscosity, slip_walls_hold_liquid_off) {
    // Liquid between slip walls is thrown at them: what is left is much slower than the walls would let through.
    for (const double low : {0.125, 0.125 + 0.3 / 40, 0.125 + 0.6 / 40, 0.125 + 0.9 / 40}) {
        auto sample = channel(40, low, 0.7);
        sample.solid_slips = true;
        sample.viscosity = [](const Vec3&) { return 1e5; };
        EXPECT_LT(left_of_a_throw(comm, sample, 0.01, 1), 1e-2)
            << low; // about h^2 / (8 nu dt) = 6e-4, more at the walls' own cells
    }
}

TEST_F(GridViscosity, round_slip_walls_hold_liquid_off) {
    // A cavity whose surface is oblique to the faces nearly everywhere. Without pressures nothing else holds the liquid.
    for (const double centre : {0.5, 0.5 + 0.3 / 32}) {
        ViscousSample sample;
        sample.cells = 32;
        sample.dimensions = 2;
        sample.solid = [=](const Vec3& x) { return 0.35 - std::hypot(x[0] - centre, x[1] - centre); };
        sample.solid_slips = true;
        sample.viscosity = [](const Vec3&) { return 1e5; };
        EXPECT_LT(left_of_a_throw(comm, sample, 0.5, 0), 0.05) << centre;
    }
}

} // namespace
} // namespace treacle::grid::viscosity_test
