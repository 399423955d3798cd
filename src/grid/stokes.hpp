#pragma once
#include "grid/pressure.hpp"
#include "grid/viscous_problem.hpp"
#include "solve/gmres.hpp"

#include <span>
#include <vector>

namespace treacle::grid {

struct StokesReport {
    solve::SolveReport solve;   // its residual is the weighted one of both equations (README.md)
    PressureReport pressure;    // what found the guess; loads by pressure
    std::int64_t unknowns = 0;  // faces and pressures, over all ranks
    std::vector<double> viscous_loads; // on dynamic bodies, 6 numbers each [N], [N m]
};

// One step of unsteady Stokes flow (U): pressure and viscosity act together on the velocities u of the faces and the motions
// q of the bodies,
//     [ K   G ] [u, q]   [ M w*/dt ]
//     [ G^T 0 ] [ p  ] = [  J V*   ]
// with the matrix K of the viscous step (viscous_problem.hpp) and the gradient and divergence of the projection. So the
// velocities have no divergence and the least of what the viscous step alone makes least.
class Stokes {
public:
    Stokes(const Comm& comm, const StokesOptions& options);

    // What is solved, both built for the same faces (ViscousScene::pressed, close_held_faces).
    struct Parts {
        Pressure& pressure;
        ViscousProblem& viscous;
        const ViscousScene& scene;
        double dt; // [s]
    };
    // Collective. `velocity` [m/s] of before, with what gravity added, current one cell around the owned ones, becomes that
    // after dt; halo faces are left to the caller. Bodies are pushed. SimulationError where there is no solution.
    StokesReport solve(const Parts& parts, const FaceField& velocity, rigid::RigidBodies& bodies);

    std::size_t bytes() const;

private:
    struct System;
    void make_room(const Parts& parts);
    void weigh(const System& system);
    void load(System& system, const FaceField& velocity, const rigid::RigidBodies& bodies, StokesReport& report);
    void choose_guess(System& system, const FaceField& velocity, std::span<const double> loads);
    void check(const solve::SolveReport& report, std::int64_t unknowns) const;

    Comm comm_;
    StokesOptions options_;
    solve::Gmres gmres_;
    solve::Operator operator_;
    std::vector<double> b_, x_, weights_, stiffness_, scratch_, other_;
    FaceField velocity_, push_;
    Array<double> faces_{"treacle::stokes_faces", 0}, cells_{"treacle::stokes_cells", 0};
};

// The areas that the pressure acts through where it acts together with the viscosity: none of faces that a solid takes along.
void close_held_faces(const ViscousFaces& viscous, const FaceField& open, FaceField& out);

} // namespace treacle::grid
