#pragma once
#include "grid/mac_grid.hpp"
#include "mpi/cell_halo.hpp"
#include "rigid/bodies.hpp"
#include "solve/krylov.hpp"

#include <array>
#include <memory>

namespace treacle::grid {

// How bodies and liquid feel each other's viscous forces (dissertation 5.3.4).
enum class ViscousCoupling {
    strong,  // the bodies' velocities are unknowns beside those of the faces
    weak,    // the liquid sees the bodies' motion as prescribed; its forces then move the bodies, implicit in their velocity
    one_way, // bodies feel nothing
};

enum class ViscousPreconditioner {
    rigid_multilevel, // solve/rigid_multilevel.hpp
    component_amg,    // one BoomerAMG for each component of the velocity
    jacobi,
    ic0,
    gamg, // PETSc's smoothed aggregation on the whole system
};

struct ViscosityOptions {
    ViscousPreconditioner preconditioner = ViscousPreconditioner::rigid_multilevel;
    ViscousCoupling coupling = ViscousCoupling::strong;
    double residual = 1e-8; // relative to the right-hand side
    int max_iterations = 1000;
    // Liquid of a smaller share of a cube than this is none: what clipping leaves of round-off.
    double least_wet = 1e-6;
    // A stress whose cube has a smaller share outside of solids than this stands for a layer too thin to slide: the faces
    // beside it move with the solid. The wall is so misplaced by at most this share of dx; stresses grow with its inverse.
    double least_gap = 0.01;
    // Slip surfaces resist flow across them as a layer of liquid of this thickness would, in dx: a penalty in their
    // viscosity's own unit.
    double normal_layer = 0.02;
};

// Dynamic viscosity [Pa s] at the centres of cells and at edges, over the window. Plane scenes use edges along z.
struct Viscosities {
    Array<double> cell;
    EdgeField edge;
};

// Solids along which the liquid slides. Without them all solids grip.
struct SlipSolids {
    Fractions grip;           // of the solids that grip alone: cell_fluid, face_fluid, edge_fluid, open
    Array<double> length;     // [window] slip length of the solid near the cell [m], infinity: none of its tangents holds
    Array<int> body;          // [window] its number in rigid::RigidBodies, -1: it rests
};

// What a solve is about. All arrays over the window of the halo, with valid values in all its cells.
struct ViscousScene {
    const MacGrid& grid;
    CellHalo& halo;
    const Fractions& fractions;
    const std::array<BodyShares, 3>& shares; // of the faces across each axis; of gripping bodies
    const Viscosities& viscosity;
    double density = 0; // [kg/m3]
    const SlipSolids* slip = nullptr;
};

struct ViscosityReport {
    solve::SolveReport solve;
    std::int64_t unknowns = 0; // faces, over all ranks
    std::int64_t entries = 0;
};

// One implicit step of viscosity (dissertation 5.3.1, 5.3.2, 5.3.4): the velocities u of the faces and V of the bodies make
//   sum m/(2 dt) (u - u*)^2 + (V - V*) M (V - V*)/(2 dt) + 1/2 sum w (D v)^2,   v = W_F u + sum_b W_S R V,
// least: v is the mean velocity of a face's cube, D v/W_F the mean strain of the part of a stress' cube outside of solids,
// which do not strain, and w = K (wet share)/W_F^2 dx^3, K = {2 eta, 2 eta, 2 eta, eta, eta, eta}. Tags: README.
class Viscosity {
public:
    Viscosity(const Comm& comm, ViscosityOptions options);
    ~Viscosity();
    Viscosity(Viscosity&&) noexcept;
    Viscosity& operator=(Viscosity&&) noexcept;

    // Collective. `velocity` [m/s] of owned faces with liquid, or beside such, becomes that after dt [s]; of faces held by a
    // solid the solid's. Halo faces are left to the caller. Bodies take their new velocities (rigid::RigidBodies::push).
    // SimulationError where the solve fails.
    ViscosityReport solve(const ViscousScene& scene, const FaceField& velocity, rigid::RigidBodies& bodies, double dt);

    // The matrix and right-hand side of the last solve, for measurements and tests; null before the first.
    solve::Matrix* matrix();
    std::span<const double> right_hand_side() const;

    std::size_t bytes() const; // what this rank holds
    const ViscosityOptions& options() const { return options_; }

private:
    struct State;
    Comm comm_;
    ViscosityOptions options_;
    std::unique_ptr<State> state_;
};

} // namespace treacle::grid
