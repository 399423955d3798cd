#include "../sph/solver_environment.hpp"
#include "step_sample.hpp"
#include "stokes_exact.hpp"
#include "stokes_sample.hpp"

// Flows with known answers, by pressure and viscosity together and, for comparison, one after the other.
namespace treacle::grid {
namespace {

[[maybe_unused]] const auto* const solvers = testing::AddGlobalTestEnvironment(new sph::SolverEnvironment);

// Speed at which a column that hangs from the ceiling and creeps stretches, of its lower end against a place two widths below the
// ceiling, which holds its upper end together: over rho g L^2 / (2 T), T the extensional viscosity, 4 eta of a sheet and 3 eta of a
// column.
double stretching(int dimensions, int cells, int width, bool together) {
    StokesSample sample;
    sample.dimensions = dimensions;
    sample.cells = cells;
    const auto up = static_cast<std::size_t>(dimensions - 1);
    const double dx = 1.0 / cells, half = 0.5 * width * dx, ceiling = 0.95, tip = 0.1,
                 beginning = std::floor((ceiling - 4 * half) / dx) * dx;
    sample.solid = [=](const Vec3& x) { return ceiling - x[up]; };
    sample.liquid = [=](const Vec3& x) {
        return std::max(
            {std::fabs(x[0] - 0.5) - half, dimensions == 3 ? std::fabs(x[1] - 0.5) - half : -1, tip - x[up]});
    };
    sample.gravity[up] = -9.81;
    sample.viscosity = [](const Vec3&) { return 1e4; };
    sample.stokes.residual = 1e-9;
    StokesCase run(Comm::world(), sample);
    run.set_velocity([](int, const Vec3&) { return 0.0; });
    const double dt = 100, end = std::ceil(tip / dx) * dx + dx;
    if (together) {
        EXPECT_TRUE(run.step(dt).solve.converged());
    } else {
        run.split_step(dt);
    }
    const auto mean = [&](double level) {
        double sums[2];
        for (const int k : {0, 1}) {
            sums[k] = run.sum([&](int a, std::size_t at, const Vec3& x) {
                const bool inside = std::fabs(x[0] - 0.5) < half && (dimensions == 2 || std::fabs(x[1] - 0.5) < half);
                return a == dimensions - 1 && inside && std::fabs(x[up] - level) < 0.1 * dx
                           ? (k == 0 ? 1 : -run.velocity.axis[a](at))
                           : 0.0;
            });
        }
        return sums[1] / sums[0];
    };
    const double from = beginning - tip, to = end - tip;
    return (mean(end) - mean(beginning)) /
           (1000 * 9.81 * (from * from - to * to) / (2 * (dimensions == 2 ? 4e4 : 3e4)));
}

TEST(StokesFlows, AHangingColumnStretchesByItsExtensionalViscosity) {
    for (const auto& [dimensions, cells, width] : {std::array{2, 64, 8}, {2, 32, 4}, {3, 32, 4}}) {
        const std::string name = std::to_string(dimensions) + "D " + std::to_string(width) + " cells wide ";
        const double one = stretching(dimensions, cells, width, true),
                     other = stretching(dimensions, cells, width, false);
        testing::Test::RecordProperty(name + "together", std::to_string(one));
        testing::Test::RecordProperty(name + "split", std::to_string(other));
        EXPECT_NEAR(one, 1, 0.03) << name;
        EXPECT_NEAR(other, dimensions == 2 ? 2.0 : 1.5, 0.05) << name; // what that is not for
    }
}

// A viscous layer with a wave on it sinks back at (rho g / 2 eta k)(sinh 2q - 2q)/(1 + 2 q^2 + cosh 2q), q = k H (Orchard 1962).
TEST(StokesFlows, AViscousLayerLevels) {
    const double k = 2 * math::pi, floor = 0.1, eta = 1e4, amplitude = 0.005;
    for (const double height : {0.12, 0.25, 0.5}) {
        StokesSample sample;
        sample.dimensions = 2;
        sample.cells = 64;
        sample.periodic = {true, false, false};
        sample.solid = [=](const Vec3& x) { return x[1] - floor; };
        sample.liquid = [=](const Vec3& x) { return x[1] - floor - height - amplitude * std::cos(k * x[0]); };
        sample.gravity[1] = -9.81;
        sample.viscosity = [=](const Vec3&) { return eta; };
        sample.stokes.residual = 1e-10;
        StokesCase run(Comm::world(), sample);
        run.set_velocity([](int, const Vec3&) { return 0.0; });
        EXPECT_TRUE(run.step(100).solve.converged());
        // a' = -k times the volume that flows across x = 1/4.
        const double rate = k / amplitude / 64 * run.sum([&](int a, std::size_t at, const Vec3& x) {
            return a == 0 && std::fabs(x[0] - 0.25) < 1e-6
                       ? run.velocity.axis[0](at) * run.fractions.face_liquid_clipped.axis[0](at)
                       : 0.0;
        });
        const double q = k * height;
        const double expected =
            1000 * 9.81 / (2 * eta * k) * (std::sinh(2 * q) - 2 * q) / (1 + 2 * q * q + std::cosh(2 * q));
        testing::Test::RecordProperty(
            "rate over Orchard's at q = " + std::to_string(q), std::to_string(rate / expected));
        EXPECT_NEAR(rate / expected, 1, 0.1) << height;
    }
}

// s of a wave exp(s t) of a viscous liquid: (s + 2 nu k^2)^2 + w^2 = 4 nu^2 k^4 sqrt(1 + s/(nu k^2)) (Lamb 1932, 349), with the w of
// its depth. The often quoted -2 nu k^2 is its limit; at this viscosity the rate is 0.86 of that.
std::complex<double> damped_wave(double omega, double nu, double k) {
    const double a = nu * k * k;
    const auto f = [=](std::complex<double> s) {
        return (s + 2 * a) * (s + 2 * a) + omega * omega - 4 * a * a * std::sqrt(1.0 + s / a);
    };
    std::complex<double> s(-2 * a, omega);
    for (int i = 0; i < 50; ++i) s -= f(s) / ((f(s + 1e-6) - f(s - 1e-6)) / 2e-6);
    return s;
}

// The middle of the liquid in a basin of free-slip walls swings by the damped cosine of a half wave, steepness 0.1.
TEST(StokesFlows, AStandingWaveSwingsAndDiesDown) {
    const double k = math::pi, height = 0.6, viscosity = 20;
    const auto exact = damped_wave(std::sqrt(9.81 * k * std::tanh(k * height)), viscosity / 1000, k);
    const double omega = exact.imag(), gamma = -exact.real();
    for (const auto solve : {StokesSolve::together, StokesSolve::split}) {
        auto sample = sample_of(48, 2);
        sample.jitter = 0;
        sample.setup.viscosity = viscosity;
        sample.setup.options.stokes.solve = solve;
        sample.setup.options.correction.method = PositionMethod::none; // it gives energy
        sample.setup.options.density_relaxation.steps = 0;
        sample.liquid = [=](const Vec3& x) { return x[1] - height - 0.1 / k * std::cos(k * x[0]); };
        auto step = started(Comm::world(), sample);
        const auto middle = [&] {
            double sum[2] = {0, 0};
            const auto& p = step->particles();
            for (int i = 0; i < p.store.owned(); ++i) sum[0] += 0.5 - p.position()(i, 0), sum[1] += 1;
            Comm::world().sum(std::span<double>(sum));
            return sum[0] / sum[1];
        };
        std::vector<double> time{0}, at{middle()}, crossing, peak{at[0]};
        while (crossing.size() < 5) {
            time.push_back(time.back() + step->advance(0.01).dt);
            at.push_back(middle());
            const std::size_t n = at.size() - 1;
            if (at[n] * at[n - 1] < 0)
                crossing.push_back(time[n - 1] + (time[n] - time[n - 1]) * at[n - 1] / (at[n - 1] - at[n]));
            if (n > 1 && std::fabs(at[n - 1]) > std::fabs(at[n]) && std::fabs(at[n - 1]) > std::fabs(at[n - 2])) {
                const double a = at[n - 2], b = at[n - 1], c = at[n];
                peak.push_back(std::fabs(b - 0.125 * (c - a) * (c - a) / (a - 2 * b + c))); // of a parabola
            }
        }
        const double found = math::pi * double(crossing.size() - 1) / (crossing.back() - crossing.front());
        const double rate = std::log(peak[0] / peak.back()) * found / (math::pi * double(peak.size() - 1));
        const std::string name = solve == StokesSolve::split ? "split" : "together";
        testing::Test::RecordProperty("frequency " + name, std::to_string(found / omega));
        testing::Test::RecordProperty("rate " + name, std::to_string(rate / gamma));
        EXPECT_NEAR(found / omega, 1, 0.02) << name;
        EXPECT_NEAR(rate / gamma, 1, 0.1) << name;
    }
}

struct Errors {
    double velocity, pressure; // L2, relative
};

// Of steady Stokes flow between free-slip walls, in the box with its mirror images in them: periodic, of twice the width, which is
// scaled to 1. `viscosity` and `force` (along y) are those of the box.
Errors errors(int cells, const StokesField& exact, const std::function<double(double, double)>& viscosity,
    const std::function<double(double, double)>& force) {
    const auto fraction = [](double x) { return x - std::floor(x + 1e-9); };
    const auto folded = [=](double x) { return std::min(2 * fraction(x), 2 - 2 * fraction(x)); }; // into the box
    const auto side = [=](double x) { return fraction(x) < 0.5 ? 1.0 : -1.0; };
    StokesSample sample;
    sample.dimensions = 2;
    sample.cells = 2 * cells;
    sample.periodic = {true, true, false};
    sample.density = 1;
    sample.viscosity = [=](const Vec3& x) { return viscosity(folded(x[0]), folded(x[1])); };
    sample.stokes.residual = 1e-11;
    StokesCase run(Comm::world(), sample);
    const double dt = 1e4; // inertia is nothing, and residuals of the mean velocity are small
    run.set_velocity(
        [&](int a, const Vec3& x) { return a == 1 ? dt * side(x[1]) * force(folded(x[0]), folded(x[1])) : 0.0; });
    EXPECT_TRUE(run.step(dt).solve.converged());
    const auto known = [&](int a, const Vec3& x) {
        const double b = folded(x[0]), c = folded(x[1]);
        return 0.25 * (a == 0 ? side(x[0]) * exact.u(b, c) : side(x[1]) * exact.v(b, c));
    };
    const double off = run.sum(
        [&](int a, std::size_t at, const Vec3& x) { return std::pow(run.velocity.axis[a](at) - known(a, x), 2); });
    const double all = run.sum([&](int a, std::size_t, const Vec3& x) { return std::pow(known(a, x), 2); });
    // Pressures differ by a constant.
    double sums[5] = {0, 0, 0, 0, 0}; // cells, p - q, its square, q, its square
    const auto owned = run.halo.owned();
    for (int i = 0; i < owned.size(); ++i) {
        int c[3];
        Vec3 x;
        owned.cell(i, c);
        run.grid.centre(c, x.data());
        const double q = 0.5 * exact.p(folded(x[0]), folded(x[1]));
        const double d =
            run.pressure.pressures()(static_cast<std::size_t>(run.halo.window().index(c[0], c[1], c[2]))) - q;
        const double terms[5] = {1, d, d * d, q, q * q};
        for (int k = 0; k < 5; ++k) sums[k] += terms[k];
    }
    Comm::world().sum(std::span<double>(sums));
    const auto variance = [&](int k) { return sums[k + 1] / sums[0] - std::pow(sums[k] / sums[0], 2); };
    return {std::sqrt(off / all), std::sqrt(variance(1) / variance(3))};
}

void check_orders(const std::string& name, const std::function<Errors(int)>& of) {
    const Errors coarse = of(16), middle = of(32), fine = of(64);
    const double velocity = std::log2(middle.velocity / fine.velocity),
                 pressure = std::log2(middle.pressure / fine.pressure);
    const auto text = [](double a, double b, double c) {
        return std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c);
    };
    testing::Test::RecordProperty(name + " velocity", text(coarse.velocity, middle.velocity, fine.velocity));
    testing::Test::RecordProperty(name + " pressure", text(coarse.pressure, middle.pressure, fine.pressure));
    EXPECT_GT(velocity, 1.8) << name;
    EXPECT_GT(std::log2(coarse.velocity / middle.velocity), 1.7) << name;
    EXPECT_GT(pressure, 0.9) << name;
    EXPECT_LT(fine.velocity, 0.01) << name;
}

TEST(StokesFlows, AJumpOfViscosityIsSecondOrder) {
    const auto exact = jump_of_viscosity(1, 1e6);
    check_orders("SolCx", [&](int cells) {
        return errors(
            cells, exact, [](double x, double) { return x < 0.5 - 1e-9   ? 1.0
                                                        : x > 0.5 + 1e-9 ? 1e6
                                                                         : 2 / (1 + 1e-6); },
            [](double x, double y) { return std::sin(math::pi * y) * std::cos(math::pi * x); });
    });
}

TEST(StokesFlows, AnExponentialViscosityIsSecondOrder) {
    const auto exact = exponential_viscosity(1e6, 2, 3);
    check_orders("SolKz", [&](int cells) {
        return errors(
            cells, exact, [](double, double y) { return std::pow(1e6, y); },
            [](double x, double y) { return std::sin(2 * math::pi * y) * std::cos(3 * math::pi * x); });
    });
}

} // namespace
} // namespace treacle::grid
