#include "grid/grid_step.hpp"

// Solids at rest in a step: loads on them, and pressures beside them.
namespace treacle::grid {

// Before a viscous solve: faces in solids that liquid slides along are unknowns too, and those with small openings; what gravity
// made of these would drag the liquid down.
void GridStep::leave_solids(double dt) {
    follow_walls();
    extrapolate_velocity({false, {}, viscous_spread(dt), separation_.separated()});
    wall_momentum_.add(wall_scene(), WallMomentum::Which::closed, velocity_);
}

WallMomentum::Scene GridStep::wall_scene() {
    return {grid_, cells_halo_.owned(), pressure_.system().faces(), fractions_, resting_, setup_.density};
}

// (A7)
void GridStep::show_pressures() {
    const auto& g = setup_.domain.gravity;
    const double rho = setup_.density;
    wall_pressures_.find(
        {grid_, cells_halo_, pressure_.system(), solids_, pressure_.pressures(), {rho * g[0], rho * g[1], rho * g[2]}});
    pressures_to_particles(grid_, cells_halo_.window(), wall_pressures_.at_centres(), particles_);
}

// Loads by the pressures of all solves of the step on solids without a term in P2.
void GridStep::load_resting(StepReport& report, double dt, bool at_once) {
    auto walls = wall_scene();
    if (viscous()) walls.viscous = &viscosity_.problem().viscous_faces();
    walls.together = at_once;
    wall_momentum_.add(walls, WallMomentum::Which::closed, velocity_);
    const auto& system = pressure_.system();
    resting_pressures_.build(system, grid_, fractions_.face_fluid, resting_.body_fractions(), resting_.motion());
    const auto pressures = on_host(pressure_.pressures());
    const auto cell = on_host(system.cell_of());
    std::vector<double> of_rows(static_cast<std::size_t>(system.rows()));
    for (std::size_t r = 0; r < of_rows.size(); ++r) of_rows[r] = pressures(static_cast<std::size_t>(cell(r)));
    report.resting_loads = resting_pressures_.loads(comm_, of_rows);
    const auto loads = wall_momentum_.loads(comm_, dt);
    for (std::size_t k = 0; k < loads.size(); ++k) report.resting_loads[k] += loads[k];
    report.resting_viscous_loads.assign(report.resting_loads.size(), 0.0);
    if (viscous()) report.resting_viscous_loads = viscosity_.problem().resting_loads();
    resting_.about_origin(report.resting_loads);
    resting_.about_origin(report.resting_viscous_loads);
}

} // namespace treacle::grid
