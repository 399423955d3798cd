#pragma once
#include "grid/pressure/pressure_components.hpp"
#include "grid/pressure/pressure_options.hpp"
#include "solve/krylov/krylov.hpp"

#include <optional>

namespace treacle::grid {

// Input of a pressure solve; arrays over the window of the halo, current one cell around the owned ones.
struct PressureContext {
    const MacGrid& grid;
    CellHalo& halo;
    const Array<double>& distance;           // [m] of cell centres from the liquid's surface, < 0 inside
    const Fractions& fractions;              // open, face_fluid
    const FaceBodyFractions& body_fractions; // not used without bodies
    const rigid::RigidBodies& bodies;
    double density = 0;                      // [kg/m3]
    double surface_tension = 0;              // [N/m]
    const Array<double>* tensions = nullptr; // [window] at centres [N/m], where liquids differ in theirs
    const FaceField* open = nullptr;         // in the place of that of the fractions
    SlipAreas slip;                          // of bodies that liquid slides along
    const Array<double>* inflow =
        nullptr; // [window] what must flow into owned cells, over a face's area (density_relaxation.hpp) [m/s]
    const Array<double>* curvature = nullptr; // [window] of the surface at centres [1/m]; none: no surface tension acts
};

// Result of one projection, the same on every rank, its seconds aside.
struct PressureReport {
    solve::SolveReport solve;
    std::int64_t unknowns = 0;        // over all ranks
    int closed = 0;                   // parts of the liquid that no surface ends
    double incompatible_fraction = 0; // largest share of the fluxes into one of them that had to be left out
    std::vector<double> loads;        // on the bodies, 6 numbers each [N], [N m]
};

// The projection of velocities onto those without divergence (src/grid/theory.md). build() once a step, project() after every
// change of the velocities.
class Pressure {
public:
    Pressure(const Comm& comm, const PressureOptions& options, Coupling coupling, int dimensions);

    // Collective: the matrix, for the liquid, solids and bodies where they are. With `goes_on` the pressures so far stay.
    void build(const PressureContext& scene, bool goes_on = false);

    enum class SurfaceTension { include, omit }; // the pressure of surface tension acts, or has acted already
    // Collective. Velocities must be current one cell around the owned ones, and only those of owned faces are written.
    // Pushes the bodies, by the kind of coupling. Adds to pressures(). SimulationError when the solve fails.
    PressureReport project(const FaceField& velocity, rigid::RigidBodies& bodies, double dt,
        SurfaceTension surface = SurfaceTension::include);

    // Parts of project(), for a solve together with the viscosity (stokes.hpp); spans are [rows()]. Collective, but for
    // those with that option. The faces that scene() describes; local.
    PressureFaces describe(const PressureContext& scene) const;
    // velocity -= dt/(rho dx) (p_c - p_below), as project() does.
    void apply(std::span<const double> p, double dt, SurfaceTension surface, const FaceField& velocity);
    std::vector<double> loads(std::span<const double> p) const { return coupling_.loads(comm_, p); }
    // Negative of what the velocities lead out of each cell, without the bodies, in face areas [m/s]. Local.
    void flux(const FaceField& velocity, std::span<double> out);
    // out += factor times what must flow into each cell, in face areas [m/s]. Local.
    void add_inflow(double factor, std::span<double> out) const;
    double balance(std::span<double> b) const { return components_.balance(comm_, b); }
    void set_up_preconditioner() { solver_.set_up(*matrix_); }
    void precondition(std::span<const double> r, std::span<double> z) { solver_.precondition(r, z); }
    // Takes the pressures of the last project() off of pressures() again.
    void take_back() { collect(in_cells_, -1); }
    // Pressures of the last project(), [window], in owned cells.
    const Array<double>& last() const { return in_cells_; }
    // Adds to pressures().
    void record(std::span<const double> p);
    const PressureCoupling& coupling() const { return coupling_; }
    std::size_t rows() const { return static_cast<std::size_t>(system_.rows()); }

    // [window] sum of the step's pressures at the centres [Pa], 0 outside of the liquid; of owned cells.
    const Array<double>& pressures() const { return pressures_; }
    const PressureSystem& system() const { return system_; }
    PressureSystem& system() { return system_; }
    const PressureComponents& components() const { return components_; }
    solve::Matrix& matrix() { return *matrix_; }
    std::size_t bytes() const;

    // Parts of the above; not private, since nvcc takes no kernel in a private function.
    void compute_jumps(const PressureContext& scene);
    void collect(const Array<double>& cells, double factor = 1);

private:
    solve::KrylovOptions krylov(int dimensions);
    solve::SolveReport solve(std::span<double> b, std::span<double> x);

    Comm comm_;
    PressureOptions options_;
    Coupling coupling_kind_;
    solve::Multilevel multilevel_;
    solve::KrylovSolver solver_;
    PressureSystem system_;
    PressureSystem::Host host_;
    PressureCoupling coupling_;
    PressureComponents components_;
    std::optional<solve::Matrix> matrix_;
    rigid::ConstrainedInverseMass mobility_;
    BodyMotion motion_;
    const MacGrid* grid_ = nullptr;
    CellHalo* halo_ = nullptr;
    double density_ = 0, least_residual_ = 0;
    Array<double> jump_{"treacle::pressure_jump", 0};
    Array<double> inflow_; // of the scene, or none
    Array<double> right_hand_side_{"treacle::pressure_source", 0};
    Array<double> solution_{"treacle::pressure_solution", 0};
    Array<double> in_cells_{"treacle::pressure_found", 0};
    std::vector<double> found_;
    Array<double> pressures_{"treacle::pressures", 0};
};

} // namespace treacle::grid
