#pragma once
#include "grid/mac/fine_nodes.hpp"
#include "grid/mac/mac_grid.hpp"
#include "grid/viscosity/viscosity_options.hpp"
#include "grid/viscosity/volume_stiffness.hpp"
#include "mpi/cell_halo.hpp"
#include "rigid/bodies.hpp"
#include "solve/krylov/krylov.hpp"

#include <array>
#include <memory>
#include <vector>

namespace treacle::grid {

class StepStrains;
class RestingSolids;

// Dynamic viscosity [Pa s] at the centres of cells and at edges, over the window. 2D scenes use edges along z.
struct Viscosities {
    Array<double> cell; // [window]
    EdgeField edge;
};

// Solids along which the liquid slides. Without them all solids are no-slip ones.
struct SlipSolids {
    bool slides[6] = {false, false, false, false, false, false}; // sides of the domain, -x, +x, -y, ...
    double side[6] = {0, 0, 0, 0, 0, 0};                         // their positions along their axes [m]
    Fractions no_slip_fractions; // of the no-slip solids alone: cell_fluid, face_fluid, edge_fluid, open
    Array<double> length;   // [window] slip length of the solid near the cell [m], infinity: all its tangents are free
    Array<int> body;        // [window] its number, Solids::number: < 0 no body
    Array<double> distance; // [window] of the cells' centres from the nearest solid, < 0 in it [m]
    Array<double> closed_centre[3][2]; // ClosedCentres::offset(axis, k), of all solids
};

// Input of a solve. All arrays over the window of the halo, with valid values in all its cells.
struct ViscousScene {
    const MacGrid& grid;
    CellHalo& halo;
    const Fractions& fractions;
    const std::array<BodyFractions, 3>& body_fractions; // of the faces across each axis; of no-slip bodies
    const Viscosities& viscosity;
    double density = 0; // [kg/m3]
    const SlipSolids* slip = nullptr;
    // Faces of the pressure when it acts in the same solve: all faces that it pushes are unknowns. Those without liquid
    // have the mass of the projection, and those that it does not push none, since nothing holds it against gravity.
    const PressureFaces* pressure_faces = nullptr;
    const StepStrains* strains = nullptr; // in a step of particles along straight lines
    // [m] of cells' centres from the liquid's surface, where a pressure acts before or with the solve: it holds the liquid
    // within to the normal velocity of what it slides along.
    const Array<double>* distance = nullptr;
    const RestingSolids* resting = nullptr;   // the no-slip ones; then there are loads on all solids at rest
    DistanceSampler no_slip{};                // of the no-slip solids; empty: V2 goes by the volume fractions alone
    const VolumeStiffness* volumes = nullptr; // adds to the matrix where the pressure acts in the same solve
};

// Result of one solve, the same on every rank, its seconds aside.
struct ViscosityReport {
    solve::SolveReport solve;
    std::int64_t unknowns = 0; // faces, over all ranks
    std::int64_t entries = 0;  // stored in the matrix, over all ranks
    std::vector<double> loads; // on bodies that move, 6 numbers each [N], [N m]
};

class ViscousProblem;

// One implicit step of viscosity (dissertation 5.3.1, 5.3.2, 5.3.4): the velocities u of the faces and V of the bodies make
//   sum m/(2 dt) (u - u*)^2 + (V - V*) M (V - V*)/(2 dt) + 1/2 sum w (D v)^2,   v = W_F u + sum_b W_S R V,
// least: v is the mean velocity of a face's cube, D v/W_F the mean strain of the part of a stress' cube outside of solids,
// which do not strain, and w = K (wet share)/W_F^2 dx^3, K = {2 eta, 2 eta, 2 eta, eta, eta, eta}. Tags: viscosity.md.
class Viscosity {
public:
    Viscosity(const Comm& comm, ViscosityOptions options, Coupling coupling);
    ~Viscosity();
    Viscosity(const Viscosity&) = delete; // its state refers to it
    Viscosity& operator=(const Viscosity&) = delete;

    // Collective. `velocity` [m/s] of owned faces with liquid, or beside such, becomes that after dt [s]; of faces held by a
    // solid the solid's. Halo faces are left to the caller. Bodies take their new velocities (rigid::RigidBodies::push).
    // SimulationError where the solve fails.
    ViscosityReport solve(const ViscousScene& scene, const FaceField& velocity, rigid::RigidBodies& bodies, double dt);

    // For a solve of the viscosity together with the pressure (stokes.hpp).
    ViscousProblem& problem();

    // The matrix and right-hand side of the last solve, for measurements and tests; null before the first.
    solve::Matrix* matrix();
    std::span<const double> right_hand_side() const;

    std::size_t bytes() const;                                   // what this rank holds
    const ViscosityOptions& options() const { return options_; } // as given to the constructor

private:
    struct State;
    Comm comm_;
    ViscosityOptions options_;
    std::unique_ptr<State> state_;
};

} // namespace treacle::grid
