#include "grid/pressure/pressure.hpp"

#include "base/text/error.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace treacle::grid {

namespace {
solve::Preconditioner translate(Preconditioner kind) {
    switch (kind) {
    case Preconditioner::boomeramg: return solve::Preconditioner::boomeramg;
    case Preconditioner::gamg: return solve::Preconditioner::gamg;
    case Preconditioner::incomplete_cholesky: return solve::Preconditioner::ic0;
    case Preconditioner::jacobi: return solve::Preconditioner::jacobi;
    case Preconditioner::multilevel: break; // called by the solver for the hierarchy
    }
    return solve::Preconditioner::ic0;
}
} // namespace

Pressure::Pressure(const Comm& comm, const PressureOptions& options, Coupling coupling, int dimensions)
    : comm_(comm), options_(options), coupling_kind_(coupling),
      multilevel_(
          comm, {.smoother = options.smoother, .overcorrection = 1.75, .relaxation = 1.2, .interface_sweeps = true}),
      solver_(comm, "pressure", krylov(dimensions)) {}

solve::KrylovOptions Pressure::krylov(int dimensions) {
    solve::KrylovOptions out;
    out.preconditioner = translate(options_.preconditioner);
    out.max_iterations = options_.max_iterations;
    out.strong_threshold = dimensions == 3 ? 0.5 : 0.25;
    if (options_.preconditioner == Preconditioner::multilevel) {
        out.user = {[this](std::span<const double> r, std::span<double> z) { multilevel_.apply(r, z); },
            [this](solve::Matrix& matrix) {
                const auto cells = system_.aggregates();
                solve::MultilevelCells where;
                where.cells = cells;
                multilevel_.set_up(matrix, where);
            }};
    }
    return out;
}

// sigma kappa
void Pressure::compute_jumps(const PressureContext& scene) {
    const CellBox window = scene.halo.window();
    reserve(jump_, static_cast<std::size_t>(window.size()));
    const auto curvature = *scene.curvature, jump = jump_;
    const bool differ = scene.tensions != nullptr;
    const auto tensions = differ ? *scene.tensions : Array<double>();
    const double tension = scene.surface_tension;
    Kokkos::parallel_for(
        "treacle::surface_tension", static_cast<int>(window.size()),
        KOKKOS_LAMBDA(int i) { jump(i) = (differ ? tensions(i) : tension) * curvature(i); });
}

PressureFaces Pressure::describe(const PressureContext& scene) const {
    auto faces = pressure_faces(scene.halo.window(), scene.grid.dimensions);
    faces.area = scene.open ? *scene.open : scene.fractions.open;
    faces.distance = scene.distance;
    faces.min_theta = options_.min_theta;
    faces.min_face_area_fraction = options_.min_face_area_fraction;
    return faces;
}

// (P1)-(P3)
void Pressure::build(const PressureContext& scene, bool goes_on) {
    grid_ = &scene.grid;
    halo_ = &scene.halo;
    density_ = scene.density;
    auto faces = describe(scene);
    faces.has_jump = scene.surface_tension > 0 && scene.curvature;
    if (faces.has_jump) compute_jumps(scene);
    faces.jump = jump_;
    inflow_ = scene.inflow ? *scene.inflow : Array<double>();
    matrix_.reset();
    system_.assemble(comm_, scene.halo, faces);
    update_motion(scene.bodies, scene.grid, motion_);
    coupling_.build(system_, scene.grid, scene.fractions.face_fluid, scene.body_fractions, motion_, scene.slip);
    host_ = system_.to_host();
    const auto blocks = system_.blocks(host_);
    const auto rows = static_cast<std::size_t>(system_.rows());
    components_.anchor(comm_, blocks, {host_.dirichlet_diagonal.data(), rows}, coupling_, scene.bodies);
    matrix_.emplace(comm_, blocks);
    const bool strong = coupling_kind_ == Coupling::strong && scene.bodies.any_dynamic();
    if (strong) mobility_ = scene.bodies.mobility();
    const double mass = density_ * std::pow(scene.grid.dx, scene.grid.dimensions);
    matrix_->set_matrix_free_term([this, strong, mass](std::span<const double> x, std::span<double> y) {
        if (strong) coupling_.add_response(comm_, mobility_, mass, x, y);
        for (const auto& [row, value] : components_.unpinned()) {
            y[static_cast<std::size_t>(row)] -= value * x[static_cast<std::size_t>(row)];
        }
    });
    if (!goes_on) least_residual_ = 0;
    const auto window_size = static_cast<std::size_t>(scene.halo.window().size());
    reserve(right_hand_side_, rows);
    reserve(solution_, rows);
    reserve(in_cells_, window_size);
    reserve(pressures_, window_size);
    if (!goes_on) Kokkos::deep_copy(pressures_, 0.0);
}

solve::SolveReport Pressure::solve(std::span<double> b, std::span<double> x) {
    double norm = 0;
    for (const double value : b) norm += value * value;
    // The second projection of a step need not be more accurate than the first.
    least_residual_ = std::max(least_residual_, options_.residual * std::sqrt(comm_.sum(norm)));
    std::fill(x.begin(), x.end(), 0.0);
    auto report = solver_.solve(*matrix_, b, x, solve::ConvergenceTest::residual(options_.residual, least_residual_));
    if (report.converged()) return report;
    throw SimulationError({"pressure solve", report.reason,
        "after " + std::to_string(report.iterations) + " iterations on " + std::to_string(system_.global_rows()) +
            " unknowns",
        "take a smaller time step, or another method.pressure.preconditioner"});
}

void Pressure::collect(const Array<double>& cells, double factor) {
    const auto sum = pressures_;
    const auto window = halo_->window(), owned = halo_->owned();
    Kokkos::parallel_for(
        "treacle::sum_pressures", static_cast<int>(owned.size()), KOKKOS_LAMBDA(int i) {
            int c[3];
            owned.cell(i, c);
            const int at = window.index(c[0], c[1], c[2]);
            sum(at) += factor * cells(at);
        });
}

void Pressure::apply(std::span<const double> p, double dt, SurfaceTension surface, const FaceField& velocity) {
    const auto host = Kokkos::create_mirror_view(solution_);
    std::copy(p.begin(), p.end(), host.data());
    Kokkos::deep_copy(solution_, host);
    system_.to_cells(solution_, in_cells_);
    halo_->gather({in_cells_});
    auto faces = system_.faces();
    faces.has_jump = faces.has_jump && surface == SurfaceTension::include;
    subtract_gradient(faces, halo_->owned(), in_cells_, density_ * grid_->dx / dt, velocity);
}

// (P4)
PressureReport Pressure::project(
    const FaceField& velocity, rigid::RigidBodies& bodies, double dt, SurfaceTension surface) {
    PressureReport report;
    report.unknowns = system_.global_rows();
    report.closed = components_.closed();
    const double scale = density_ * grid_->dx / dt;
    auto faces = system_.faces();
    faces.has_jump = faces.has_jump && surface == SurfaceTension::include;
    divergence(faces, system_, velocity, scale, right_hand_side_);
    update_motion(bodies, *grid_, motion_);
    coupling_.subtract_flux(motion_, scale, right_hand_side_);

    const auto b = on_host(right_hand_side_);
    add_inflow(-scale, {b.data(), rows()});
    found_.resize(rows());
    report.incompatible_fraction = components_.balance(comm_, {b.data(), rows()});
    report.solve = solve({b.data(), rows()}, found_);
    report.loads = coupling_.loads(comm_, found_);
    if (coupling_kind_ != Coupling::one_way && bodies.any_dynamic()) bodies.push(report.loads, dt);
    apply(found_, dt, surface, velocity);
    collect(in_cells_);
    return report;
}

void Pressure::flux(const FaceField& velocity, std::span<double> out) {
    auto faces = system_.faces();
    faces.has_jump = false;
    divergence(faces, system_, velocity, 1, right_hand_side_);
    const auto host = on_host(right_hand_side_);
    std::copy_n(host.data(), rows(), out.begin());
}

void Pressure::add_inflow(double factor, std::span<double> out) const {
    if (inflow_.extent(0) == 0) return;
    const auto inflow = on_host(inflow_);
    const auto cell = on_host(system_.cell_of());
    for (std::size_t r = 0; r < out.size(); ++r) out[r] += factor * inflow(static_cast<std::size_t>(cell(r)));
}

void Pressure::record(std::span<const double> p) {
    const auto host = Kokkos::create_mirror_view(solution_);
    std::copy(p.begin(), p.end(), host.data());
    Kokkos::deep_copy(solution_, host);
    system_.to_cells(solution_, in_cells_);
    collect(in_cells_);
}

std::size_t Pressure::bytes() const {
    return system_.bytes() + coupling_.bytes() + multilevel_.bytes() +
           8 * (jump_.span() + right_hand_side_.span() + solution_.span() + in_cells_.span() + pressures_.span() +
                   found_.capacity());
}

} // namespace treacle::grid
