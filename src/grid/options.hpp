#pragma once
#include "grid/geometry/density_relaxation.hpp"
#include "grid/geometry/fractions.hpp"
#include "grid/pressure/pressure_options.hpp"
#include "grid/transport/advection.hpp"
#include "grid/unified/stokes_options.hpp"
#include "grid/viscosity/viscosity_options.hpp"
#include "grid/volume/position_correction.hpp"

namespace treacle {
class Declaration;
}

namespace treacle::grid {

// Options of the MAC/APIC solver (dissertation, chapter 5), as the block `method` of a scene gives them.
struct GridOptions {
    double cfl = 3; // widths that liquid and bodies move in a step; a scene's time.cfl
    FractionMethod fractions = FractionMethod::consistent;
    Coupling coupling = Coupling::strong;
    bool second_projection = true; // pressure before and after the viscosity, or before it only
    PressureOptions pressure;
    ViscosityOptions viscosity;
    StokesOptions stokes;
    AdvectionOptions advection;
    PositionOptions correction;
    DensityRelaxationOptions density_relaxation;
    int correction_every = 1;         // steps
    int band = 4;                     // cells of the active block around liquid
    double max_load_imbalance = 1.15; // largest over mean load of the ranks

    void declare(Declaration& d); // keys of `method`
};

} // namespace treacle::grid
