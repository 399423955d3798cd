#include "sph/pressure/rigid_coupling_term.hpp"

#include "sph/pressure/pressure_system.hpp"

#include <algorithm>

namespace treacle::sph {

namespace {
// True when neighbour k of a particle is the first one of its body.
KOKKOS_INLINE_FUNCTION bool is_first(const Pairs& solid, const Array<int>& body, std::int64_t begin, std::int64_t k) {
    for (std::int64_t l = begin; l < k; ++l) {
        if (body(solid.index(l)) == body(solid.index(k))) return false;
    }
    return true;
}

template <class Kernel>
struct ResponseLoop {
    Kernel kernel;
    Fluid fluid;
    MomentReferencePoints points;
    Array<int> dynamic, offset, entry_body;
    Array<double> row;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const auto& list = fluid.solid;
        int entry = offset(i);
        if (entry == offset(i + 1)) return;
        for (std::int64_t k = list.offset(i); k < list.offset(i + 1); ++k) {
            const int body = fluid.solid_body(list.index(k));
            if (dynamic(body) == 0 || !is_first(list, fluid.solid_body, list.offset(i), k)) continue;
            entry_body(entry) = body;
            fill(i, body, &row(6 * static_cast<std::size_t>(entry)));
            ++entry;
        }
    }

    KOKKOS_INLINE_FUNCTION void fill(int i, int body, double* u) const {
        const Constants& c = fluid.constants;
        const auto& x = fluid.solid.among;
        // The root, since the product has these rows twice, and the force has the push once.
        const double scale = fluid.volume(i) * math::sqrt(c.wall_pressure_factor / c.mass) * c.rest_density;
        for (int k = 0; k < 6; ++k) u[k] = 0;
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            if (fluid.solid_body(s) != body) return;
            const double f = scale * fluid.solid_volume(s) * kernel.gradient(math::sqrt(r2));
            const double along[3] = {f * dx, f * dy, f * dz};
            double g[3];
            fluid.correction.towards_solid(i, s, along, g);
            const double position[3] = {x(s, 0), x(s, 1), x(s, 2)};
            points.add(u, body, position, g);
        });
    }
};

// sum_i U_i^T p_i, 6 numbers a load.
struct ImpulseLoop : LoadReduction {
    Array<int> offset, body;
    Array<double> row, pressure;

    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        for (int e = offset(i); e < offset(i + 1); ++e) {
            for (int k = 0; k < 6; ++k) sum[6 * body(e) + k] += row(6 * e + k) * pressure(i);
        }
    }
};
} // namespace

void RigidCouplingTerm::count(
    const LiquidParticles& liquid, const SolidParticles& solid, const Neighbourhood& neighbours) {
    const int n = liquid.store.owned();
    reserve(offset_, static_cast<std::size_t>(n + 1));
    const auto list = pairs(neighbours.solid, liquid.store, solid.store);
    const auto body = solid.body(), dynamic = dynamic_, offset = offset_;
    int total = 0;
    Kokkos::parallel_scan(
        "treacle::count_responses", n + 1,
        KOKKOS_LAMBDA(int i, int& sum, bool last) {
            int here = 0;
            if (i < n) {
                for (std::int64_t k = list.offset(i); k < list.offset(i + 1); ++k) {
                    const int b = body(list.index(k));
                    here += static_cast<int>(dynamic(b) != 0 && is_first(list, body, list.offset(i), k));
                }
            }
            if (last) offset(i) = sum;
            sum += here;
        },
        total);
    entries_ = total;
}

void RigidCouplingTerm::build(const StepContext& parts, const Bodies& bodies) {
    const auto& constants = parts.constants;
    const auto loads = static_cast<std::size_t>(bodies.moment_reference_points().count);
    loads_ = loads;
    first_ = static_cast<std::size_t>(bodies.first());
    mobility_ = bodies.rigid.mobility();
    reserve(dynamic_, loads);
    auto flags = Kokkos::create_mirror_view(dynamic_);
    for (std::size_t k = 0; k < loads; ++k) flags(k) = 0;
    for (std::size_t b = 0; b < bodies.rigid.size(); ++b) {
        const auto load = static_cast<std::size_t>(bodies.first()) + b;
        flags(load) = static_cast<int>(bodies.rigid.dynamic(b));
    }
    Kokkos::deep_copy(dynamic_, flags);
    count(parts.liquid, parts.solid, parts.neighbours);
    reserve(body_, static_cast<std::size_t>(entries_));
    reserve(row_, static_cast<std::size_t>(6 * entries_));
    const auto fluid = make_views(constants, parts.liquid, parts.solid, parts.neighbours);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        Kokkos::parallel_for("treacle::responses", fluid.count,
            ResponseLoop<Kernel>{kernel, fluid, bodies.moment_reference_points(), dynamic_, offset_, body_, row_});
    });
}

// Velocities that impulses on the bodies give, 6 numbers a load.
std::vector<double> RigidCouplingTerm::respond(std::span<const double> impulses) const {
    std::vector<double> out(impulses.size(), 0.0);
    std::ranges::copy(
        mobility_.respond(impulses.subspan(6 * first_)), out.begin() + static_cast<std::ptrdiff_t>(6 * first_));
    return out;
}

void RigidCouplingTerm::apply_to_pressure(const Comm& comm, LiquidParticles& liquid) const {
    apply(comm, liquid.store.owned(), liquid.pressure(), liquid.response());
}

void RigidCouplingTerm::apply(
    const Comm& comm, int owned, const Array<double>& x, const Array<double>& response) const {
    std::vector<double> sums(6 * loads_, 0.0);
    Kokkos::parallel_reduce(
        "treacle::body_impulses", owned, ImpulseLoop{{sums.size()}, offset_, body_, row_, x}, host_sums(sums));
    comm.sum(std::span(sums));
    const auto moved = upload(respond(sums));
    const auto offset = offset_, body = body_;
    const auto row = row_;
    Kokkos::parallel_for(
        "treacle::body_response", owned, KOKKOS_LAMBDA(int i) {
            double sum = 0;
            for (int e = offset(i); e < offset(i + 1); ++e) {
                for (int k = 0; k < 6; ++k) sum += row(6 * e + k) * moved(6 * body(e) + k);
            }
            response(i) = sum;
        });
}

RigidCouplingTerm::Addition RigidCouplingTerm::addition(
    const Comm& comm, const LiquidParticles& liquid, const PressureSystem& system) const {
    struct Entry {
        std::size_t row, body;
        double u[6];
    };
    const auto offset = on_host(offset_), body = on_host(body_), number = on_host(liquid.row());
    const auto row = on_host(row_);
    std::vector<Entry> entries;
    for (int i = 0; i < liquid.store.owned(); ++i) {
        if (number(i) < 0) continue;
        for (int e = offset(i); e < offset(i + 1); ++e) {
            Entry entry{
                static_cast<std::size_t>(number(i) - system.first_row()), static_cast<std::size_t>(body(e)), {}};
            for (int k = 0; k < 6; ++k) entry.u[k] = row(6 * e + k);
            entries.push_back(entry);
        }
    }
    return [this, comm, entries = std::move(entries)](std::span<const double> x, std::span<double> y) {
        std::vector<double> sums(6 * loads_, 0.0);
        for (const auto& [r, b, u] : entries) {
            for (std::size_t k = 0; k < 6; ++k) sums[6 * b + k] += u[k] * x[r];
        }
        comm.sum(std::span(sums));
        const auto v = respond(sums);
        for (const auto& [r, b, u] : entries) {
            double sum = 0;
            for (std::size_t k = 0; k < 6; ++k) sum += u[k] * v[6 * b + k];
            y[r] += sum;
        }
    };
}

} // namespace treacle::sph
