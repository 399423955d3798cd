#pragma once
#include "grid/advection.hpp"
#include "grid/contraction.hpp"
#include "grid/fractions.hpp"
#include "grid/position_correction.hpp"

#include <string>
#include <utility>
#include <vector>

namespace treacle {
class Declaration;
}

namespace treacle::grid {

enum class Coupling {
    strong, // bodies' velocities are unknowns beside the liquid's
    weak,   // the liquid takes bodies as they move, and they take its forces afterwards
    one_way // bodies do not feel the liquid
};
enum class Preconditioner { multilevel, boomeramg, gamg, incomplete_cholesky, jacobi };
extern const std::vector<std::pair<std::string, Preconditioner>> preconditioners; // by the words of scenes

enum class Ceilings {
    separate, // liquid leaves walls above it where only a negative pressure would keep it there
    adhere    // no wall lets liquid go
};

struct PressureOptions {
    Preconditioner preconditioner = Preconditioner::multilevel;
    double residual = 1e-8; // relative
    int max_iterations = 1000;
    double least_distance = 1e-4; // of a cell's centre from the surface, in widths (ghost fluid)
    double least_opening = 0.01;  // share of a face's area below which it is closed
    Ceilings ceilings = Ceilings::separate;

    void declare(Declaration& d);
};

struct ViscosityOptions {
    Preconditioner preconditioner = Preconditioner::multilevel;
    double residual = 1e-8; // relative
    int max_iterations = 2000;
    double least_wet = 1e-3;    // share of a cube below which liquid is none: slivers cost iterations
    double least_gap = 0.01;    // share of a stress' cube outside of solids, below which the faces beside it are held
    double normal_layer = 0.02; // widths, of the layer of liquid by which slip surfaces resist flow across them

    void declare(Declaration& d);
};

enum class StokesSolve {
    automatic, // together where viscosity spreads velocities by a third of a cell or more in the step, split elsewhere
    split,     // the pressure, the viscosity, and the pressure again, one after the other
    together   // one system of both
};

struct StokesOptions {
    StokesSolve solve = StokesSolve::automatic;
    double residual = 1e-8; // relative
    int max_iterations = 300;

    void declare(Declaration& d);
};

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
    ContractionOptions contraction;
    int correction_every = 1;      // steps
    int band = 4;                  // cells of the active block around liquid
    double rebalance_above = 1.15; // largest over mean load of the ranks

    void declare(Declaration& d);
};

} // namespace treacle::grid
