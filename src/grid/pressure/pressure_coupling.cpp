#include "grid/pressure/pressure_coupling.hpp"

#include "kokkos/scan.hpp"

#include <cmath>

namespace treacle::grid {

namespace {
// The bodies at the faces of a cell.
struct CellBodies {
    PressureFaces faces;
    FaceField fluid;
    Array<int> first[3], body[3];
    Array<double> fraction[3];

    CellBodies(const PressureFaces& given, const FaceField& fluid_fractions, const FaceBodyFractions& of)
        : faces(given), fluid(fluid_fractions) {
        for (int a = 0; a < 3; ++a) {
            const auto& bodies = of[static_cast<std::size_t>(a)];
            first[a] = bodies.first;
            body[a] = bodies.body;
            fraction[a] = bodies.fraction;
        }
    }

    // Calls use(body, closed area of the body, axis, face, sign) for each body at each face.
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each(std::size_t cell, const Use& use) const {
        for (int a = 0; a < faces.dimensions; ++a) {
            for (int side = 0; side < 2; ++side) {
                const std::size_t face = side == 0 ? cell : cell + static_cast<std::size_t>(faces.stride[a]);
                const double closed = 1 - faces.open(a, face), solid = 1 - fluid.axis[a](face);
                if (!(closed > 0) || !(solid > 0)) continue;
                for (int k = first[a](face); k < first[a](face + 1); ++k) {
                    if (fraction[a](k) > 0)
                        use(body[a](k), closed * fraction[a](k) / solid, a, face, side == 0 ? -1.0 : 1.0);
                }
            }
        }
    }
    // True when a body stands at one of the faces before this one, in the order of each().
    KOKKOS_INLINE_FUNCTION bool is_first(std::size_t cell, int number, int axis, std::size_t at, double at_sign) const {
        bool passed = false, found = false;
        each(cell, [&](int b, double, int a, std::size_t face, double sign) {
            passed = passed || (a == axis && face == at && sign == at_sign);
            found = found || (!passed && b == number);
        });
        return !found;
    }
};

struct CouplingLoop {
    CellBodies bodies;
    MotionPoints points;
    BodyMotion motion;
    Array<int> cell_of, offset, body;
    Array<double> u;

    KOKKOS_INLINE_FUNCTION void operator()(int r) const {
        const int begin = offset(r), end = offset(r + 1);
        if (begin == end) return;
        for (int e = begin; e < end; ++e) {
            body(e) = -1;
            for (int k = 0; k < 6; ++k) u(6 * e + k) = 0;
        }
        bodies.each(
            static_cast<std::size_t>(cell_of(r)), [&](int b, double area, int a, std::size_t face, double sign) {
                int e = begin;
                while (body(e) != b && body(e) != -1) ++e;
                body(e) = b;
                int c[3];
                double x[3], arm[3], load[6] = {0, 0, 0, 0, 0, 0};
                bodies.faces.window.cell(static_cast<int>(face), c);
                points.at(b, a, c, face, x);
                motion.arm(b, x, arm);
                add_load(a, arm, sign * area, load);
                for (int k = 0; k < 6; ++k) u(6 * e + k) += load[k];
            });
    }
};
} // namespace

MotionPoints SlipAreas::points(const MacGrid& grid) const {
    MotionPoints points{grid, closed != nullptr, length, {}};
    for (int a = 0; a < grid.dimensions && closed; ++a) {
        for (int k = 0; k < 2; ++k) points.offset[a][k] = closed->offset(a, k);
    }
    return points;
}

int PressureCoupling::count(
    const PressureSystem& system, const FaceField& fluid, const FaceBodyFractions& body_fractions) {
    reserve(offset_, static_cast<std::size_t>(system.rows()) + 1);
    const CellBodies bodies(system.faces(), fluid, body_fractions);
    const auto offset = offset_, cell_of = system.cell_of();
    Kokkos::parallel_for(
        "treacle::count_couplings", system.rows(), KOKKOS_LAMBDA(int r) {
            const auto cell = static_cast<std::size_t>(cell_of(r));
            int here = 0;
            bodies.each(cell, [&](int b, double, int a, std::size_t face, double sign) {
                here += static_cast<int>(bodies.is_first(cell, b, a, face, sign));
            });
            offset(r) = here;
        });
    return static_cast<int>(counts_to_offsets(offset_, system.rows()));
}

void PressureCoupling::build(const PressureSystem& system, const MacGrid& grid, const FaceField& fluid,
    const FaceBodyFractions& body_fractions, const BodyMotion& motion, const SlipAreas& slip) {
    bodies_ = static_cast<std::size_t>(motion.bodies);
    face_ = std::pow(grid.dx, grid.dimensions - 1);
    rows_ = system.rows();
    entries_.clear();
    if (bodies_ == 0) return;
    const int n = count(system, fluid, body_fractions);
    reserve(body_, static_cast<std::size_t>(n));
    reserve(u_, 6 * static_cast<std::size_t>(n));
    Kokkos::parallel_for("treacle::couplings", system.rows(),
        CouplingLoop{CellBodies(system.faces(), fluid, body_fractions), slip.points(grid), motion, system.cell_of(),
            offset_, body_, u_});
    const auto offset = on_host(offset_), body = on_host(body_);
    const auto u = on_host(u_);
    for (int r = 0; r < system.rows() && n > 0; ++r) {
        for (int e = offset(r); e < offset(r + 1); ++e) {
            Entry entry{r, body(e), {}};
            for (int k = 0; k < 6; ++k) entry.u[k] = u(6 * static_cast<std::size_t>(e) + static_cast<std::size_t>(k));
            entries_.push_back(entry);
        }
    }
}

void PressureCoupling::subtract_flux(const BodyMotion& motion, double scale, const Array<double>& out) const {
    if (entries_.empty()) return;
    const auto offset = offset_, body = body_;
    const auto u = u_;
    Kokkos::parallel_for(
        "treacle::body_flux", rows_, KOKKOS_LAMBDA(int r) {
            double flux = 0;
            for (int e = offset(r); e < offset(r + 1); ++e) {
                for (int k = 0; k < 6; ++k) flux += u(6 * e + k) * motion.frame(BodyMotion::width * body(e) + 3 + k);
            }
            out(r) -= scale * flux;
        });
}

std::vector<double> PressureCoupling::sums(const Comm& comm, std::span<const double> x) const {
    std::vector<double> out(6 * bodies_, 0.0);
    for (const auto& [row, body, u] : entries_) {
        for (std::size_t k = 0; k < 6; ++k)
            out[6 * static_cast<std::size_t>(body) + k] += u[k] * x[static_cast<std::size_t>(row)];
    }
    comm.sum(std::span(out));
    return out;
}

std::vector<double> PressureCoupling::loads(const Comm& comm, std::span<const double> x) const {
    auto out = sums(comm, x);
    for (double& load : out) load *= face_;
    return out;
}

void PressureCoupling::add_response(const Comm& comm, const rigid::ConstrainedInverseMass& mobility, double mass,
    std::span<const double> x, std::span<double> y) const {
    add_flux(mobility.respond(sums(comm, x)), mass, y);
}

void PressureCoupling::add_flux(std::span<const double> velocities, double factor, std::span<double> y) const {
    for (const auto& [row, body, u] : entries_) {
        double flux = 0;
        for (std::size_t k = 0; k < 6; ++k) flux += u[k] * velocities[6 * static_cast<std::size_t>(body) + k];
        y[static_cast<std::size_t>(row)] += factor * flux;
    }
}

std::size_t PressureCoupling::bytes() const {
    return 4 * (offset_.span() + body_.span()) + 8 * u_.span() + sizeof(Entry) * entries_.capacity();
}

} // namespace treacle::grid
