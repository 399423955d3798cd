#include "grid/stokes.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "grid/face_fields.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::grid {

namespace {
// Of the right-hand side, a residual with which a step can still go on: the solve has come near, and the report says so.
constexpr double most_residual = 1e-2;

// Of a cell between equally viscous ones, 1/(2 eta) is the exact share of a pressure's flux; the loop below has
// 4 d/((2 d + 2) eta) of it in d dimensions.
double exact_share(int dimensions) { return 4.0 * dimensions / (2.0 * dimensions + 2); }

// How much pressure a flux into a cell makes against the viscosity alone [Pa s/m3]: the inverse of the sum of
// area^2 / (resistance of the face's own stresses). Nothing beside faces that no stress holds.
struct StiffnessLoop {
    ViscousFaces viscous;
    PressureFaces pressure;
    Array<int> cell_of;
    double face, factor; // [m2], of a plane scene [m]
    Array<double> out;

    KOKKOS_INLINE_FUNCTION void operator()(int r) const {
        double sum = 0;
        bool slack = false;
        for (int a = 0; a < pressure.dimensions; ++a) {
            for (int side = 0; side < 2; ++side) {
                const auto i = cell_of(r) + side * pressure.stride[a];
                const double area = face * pressure.open(a, static_cast<std::size_t>(i));
                if (!(area > 0)) continue;
                double stress = 0;
                viscous.each_stress(a, i, viscous.normal, viscous.shear, [&](double w) { stress += w; });
                const double share = viscous.share.axis[a](i), resistance = share * share * stress;
                slack = slack || !(resistance > 0);
                if (resistance > 0) sum += area * area / resistance;
            }
        }
        out(r) = slack || !(sum > 0) ? 0.0 : factor / sum;
    }
};

// The forces of pressures on the faces of the viscous system, from what they change of the velocities without viscosity:
// with the mass A theta of the projection they are area times pressure, and what one cell pushes sums to nothing.
void forces(const PressureFaces& faces, const Array<int>& place_of, int n, double mass, const FaceField& change,
            const Array<double>& out) {
    Kokkos::parallel_for("treacle::pressure_forces", n, KOKKOS_LAMBDA(int r) {
        const int a = place_of(r) % 3, i = place_of(r) / 3;
        out(r) = mass * math::max(faces.pushed(a, static_cast<std::size_t>(i)), 0.0) * change.axis[a](i);
    });
}

solve::IdrOptions idr_options(const StokesOptions& options) {
    solve::IdrOptions out;
    out.max_iterations = options.max_iterations;
    return out;
}

void clear(FaceField& field, const MacGrid& grid, const CellBox& window) {
    reserve_faces(field, grid, window);
    for (int a = 0; a < grid.dimensions; ++a) Kokkos::deep_copy(field.axis[a], 0.0);
}
} // namespace

void close_held_faces(const ViscousFaces& viscous, const FaceField& open, FaceField& out) {
    for (int a = 0; a < viscous.dimensions; ++a) {
        const auto n = static_cast<std::size_t>(viscous.window.size());
        reserve(out.axis[a], n);
        const auto from = open.axis[a], to = out.axis[a];
        const auto role = viscous.role[a];
        Kokkos::parallel_for("treacle::close_held_faces", static_cast<int>(n),
                             KOKKOS_LAMBDA(int i) { to(i) = role(i) == held_face ? 0.0 : from(i); });
    }
}

// The products of the whole system; rows of the viscous system first, then those of the pressures.
struct Stokes::System {
    Stokes& of;
    const Parts& parts;
    std::size_t n, m;      // rows of velocities and motions, of pressures
    double face, inertia;  // [m2]; [kg/(m s)], in the plane [m], [kg/(m2 s)]: pressures of the projection per flux

    System(Stokes& stokes, const Parts& given)
        : of(stokes), parts(given), n(given.viscous.rows()), m(given.pressure.rows()) {
        const auto& grid = given.scene.grid;
        face = std::pow(grid.dx, grid.dimensions - 1);
        inertia = given.scene.density / (given.dt * std::pow(grid.dx, grid.dimensions - 2));
    }

    // y = G^T x = -(A u + J L q) areas
    void flux(std::span<const double> x, std::span<double> y) const {
        parts.viscous.write(x, of.velocity_);
        gather_faces(parts.scene.grid, parts.scene.halo, of.velocity_);
        parts.pressure.flux(of.velocity_, y);
        parts.pressure.coupling().add_flux(parts.viscous.changes(parts.viscous.motions(x)), -1, y);
        for (double& value : y) value *= face;
    }
    // What the pressures change of the velocities of faces in dt if there is no viscosity; to push_.
    void push(std::span<const double> p) const {
        clear(of.push_, parts.scene.grid, parts.scene.halo.window());
        parts.pressure.apply(p, parts.dt, Pressure::Surface::relaxed, of.push_);
    }
    // y -= -G p, the forces of the pressures on faces and motions
    void subtract_forces(std::span<const double> p, std::span<double> y) const {
        push(p);
        const auto& viscous = parts.viscous;
        const double mass = inertia * face * face; // of a full cube over dt [kg/s]
        forces(parts.pressure.system().faces(), viscous.system().place_of(), viscous.system().faces(), mass, of.push_, of.faces_);
        const auto host = on_host(of.faces_);
        for (std::size_t r = 0; r < viscous.faces(); ++r) y[r] -= host(r);
        if (viscous.motions() == 0) return;
        const auto on_motions = viscous.forces(parts.pressure.loads(p));
        for (std::size_t r = viscous.faces(); r < n; ++r) y[r] -= on_motions[r - viscous.faces()];
    }
    void multiply(std::span<const double> x, std::span<double> y) const {
        parts.viscous.matrix().multiply(x.first(n), y.first(n));
        subtract_forces(x.last(m), y.first(n));
        flux(x.first(n), y.last(m));
    }
    // z_u = K^-1 r_u, z_p = S^-1 (G^T z_u - r_p) with approximate inverses; of S = G^T K^-1 G that of no viscosity and that
    // of viscosity alone, summed (Cahouet & Chabat 1988).
    void precondition(std::span<const double> r, std::span<double> z) const {
        parts.viscous.precondition(r.first(n), z.first(n));
        auto& t = of.scratch_;
        t.resize(m);
        flux(z.first(n), t);
        for (std::size_t k = 0; k < m; ++k) t[k] -= r[n + k];
        const auto p = z.last(m);
        parts.pressure.precondition(t, p);
        for (std::size_t k = 0; k < m; ++k) p[k] = inertia * p[k] + of.stiffness_[k] * t[k];
    }
};

Stokes::Stokes(const Comm& comm, const StokesOptions& options)
    : comm_(comm), options_(options), idr_(comm, idr_options(options)) {}

void Stokes::make_room(const Parts& parts) {
    const auto& window = parts.scene.halo.window();
    const std::size_t all = parts.viscous.rows() + parts.pressure.rows();
    for (auto* vector : {&b_, &x_, &weights_}) vector->assign(all, 0.0);
    stiffness_.resize(parts.pressure.rows());
    clear(velocity_, parts.scene.grid, window);
    clear(push_, parts.scene.grid, window);
    reserve(faces_, parts.viscous.faces());
    reserve(cells_, parts.pressure.rows());
}

// Residuals of forces count by the resistance of their face, of fluxes by what pressure they make: both are a power then,
// whatever the viscosity.
void Stokes::weigh(const System& system) {
    const auto& [of, parts, n, m, face, inertia] = system;
    Kokkos::parallel_for("treacle::stokes_stiffness", static_cast<int>(m),
                         StiffnessLoop{parts.viscous.places(), parts.pressure.system().faces(),
                                       parts.pressure.system().cell_of(), face, exact_share(parts.scene.grid.dimensions), cells_});
    const auto stiffness = on_host(cells_);
    std::copy_n(stiffness.data(), m, stiffness_.begin());
    const auto diagonal = [](const solve::CsrBlocks& rows, std::size_t r) {
        int k = rows.diagonal_offsets[r];
        while (rows.diagonal_columns[k] != static_cast<int>(r)) ++k;
        return rows.diagonal_values[k];
    };
    for (std::size_t r = 0; r < n; ++r) weights_[r] = 1 / diagonal(parts.viscous.matrix().blocks(), r);
    for (std::size_t r = 0; r < m; ++r) {
        weights_[n + r] = inertia / diagonal(parts.pressure.matrix().blocks(), r) + stiffness_[r];
    }
}

void Stokes::load(const System& system, const FaceField& velocity, const rigid::RigidBodies& bodies) {
    const auto& [of, parts, n, m, face, inertia] = system;
    const std::span<double> b(b_), x(x_);
    parts.viscous.right_hand_side(velocity, b.first(n));
    parts.pressure.coupling().add_flux(body_velocities(bodies), face, b.last(m));
    parts.pressure.add_inflow(face, b.last(m));
    parts.pressure.balance(b.last(m));
    parts.viscous.read(velocity, x.first(n));
}

// The velocities of before, unless nothing at all has the smaller residual: what is not smooth strains a stiff liquid.
void Stokes::choose_guess(const System& system) {
    residual_.resize(x_.size());
    system.multiply(x_, residual_);
    for (std::size_t k = 0; k < x_.size(); ++k) residual_[k] = b_[k] - residual_[k];
    if (!(idr_.norm(operator_, residual_) < idr_.norm(operator_, b_))) std::fill(x_.begin(), x_.end(), 0.0);
}

void Stokes::check(const solve::SolveReport& report, std::int64_t unknowns) const {
    if (report.outcome != solve::Outcome::non_finite && report.relative_residual <= most_residual) return;
    throw SimulationError({"method.stokes", report.reason,
                           "pressure and viscosity together have not been solved after " + std::to_string(report.iterations) +
                               " iterations on " + std::to_string(unknowns) + " unknowns",
                           "take a smaller time step, or solve: split"});
}

// (U)
StokesReport Stokes::solve(const Parts& parts, const FaceField& velocity, rigid::RigidBodies& bodies) {
    StokesReport report;
    report.unknowns = parts.viscous.global_faces() + parts.pressure.system().global_rows();
    make_room(parts);
    System system(*this, parts);
    const auto start = Clock::now();
    weigh(system);
    operator_ = {[&system](auto x, auto y) { system.multiply(x, y); }, [&system](auto r, auto z) { system.precondition(r, z); }, weights_};
    parts.pressure.set_up_preconditioner();
    parts.viscous.set_up_preconditioner();
    load(system, velocity, bodies);
    choose_guess(system);
    const double before = seconds_since(start);
    report.solve = idr_.solve(operator_, b_, x_, options_.residual);
    report.solve.set_up_seconds = before;
    operator_ = {};
    check(report.solve, report.unknowns);
    const auto x = std::span<const double>(x_);
    report.loads = parts.pressure.loads(x.last(system.m));
    report.viscous_loads = parts.viscous.apply(parts.scene, x.first(system.n), report.loads, velocity, bodies);
    parts.pressure.record(x.last(system.m));
    return report;
}

std::size_t Stokes::bytes() const {
    std::size_t numbers = faces_.span() + cells_.span();
    for (const auto* vector : {&b_, &x_, &weights_, &stiffness_, &scratch_, &residual_}) numbers += vector->capacity();
    for (int a = 0; a < 3; ++a) numbers += velocity_.axis[a].span() + push_.axis[a].span();
    return 8 * numbers + idr_.bytes();
}

} // namespace treacle::grid
