#include "../sph/solver_environment.hpp"
#include "step_sample.hpp"

#include <gtest/gtest.h>

namespace treacle::grid {
namespace {

[[maybe_unused]] const auto* const solvers = testing::AddGlobalTestEnvironment(new sph::SolverEnvironment);

// A drop of 1 mm of water's density in free space, its middle at no place of the lattice:
// r = R (1 + stretch P) with P = cos 2 phi in the plane and the second Legendre polynomial in space.
struct Drop {
    int dimensions = 2;
    double cells = 8, viscosity = 0, stretch = 0, speed = 0;
};
constexpr double radius = 1e-3, density = 1000, tension = 0.072;

// [1/s] without viscosity (Lamb 1932, 273 and 275).
double frequency(const Drop& drop, double of_radius = radius) {
    return std::sqrt((drop.dimensions == 2 ? 6 : 8) * tension / (density * std::pow(of_radius, 3)));
}

StepSample sample_of_drop(const Drop& drop) {
    auto sample = sample_of(10, drop.dimensions);
    auto& domain = sample.setup.domain;
    const double dx = radius / drop.cells, half = std::ceil(1.4 * drop.cells + 3) * dx;
    domain.spacing = sample.setup.rigid.spacing = dx;
    domain.gravity = sample.setup.rigid.gravity = {0, 0, 0};
    for (auto& face : domain.faces) face.kind = scene::BoundaryKind::open;
    for (std::size_t k = 0; k < 3; ++k) {
        const bool used = k < static_cast<std::size_t>(drop.dimensions);
        domain.min[k] = used ? -half : 0;
        domain.max[k] = used ? half : 0;
    }
    domain.max[0] += std::ceil(drop.speed * 4 * 2 * math::pi / frequency(drop) / dx) * dx;
    sample.setup.density = density;
    sample.setup.viscosity = drop.viscosity;
    sample.setup.surface_tension = {tension};
    const Vec3 middle{0.13 * dx, 0.31 * dx, drop.dimensions == 3 ? 0.47 * dx : 0};
    sample.liquid = [=](const Vec3& x) {
        const double a = x[0] - middle[0], b = x[1] - middle[1], c = drop.dimensions == 3 ? x[2] - middle[2] : 0;
        const double square = std::max(a * a + b * b + c * c, 1e-30);
        const double shape = drop.dimensions == 2 ? (a * a - b * b) / square : 1.5 * a * a / square - 0.5;
        return std::sqrt(square) - radius * (1 + drop.stretch * shape);
    };
    sample.velocity = [=](const Vec3&) { return Vec3{drop.speed, 0, 0}; };
    return sample;
}

struct Seen {
    std::vector<double> time, energy, stretch; // [s], [J] or [J/m] of what moves about the middle, [1]
    double radius = 0;                         // of the volume that the particles have [m]
    double farthest = 0;                       // of a particle from the middle, in the end [m]
    double drift = 0;                          // speed of the whole, in the end [m/s]
};

void look(const GridStep& step, const Drop& drop, Seen& seen) {
    const auto& particles = step.particles();
    std::array<double, 11> sums{}; // particles, positions, their squares, velocities, the square of those
    for (int i = 0; i < particles.store.owned(); ++i) {
        sums[0] += 1;
        for (std::size_t k = 0; k < 3; ++k) {
            const double x = particles.position()(i, k), u = particles.velocity()(i, k);
            sums[1 + k] += x;
            sums[4 + k] += x * x;
            sums[7 + k] += u;
            sums[10] += u * u;
        }
    }
    step.comm().sum(std::span<double>(sums));
    const double n = sums[0];
    Vec3 middle, spread;
    double moving = 0, farthest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        middle[k] = sums[1 + k] / n;
        spread[k] = sums[4 + k] / n - middle[k] * middle[k];
        moving += sums[7 + k] * sums[7 + k] / n;
    }
    for (int i = 0; i < particles.store.owned(); ++i) {
        double square = 0;
        for (std::size_t k = 0; k < 3; ++k) square += std::pow(particles.position()(i, k) - middle[k], 2);
        farthest = std::max(farthest, std::sqrt(square));
    }
    const double volume = std::pow(radius / drop.cells / 2, drop.dimensions), mass = density * volume;
    seen.radius = drop.dimensions == 2 ? std::sqrt(n * volume / math::pi) : std::cbrt(0.75 * n * volume / math::pi);
    seen.energy.push_back(0.5 * mass * (sums[10] - moving));
    seen.stretch.push_back(spread[0] - (drop.dimensions == 2 ? spread[1] : 0.5 * (spread[1] + spread[2])));
    seen.farthest = step.comm().max(farthest);
    seen.drift = std::sqrt(moving / n);
}

// Of `periods` of its oscillation.
Seen run(const Drop& drop, double periods, const Comm& comm = Comm::world()) {
    auto step = started(comm, sample_of_drop(drop));
    Seen seen;
    const double end = periods * 2 * math::pi / frequency(drop);
    for (double time = 0; time < end;) {
        time += step->advance(step->stable_step(step->setup().options.cfl)).dt;
        seen.time.push_back(time);
        look(*step, drop, seen);
    }
    return seen;
}

double largest(const std::vector<double>& of, double from, double to) {
    const auto n = static_cast<double>(of.size());
    return *std::max_element(of.begin() + std::lround(from * n), of.begin() + std::lround(to * n));
}

// What the roughness of its particles sets free at first dies down, and no particle leaves. With curvatures that are not those of
// the nearest surface, crests of the particles' spacing are pulled outwards and leave within four periods.
TEST(Drops, AtRestStayAtRest) {
    for (const auto& drop : {Drop{2, 8, 0}, Drop{2, 8, 0.005}, Drop{2, 8, 0.005, 0, 0.5}, Drop{3, 4, 0.005}}) {
        const auto seen = run(drop, drop.dimensions == 2 ? 4 : 2);
        const double surface =
            tension * (drop.dimensions == 2 ? 2 * math::pi * radius : 4 * math::pi * radius * radius);
        EXPECT_LT(largest(seen.energy, 0.5, 1), largest(seen.energy, 0, 0.125))
            << drop.dimensions << ' ' << drop.viscosity;
        EXPECT_LT(largest(seen.energy, 0, 1), 2e-3 * surface); // 1e-3 in the plane, 1e-4 in space
        EXPECT_LT(seen.farthest, radius * (1 + 0.7 / drop.cells));
        EXPECT_LT(std::fabs(seen.drift - drop.speed), 0.015); // 0.01: what the faces' curvatures do not cancel
    }
}

// From the largest stretch the mean of all is passed after a quarter and three quarters of a period.
TEST(Drops, OscillateAtTheirFrequency) {
    for (const auto& drop : {Drop{2, 4, 0.001, 0.05}, Drop{2, 8, 0.001, 0.05}, Drop{3, 4, 0.001, 0.05}}) {
        const auto seen = run(drop, 1.05);
        const auto [least, most] = std::ranges::minmax(seen.stretch);
        const double mean = 0.5 * (least + most);
        std::vector<double> passed;
        for (std::size_t k = 1; k < seen.time.size(); ++k) {
            const double before = seen.stretch[k - 1] - mean, after = seen.stretch[k] - mean;
            if (before * after < 0)
                passed.push_back(seen.time[k - 1] + before / (before - after) * (seen.time[k] - seen.time[k - 1]));
        }
        ASSERT_EQ(passed.size(), 2u) << drop.dimensions << ' ' << drop.cells;
        EXPECT_NEAR(math::pi / (passed[1] - passed[0]) / frequency(drop, seen.radius), 1, 0.04)
            << drop.dimensions << ' ' << drop.cells;
    }
}

TEST(Drops, AreTheSameOnOneRankAndOnAll) {
    for (const int dimensions : {2, 3}) {
        const Drop drop{dimensions, 4, 0.001, 0.1};
        auto sample = sample_of_drop(drop);
        sample.setup.options.pressure.residual = sample.setup.options.viscosity.residual = 1e-12;
        auto all = started(Comm::world(), sample), one = started(Comm::self(), sample);
        for (int k = 0; k < 6; ++k) {
            const double dt = all->stable_step(1);
            all->advance(dt);
            one->advance(dt);
        }
        const auto alone = states(*one);
        double most = 0;
        for (const auto& [id, state] : states(*all)) {
            const auto& other = alone.at(id);
            for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::fabs(state[k] - other[k]));
        }
        EXPECT_LT(Comm::world().max(most), 1e-9 * radius) << dimensions; // the solves' residuals
    }
}

} // namespace
} // namespace treacle::grid
