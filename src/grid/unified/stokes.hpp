#pragma once
#include "grid/pressure/pressure.hpp"
#include "grid/unified/pressed_faces.hpp"
#include "grid/unified/stokes_options.hpp"
#include "grid/viscosity/viscous_problem.hpp"
#include "solve/krylov/idr.hpp"

#include <span>
#include <vector>

namespace treacle::grid {

// Result of a solve of both together.
struct StokesReport {
    solve::SolveReport solve;  // its residual is the weighted one of both equations (src/grid/theory.md)
    std::int64_t unknowns = 0; // faces and pressures, over all ranks
    std::vector<double> loads,
        viscous_loads; // by the pressure of this solve, by viscosity; 6 numbers a body [N], [N m]
};

// One step of unsteady Stokes flow (U): pressure and viscosity act together on the velocities u of the faces and the motions
// q of the bodies,
//     [ K   G ] [u, q]   [ M w/dt ]
//     [ G^T 0 ] [ p  ] = [  J V   ]
// with the matrix K of the viscous step (viscous_problem.hpp) and the divergence of the projection: of the velocities that
// have none, those that make least what the viscous step alone makes least. They come after the projection (P), whose w
// has the pressure that would be there without viscosity, such as that at rest; p is the rest of it.
class Stokes {
public:
    Stokes(const Comm& comm, const StokesOptions& options);

    // Both for the same faces (ViscousScene::pressure_faces, close_held_faces): the pressure's built, of the viscous one the places.
    struct Parts {
        Pressure& pressure;
        ViscousProblem& viscous;
        const ViscousScene& scene;
        double dt; // [s]
    };
    // Collective. `velocity` [m/s] becomes that after dt; halo faces are left to the caller. Bodies are pushed. Adds to the
    // pressures of the step. SimulationError where there is no solution.
    StokesReport solve(const Parts& parts, const FaceField& velocity, rigid::RigidBodies& bodies);

    std::size_t bytes() const; // of this rank [bytes]

private:
    struct System;
    void build(const Parts& parts, const FaceField& velocity, const rigid::RigidBodies& bodies);
    void weigh(const System& system);
    bool is_stiff(const System& system) const; // collective
    void load(const System& system, const FaceField& velocity, const rigid::RigidBodies& bodies);
    void choose_guess(const System& system);
    void check(const solve::SolveReport& report, std::int64_t unknowns) const;

    Comm comm_;
    StokesOptions options_;
    solve::Idr idr_;
    solve::Operator operator_;
    VolumeStresses volumes_;
    PressedFaces pressed_;
    std::vector<double> b_, x_, weights_, stiffness_, volume_stiffness_, scratch_, residual_;
};

// The areas that the pressure acts through where it acts together with the viscosity: none of faces that a solid takes along.
void close_prescribed_faces(const ViscousFaces& viscous, const FaceField& open, FaceField& out);

} // namespace treacle::grid
