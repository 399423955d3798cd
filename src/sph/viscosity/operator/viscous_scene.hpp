#pragma once
#include "sph/forces/forces.hpp"
#include "sph/model/step_context.hpp"

namespace treacle::sph {

// What a step has for the viscous solve.
struct ViscousScene : StepContext {
    const ForceOptions& forces;
    Halo* solid_halo = nullptr; // needed where solids slip
};

// And how its solids move.
struct ViscousContext : ViscousScene {
    const MomentReferencePoints& points;
    const Array<double>& friction; // of each solid, see ViscousWalls
    const Array<double>& motion;   // [solids][6] velocity [m/s] and spin [rad/s]
};

} // namespace treacle::sph
