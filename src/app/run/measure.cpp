#include "app/run/measure.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace treacle::app {

namespace {
constexpr double nowhere = -1e300;

// Particles that are measured.
struct Chosen {
    Array<int> liquid;
    int number;         // -1: all
    Array<int> waiting; // at inlets, without rows where none does

    KOKKOS_INLINE_FUNCTION bool operator()(int i) const {
        return (number < 0 || liquid(i) == number) && (waiting.size() == 0 || waiting(i) == 0);
    }
};
Chosen choose(const scene::Measurement& measurement, const scene::Scene& scene, const Simulation& solver) {
    const auto view = solver.view();
    Chosen out{view.liquid, -1, view.waiting};
    const auto at = std::ranges::find(scene.liquids, measurement.liquid, &scene::Liquid::name);
    if (at != scene.liquids.end()) out.number = static_cast<int>(at - scene.liquids.begin());
    return out;
}

double measure_front(int axis, const Chosen& chosen, const Simulation& solver) {
    const auto view = solver.view();
    const auto x = view.position;
    double front = nowhere;
    Kokkos::parallel_reduce(
        "treacle::front", view.owned,
        KOKKOS_LAMBDA(int i, double& most) {
            if (chosen(i)) most = math::max(most, x(i, axis));
        },
        Kokkos::Max<double>(front));
    const double over_ranks = solver.comm().max(front);
    return over_ranks > nowhere ? over_ranks + view.spacing / 2 : 0.0;
}

// The axis that gravity pulls along most, and the way up along it.
std::pair<int, double> upwards(const scene::Domain& domain) {
    int axis = domain.dimensions - 1;
    for (int k = 0; k < domain.dimensions; ++k) {
        if (std::abs(domain.gravity[static_cast<std::size_t>(k)]) >
            std::abs(domain.gravity[static_cast<std::size_t>(axis)])) {
            axis = k;
        }
    }
    return {axis, domain.gravity[static_cast<std::size_t>(axis)] > 0 ? -1.0 : 1.0};
}

// Integral of the hat 1 - |t| / radius from -infinity to t.
double hat_below(double t, double radius) {
    const double q = std::clamp(t / radius, -1.0, 1.0);
    return radius * (q < 0 ? 0.5 * (1 + q) * (1 + q) : 1 - 0.5 * (1 - q) * (1 - q));
}

// The part of space around a vertical line whose liquid is sampled, level by level.
struct HeightGauge {
    double at[3], radius;
    int up, dimensions;
    double way, floor, step; // level k is at way * floor + k * step along `way` [m]
    int levels;
    double area; // of the weights inside the domain, [m] in 2D, [m2] in 3D

    KOKKOS_INLINE_FUNCTION double weight(const Array3& x, int i) const {
        double w = 1;
        for (int k = 0; k < dimensions; ++k) {
            if (k != up) w *= math::max(0.0, 1 - math::fabs(x(i, k) - at[k]) / radius);
        }
        return w;
    }
};

HeightGauge make_height_gauge(const Vec3& position, const scene::Domain& domain, const LiquidView& view) {
    const auto [axis, sign] = upwards(domain);
    const auto u = static_cast<std::size_t>(axis);
    HeightGauge out{
        {position[0], position[1], position[2]}, view.support_radius, axis, domain.dimensions, sign, 0, 0, 0, 1};
    out.floor = sign > 0 ? domain.min[u] : -domain.max[u];
    out.step = 0.5 * view.spacing;
    // A level below and two above: the profile starts and ends with what liquid pressed to a side has beyond it.
    out.levels = static_cast<int>(std::ceil((domain.max[u] - domain.min[u]) / out.step)) + 4;
    for (int k = 0; k < domain.dimensions; ++k) {
        const auto c = static_cast<std::size_t>(k);
        if (k == axis) continue;
        out.area *=
            hat_below(domain.max[c] - position[c], out.radius) - hat_below(domain.min[c] - position[c], out.radius);
    }
    return out;
}

// Share of each level that is liquid, over all ranks: particles are spread over a spacing up and down. Counted in
// integers, so that no order of the particles changes it.
std::vector<double> wet_levels(const HeightGauge& gauge, const Chosen& chosen, const Simulation& solver) {
    const auto view = solver.view();
    const auto x = view.position;
    const double d = view.spacing, unit = 1e-9 * gauge.area * d / view.volume;
    const Array<std::int64_t> counts("treacle::wet_levels", static_cast<std::size_t>(gauge.levels));
    Kokkos::parallel_for(
        "treacle::height", view.owned, KOKKOS_LAMBDA(int i) {
            const double weight = chosen(i) ? gauge.weight(x, i) : 0;
            if (weight == 0) return;
            const double y = (gauge.way * x(i, gauge.up) - gauge.floor) / gauge.step;
            const int nearest = static_cast<int>(math::floor(y));
            for (int k = nearest - 2; k <= nearest + 3; ++k) {
                const double fraction = weight * (1 - math::fabs(y - k) * gauge.step / d) / unit;
                if (fraction <= 0 || k < 0 || k >= gauge.levels) continue;
                Kokkos::atomic_add(&counts(k), static_cast<std::int64_t>(fraction));
            }
        });
    const auto host = on_host(counts);
    std::vector<std::int64_t> sums(host.data(), host.data() + host.extent(0));
    solver.comm().sum(std::span(sums));
    std::vector<double> out;
    out.reserve(sums.size());
    for (const auto count : sums) out.push_back(1e-9 * double(count));
    return out;
}

// End of the liquid over a point: the highest level, above the lower side of the domain, at which half of the
// surroundings, a support radius wide, is liquid [m].
double measure_height(
    const Vec3& position, const scene::Domain& domain, const Chosen& chosen, const Simulation& solver) {
    const auto gauge = make_height_gauge(position, domain, solver.view());
    const auto wet = wet_levels(gauge, chosen, solver);
    for (std::size_t k = wet.size() - 1; k > 0; --k) {
        if (wet[k] >= 0.5 || wet[k - 1] < 0.5) continue;
        return gauge.step * (double(k - 1) + (wet[k - 1] - 0.5) / (wet[k - 1] - wet[k]));
    }
    return 0;
}

double measure_flow(const scene::Measurement& measurement, const Chosen& chosen, const Simulation& solver) {
    const int axis = measurement.axis;
    const double at = measurement.position[static_cast<std::size_t>(axis)];
    const auto view = solver.view();
    const double half = view.support_radius / 2;
    const auto x = view.position, u = view.velocity;
    double sum = 0;
    Kokkos::parallel_reduce(
        "treacle::flow", view.owned,
        KOKKOS_LAMBDA(int i, double& flow) {
            if (math::fabs(x(i, axis) - at) < half && chosen(i)) flow += u(i, axis);
        },
        sum);
    return solver.comm().sum(sum) * view.volume / (2 * half);
}
} // namespace

double measure(const scene::Measurement& measurement, const scene::Scene& scene, const Simulation& solver) {
    const auto chosen = choose(measurement, scene, solver);
    switch (measurement.kind) {
    case scene::MeasurementKind::front: return measure_front(measurement.axis, chosen, solver);
    case scene::MeasurementKind::height: return measure_height(measurement.position, scene.domain, chosen, solver);
    case scene::MeasurementKind::flow: return measure_flow(measurement, chosen, solver);
    }
    return 0;
}

std::string measurement_column(const scene::Measurement& measurement, const scene::Domain& domain) {
    const bool flow = measurement.kind == scene::MeasurementKind::flow;
    return measurement.name + (flow ? (domain.dimensions == 3 ? " [m3/s]" : " [m2/s]") : " [m]");
}

} // namespace treacle::app
