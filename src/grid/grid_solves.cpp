#include "grid/grid_step.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>

// The solves of a step: of pressures and viscous stresses, one after the other or together.
namespace treacle::grid {

namespace {
constexpr double min_liquid_fraction = 1e-3; // share of a face's cube from which its velocity is that of liquid
constexpr int most_closings = 4;             // times that gaps that close are solved for
constexpr int most_separations = 4;          // times that liquid which separates is solved for

void add_cost(const solve::SolveReport& of, solve::SolveReport& to) {
    to.iterations += of.iterations;
    to.products += of.products;
    to.set_up_seconds += of.set_up_seconds;
    to.iteration_seconds += of.iteration_seconds;
}
} // namespace

void GridStep::project(StepReport& report, double dt, Pressure::SurfaceTension surface) {
    follow_walls();
    auto found = pressure_.project(velocity_, bodies_, dt, surface);
    wall_momentum_.add(wall_scene(), WallMomentum::Which::with_pressure, velocity_);
    gather_faces(grid_, cells_halo_, velocity_);
    if (surface == Pressure::SurfaceTension::include) {
        report.pressure = std::move(found);
        report.loads = report.pressure.loads;
        return;
    }
    add_cost(found.solve, report.pressure.solve);
    for (std::size_t k = 0; k < report.loads.size(); ++k) report.loads[k] += found.loads[k];
}

// (R1), (R2): by what the particles brought along, which gravity and pressure have not changed yet.
void GridStep::find_viscosities_by_rate() {
    const bool slides = slip_.any();
    const StrainContext scene{grid_, cells_halo_, fractions_, slides ? slip_.slip().no_slip_fractions : fractions_,
        slides ? slip_.body_fractions() : body_fractions_, solids_.motion(), setup_.options.viscosity, &strains_,
        dt_ > 0 ? before_ / dt_ : 0.0, no_slip().any_moves() ? &no_slip() : nullptr};
    halo_.gather(particles_.store, {particles_.viscosity_field()});
    rheology_.compute_rates(scene, start_);
    rheology_.find_viscosities(scene, {particles_, cells_, particle_mass_}, viscosities_);
    rheology_.to_particles(scene, particles_);
}

void GridStep::find_viscosities() {
    if (rheology_.any()) {
        find_viscosities_by_rate();
        return;
    }
    const auto& window = cells_halo_.window();
    const auto n = static_cast<std::size_t>(window.size());
    if (setup_.viscosity_varies) {
        halo_.gather(particles_.store, {particles_.viscosity_field()});
        harmonic_viscosities(
            grid_, {particles_, cells_, particle_mass_}, window, viscosities_.cell, viscosities_.edge); // (R3)
        auto& edge = viscosities_.edge.axis;
        if (grid_.dimensions == 2) {
            cells_halo_.gather({viscosities_.cell, edge[2]});
        } else {
            cells_halo_.gather({viscosities_.cell, edge[0], edge[1], edge[2]});
        }
        return;
    }
    for (auto* array :
        {&viscosities_.cell, &viscosities_.edge.axis[0], &viscosities_.edge.axis[1], &viscosities_.edge.axis[2]}) {
        if (array->extent(0) >= n && n > 0) continue;
        reserve(*array, n);
        Kokkos::deep_copy(*array, setup_.viscosity);
    }
}

ViscousScene GridStep::viscous_scene() {
    const bool slides = slip_.any();
    if (slides) {
        slip_.update(cells_halo_, bodies_, solids_, closed_centres_, level_set_, setup_.options.fractions);
        no_slip_.find(slip_.no_slip(), slip_.no_slip_fractions(), bodies_);
    }
    find_viscosities();
    return {grid_, cells_halo_, fractions_, slides ? slip_.body_fractions() : body_fractions_, viscosities_,
        setup_.density, slides ? &slip_.slip() : nullptr, nullptr, &strains_, &distance_, &no_slip(),
        (slides ? slip_.no_slip() : solids_).sampler()};
}

SlipAreas GridStep::slip_areas() const {
    if (!bodies_.any_moves() || !slip_.any()) return {};
    return {&closed_centres_, slip_.lengths()};
}

PressureContext GridStep::pressure_context() {
    return {grid_, cells_halo_, distance_, fractions_, body_fractions_, bodies_, setup_.density, tensions_.largest(),
        tensions_.differ() ? &tensions_.at_centres() : nullptr, nullptr, slip_areas(), &inflow_,
        &curvature_.at_centres()};
}

// (V)
void GridStep::apply_viscosity(StepReport& report, double dt) {
    if (!viscous()) return;
    const auto scene = viscous_scene();
    leave_solids(dt);
    report.viscosity = viscosity_.solve(scene, velocity_, bodies_, dt);
    report.viscous_loads = report.viscosity.loads;
    // Faces that hardly any liquid reaches have stresses and no mass: what the solve leaves there is arbitrary.
    mark_faces(grid_, cells_halo_.window(), fractions_.face_liquid_clipped, min_liquid_fraction, known_);
    extrapolate(grid_, cells_halo_, velocity_, known_, 2);
    follow_walls();
}

// True when the set of gaps that close has changed by the last solve, or by the first one, in which all were open.
bool GridStep::gaps_change(bool first) {
    const Closing::Scene scene{grid_, cells_halo_, cells_, fractions_, solids_, pressure_.describe(pressure_context()),
        velocity_, distance_, slip_areas()};
    const bool released = !first && closing_.release(comm_, scene, pressure_.last());
    return closing_.find(comm_, scene, dt_) || released;
}

// Keeps what a solve begins with, or goes back to.
void GridStep::keep_start(const StepReport& report) {
    copy_faces(grid_, cells_halo_.window(), velocity_, open_velocity_);
    open_bodies_ = bodies_.snapshot();
    open_loads_ = report.loads;
    open_walls_ = wall_momentum_.lost();
}

void GridStep::go_back(StepReport& report) {
    copy_faces(grid_, cells_halo_.window(), open_velocity_, velocity_);
    bodies_.go_back(open_bodies_);
    report.loads = open_loads_;
    wall_momentum_.go_back(open_walls_);
    pressure_.take_back();
}

// Separation from walls above after the first projection of a step; returns whether any cell separates anew. Collective.
bool GridStep::separates() {
    return separation_.find(comm_, {cells_halo_, pressure_.system(), pressure_.pressures(), distance_,
                                       pressure_.components().closed_rows(), setup_.domain.gravity, grid_.dx});
}

// (P), (L)
void GridStep::project_first(StepReport& report, double dt) {
    if (setup_.options.pressure.ceilings == Ceilings::adhere || !(scene::length(setup_.domain.gravity) > 0)) {
        project(report, dt, Pressure::SurfaceTension::include);
        return;
    }
    keep_start(report);
    project(report, dt, Pressure::SurfaceTension::include);
    for (int pass = 1; pass <= most_separations && separates(); ++pass) {
        go_back(report);
        pressure_.build(pressure_context());
        const auto before = report.pressure.solve;
        project(report, dt, Pressure::SurfaceTension::include);
        add_cost(before, report.pressure.solve);
    }
}

// (K): from the velocities of the last projection, whose matrix is that of open gaps, with gaps that close, as often as others
// are found.
void GridStep::close_gaps(StepReport& report, double dt) {
    extrapolate_velocity({false, {}, viscous() ? viscous_spread(dt) : DiffusionNumber{}, separation_.separated()});
    if (!gaps_change(true)) return;
    wall_momentum_.add(wall_scene(), WallMomentum::Which::closed, velocity_);
    keep_start(report);
    for (int pass = 1;; ++pass) {
        find_inflow(fractions_.open);
        pressure_.build(pressure_context(), true);
        project(report, dt, Pressure::SurfaceTension::omit);
        if (pass == most_closings || !gaps_change(false)) return;
        go_back(report);
    }
}

// (P), (L), (V), (P) again, (K)
void GridStep::split(StepReport& report, double dt) {
    const bool again = viscous() && setup_.options.second_projection;
    {
        const auto phase = timers_.scope("pressure");
        pressure_.build(pressure_context());
        project_first(report, dt);
        if (!again) close_gaps(report, dt);
    }
    {
        const auto phase = timers_.scope("viscosity");
        apply_viscosity(report, dt);
    }
    if (again) {
        const auto phase = timers_.scope("pressure");
        project(report, dt, Pressure::SurfaceTension::omit);
        close_gaps(report, dt);
    }
}

// Collective [Pa s]. By shear rates: that of the step before.
double GridStep::largest_viscosity() const {
    if (!setup_.viscosity_varies && !rheology_.any()) return setup_.viscosity;
    const auto viscosity = particles_.viscosity();
    double most = 0;
    Kokkos::parallel_reduce(
        "treacle::largest_viscosity", particles_.store.owned(),
        KOKKOS_LAMBDA(int i, double& value) { value = math::max(value, viscosity(i)); }, Kokkos::Max<double>(most));
    return comm_.max(particles_.store.owned() > 0 ? most : 0.0);
}

bool GridStep::solves_monolithic(double dt) const {
    const auto solve = setup_.options.stokes.solve;
    if (!viscous() || solve == StokesSolve::split) return false;
    if (solve == StokesSolve::together) return true;
    constexpr double spread = 0.1; // of nu dt over dx^2, from which the splitting error is significant
    return setup_.options.second_projection && largest_viscosity() * dt > spread * setup_.density * grid_.dx * grid_.dx;
}

// (P), (U)
void GridStep::together(StepReport& report, double dt) {
    auto scene = viscous_scene();
    const auto pressure_faces = pressure_.describe(pressure_context());
    scene.pressure_faces = &pressure_faces;
    auto& problem = viscosity_.problem();
    {
        const auto phase = timers_.scope("pressure");
        problem.update_faces(scene, bodies_, dt);
        close_prescribed_faces(problem.viscous_faces(), fractions_.open, open_);
        find_inflow(open_);
        auto closed = pressure_context();
        closed.open = &open_;
        pressure_.build(closed);
        project(report, dt, Pressure::SurfaceTension::include);
    }
    const auto phase = timers_.scope("viscosity");
    leave_solids(dt);
    follow_walls();
    report.stokes = stokes_.solve({pressure_, problem, scene, dt}, velocity_, bodies_);
    gather_faces(grid_, cells_halo_, velocity_);
    for (std::size_t k = 0; k < report.loads.size(); ++k) report.loads[k] += report.stokes.loads[k];
    report.viscous_loads = report.stokes.viscous_loads;
    report.viscosity.unknowns = problem.global_faces();
}

// Velocities beyond the liquid's own faces, as far as particles may come in a step.
void GridStep::extrapolate_velocity(const WallCondition& condition) {
    const auto faces = pressure_.describe(pressure_context());
    const FaceScene scene{grid_, cells_halo_, faces};
    mark_valid_faces(
        faces, {fractions_.face_liquid_clipped, min_liquid_fraction}, condition.viscosity, grid_.dx, known_);
    extrapolate_increment(scene, {start_, mass_, scratch_, extrapolated_}, known_, velocity_); // (A6)
    const int layers = static_cast<int>(std::ceil(setup_.options.cfl)) + 1;
    extrapolate(grid_, cells_halo_, velocity_, known_, layers);
    enforce_wall_velocity(scene, solids_, condition, velocity_, scratch_); // (A2)
}

} // namespace treacle::grid
