#include "grid/unified/stokes.hpp"

#include "base/text/clock.hpp"
#include "base/text/error.hpp"
#include "grid/transport/face_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace treacle::grid {

namespace {
// Residual over the right-hand side up to which the step is accepted; the report has it.
constexpr double most_residual = 1e-2;
// Mean of the pressure that viscosity adds to a flux over that of inertia, from which the viscous cycle gets twice the sweeps:
// a fifth to a third fewer iterations then, each with its sums over the ranks, in the same time.
constexpr double stiff = 10;

solve::IdrOptions idr_options(const StokesOptions& options) {
    solve::IdrOptions out;
    out.max_iterations = options.max_iterations;
    return out;
}

} // namespace

void close_prescribed_faces(const ViscousFaces& viscous, const FaceField& open, FaceField& out) {
    for (int a = 0; a < viscous.dimensions; ++a) {
        const auto n = static_cast<std::size_t>(viscous.window.size());
        reserve(out.axis[a], n);
        const auto from = open.axis[a], to = out.axis[a];
        const auto role = viscous.role[a];
        Kokkos::parallel_for(
            "treacle::close_prescribed_faces", static_cast<int>(n),
            KOKKOS_LAMBDA(int i) { to(i) = role(i) == prescribed_face ? 0.0 : from(i); });
    }
}

// The products of the whole system; rows of the viscous system first, then those of the pressures.
struct Stokes::System {
    Stokes& of;
    const Parts& parts;
    std::size_t n, m;     // rows of velocities and motions, of pressures
    double face, inertia; // [m2]; [kg/(m s)], in 2D [m], [kg/(m2 s)]: pressures of the projection per flux

    System(Stokes& stokes, const Parts& given)
        : of(stokes), parts(given), n(given.viscous.rows()), m(given.pressure.rows()) {
        const auto& grid = given.scene.grid;
        face = std::pow(grid.dx, grid.dimensions - 1);
        inertia = given.scene.density / (given.dt * std::pow(grid.dx, grid.dimensions - 2));
    }

    // y = G^T x = -(A u + J L q) areas
    void flux(std::span<const double> x, std::span<double> y) const {
        of.pressed_.flux(x, y);
        if (parts.viscous.motions() == 0) return;
        parts.pressure.coupling().add_flux(parts.viscous.changes(parts.viscous.motions(x)), -face, y);
    }
    // y += G p, what the pressures hold against on faces and motions
    void add_forces(std::span<const double> p, std::span<double> y) const {
        const auto& viscous = parts.viscous;
        of.pressed_.add_forces(p, y);
        if (viscous.motions() == 0) return;
        const auto on_motions = viscous.forces(parts.pressure.loads(p));
        for (std::size_t r = viscous.faces(); r < n; ++r) y[r] -= on_motions[r - viscous.faces()];
    }
    void multiply(std::span<const double> x, std::span<double> y) const {
        parts.viscous.matrix().multiply(x.first(n), y.first(n));
        add_forces(x.last(m), y.first(n));
        flux(x.first(n), y.last(m));
    }
    // The step one after the other: z_u = K^-1 r_u, pressures t = L^-1 (G^T z_u - r_p) as of a liquid without viscosity, which
    // push the velocities, and z_p = t and what the viscosity adds (Cahouet & Chabard 1988; Griffith 2009). Inverses are
    // approximate. What t pushes the bodies is left out.
    void precondition(std::span<const double> r, std::span<double> z) const {
        parts.viscous.precondition(r.first(n), z.first(n));
        auto& t = of.scratch_;
        t.resize(m);
        flux(z.first(n), t);
        for (std::size_t k = 0; k < m; ++k) t[k] -= r[n + k];
        const auto p = z.last(m);
        parts.pressure.precondition(t, p);
        for (double& value : p) value *= inertia;
        of.pressed_.push(p, z.first(n));
        for (std::size_t k = 0; k < m; ++k) p[k] += of.stiffness_[k] * t[k];
    }
};

Stokes::Stokes(const Comm& comm, const StokesOptions& options)
    : comm_(comm), options_(options), idr_(comm, idr_options(options)) {}

// The matrix with the volumes that it holds, and what the products take.
void Stokes::build(const Parts& parts, const FaceField& velocity, const rigid::RigidBodies& bodies) {
    const auto& grid = parts.scene.grid;
    const double face = std::pow(grid.dx, grid.dimensions - 1);
    auto& system = parts.viscous.system();
    const auto& faces = parts.viscous.viscous_faces();
    system.find_flux(comm_, parts.scene.halo, faces, parts.pressure.system().faces(), parts.scene.slip);
    volumes_.find(parts.pressure, faces, system.flux(), bodies, parts.scene.halo, face);
    auto scene = parts.scene;
    scene.volumes = &volumes_.stiffness();
    parts.viscous.build(scene, velocity, bodies, parts.dt);
    pressed_.build(system, parts.pressure.system(), {face, parts.dt / (scene.density * grid.dx)});
    const std::size_t all = parts.viscous.rows() + parts.pressure.rows();
    for (auto* vector : {&b_, &x_, &weights_}) vector->assign(all, 0.0);
    stiffness_.resize(parts.pressure.rows());
}

// Residuals of forces count by the resistance of their face, of fluxes by what pressure they make: both are a power then,
// whatever the viscosity.
void Stokes::weigh(const System& system) {
    const auto& [of, parts, n, m, face, inertia] = system;
    const auto stiffness = on_host(volumes_.by_row());
    std::copy_n(stiffness.data(), m, stiffness_.begin());
    const auto volume_stiffness = on_host(volumes_.stiffness_by_row());
    volume_stiffness_.assign(volume_stiffness.data(), volume_stiffness.data() + m);
    const auto diagonal = [](const solve::Matrix& matrix, std::size_t r) {
        return matrix.blocks().diagonal(static_cast<solve::Index>(r));
    };
    for (std::size_t r = 0; r < n; ++r) weights_[r] = 1 / diagonal(parts.viscous.matrix(), r);
    for (std::size_t r = 0; r < m; ++r) {
        weights_[n + r] = inertia / diagonal(parts.pressure.matrix(), r) + stiffness_[r];
    }
}

// After weigh().
bool Stokes::is_stiff(const System& system) const {
    std::array<double, 2> sums{
        std::accumulate(stiffness_.begin(), stiffness_.end(), 0.0), system.inertia * double(system.m)};
    comm_.sum(sums);
    return sums[0] > stiff * sums[1];
}

void Stokes::load(const System& system, const FaceField& velocity, const rigid::RigidBodies& bodies) {
    const auto& [of, parts, n, m, face, inertia] = system;
    const std::span<double> b(b_), x(x_);
    parts.viscous.right_hand_side(velocity, b.first(n));
    parts.pressure.coupling().add_flux(body_velocities(bodies), face, b.last(m));
    parts.pressure.add_inflow(face, b.last(m));
    parts.pressure.balance(b.last(m));
    auto& volume_pressure = scratch_; // what the matrix's volumes have of it
    volume_pressure.resize(m);
    for (std::size_t k = 0; k < m; ++k) volume_pressure[k] = volume_stiffness_[k] * b[n + k];
    pressed_.add_forces(volume_pressure, b.first(n));
    parts.viscous.read(velocity, x.first(n));
}

// The velocities of before, unless nothing at all has the smaller residual: what is not smooth strains a high-viscosity liquid.
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
    const auto start = Clock::now();
    build(parts, velocity, bodies);
    System system(*this, parts);
    weigh(system);
    operator_ = {[&system](auto x, auto y) { system.multiply(x, y); },
        [&system](auto r, auto z) { system.precondition(r, z); }, weights_};
    parts.pressure.set_up_preconditioner();
    parts.viscous.set_up_preconditioner();
    parts.viscous.set_fine_sweeps(is_stiff(system) ? solve::FineSweeps::there_and_back : solve::FineSweeps::once);
    load(system, velocity, bodies);
    choose_guess(system);
    const double before = seconds_since(start);
    report.solve = idr_.solve(operator_, b_, x_, options_.residual);
    report.solve.set_up_seconds = before;
    operator_ = {};
    parts.viscous.set_fine_sweeps(solve::FineSweeps::once); // that of solves of the viscosity alone
    check(report.solve, report.unknowns);
    const auto x = std::span<const double>(x_);
    report.loads = parts.pressure.loads(x.last(system.m));
    report.viscous_loads = parts.viscous.apply(parts.scene, x.first(system.n), report.loads, velocity, bodies);
    parts.pressure.record(x.last(system.m));
    return report;
}

std::size_t Stokes::bytes() const {
    std::size_t numbers = 0;
    for (const auto* vector : {&b_, &x_, &weights_, &stiffness_, &volume_stiffness_, &scratch_, &residual_})
        numbers += vector->capacity();
    return 8 * numbers + idr_.bytes() + volumes_.bytes() + pressed_.bytes();
}

} // namespace treacle::grid
