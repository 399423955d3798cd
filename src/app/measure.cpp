#include "app/measure.hpp"

#include <cmath>

namespace treacle::app {

namespace {
constexpr double nowhere = -1e300;

double measure_front(int axis, const sph::IsphStep& solver) {
    const auto x = solver.liquid().position();
    double front = nowhere;
    Kokkos::parallel_reduce("treacle::front", solver.liquid().store.owned(), KOKKOS_LAMBDA(int i, double& most) {
        most = math::max(most, x(i, axis));
    }, Kokkos::Max<double>(front));
    const double over_ranks = solver.comm().max(front);
    return over_ranks > nowhere ? over_ranks + solver.setup().constants.spacing / 2 : 0.0;
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

double measure_height(const Vec3& position, const scene::Domain& domain, const sph::IsphStep& solver) {
    const auto [axis, sign] = upwards(domain);
    const auto x = solver.liquid().position();
    const double d = solver.setup().constants.spacing;
    const double px = position[0], py = position[1], pz = position[2];
    const int up = axis;
    const double way = sign;
    double top = nowhere;
    Kokkos::parallel_reduce("treacle::height", solver.liquid().store.owned(), KOKKOS_LAMBDA(int i, double& most) {
        const double p[3] = {px, py, pz};
        for (int k = 0; k < 3; ++k) {
            if (k != up && math::fabs(x(i, k) - p[k]) > d) return;
        }
        most = math::max(most, way * x(i, up));
    }, Kokkos::Max<double>(top));
    const double over_ranks = solver.comm().max(top);
    const auto u = static_cast<std::size_t>(axis);
    const double floor = sign > 0 ? domain.min[u] : -domain.max[u];
    return over_ranks > nowhere ? over_ranks + d / 2 - floor : 0.0;
}

double measure_flow(const scene::Measurement& measurement, const sph::IsphStep& solver) {
    const int axis = measurement.axis;
    const double at = measurement.position[static_cast<std::size_t>(axis)];
    const double half = solver.setup().constants.support / 2;
    const auto x = solver.liquid().position(), u = solver.liquid().velocity();
    double sum = 0;
    Kokkos::parallel_reduce("treacle::flow", solver.liquid().store.owned(), KOKKOS_LAMBDA(int i, double& flow) {
        if (math::fabs(x(i, axis) - at) < half) flow += u(i, axis);
    }, sum);
    return solver.comm().sum(sum) * solver.setup().constants.rest_volume / (2 * half);
}
} // namespace

double measure(const scene::Measurement& measurement, const scene::Domain& domain, const sph::IsphStep& solver) {
    switch (measurement.kind) {
    case scene::MeasurementKind::front: return measure_front(measurement.axis, solver);
    case scene::MeasurementKind::height: return measure_height(measurement.position, domain, solver);
    case scene::MeasurementKind::flow: return measure_flow(measurement, solver);
    }
    return 0;
}

std::string measurement_column(const scene::Measurement& measurement, const scene::Domain& domain) {
    const bool flow = measurement.kind == scene::MeasurementKind::flow;
    return measurement.name + (flow ? (domain.dimensions == 3 ? " [m3/s]" : " [m2/s]") : " [m]");
}

} // namespace treacle::app
