#include "grid/viscosity/viscosity_options.hpp"

#include "base/options/options.hpp"

namespace treacle::grid {

void ViscosityOptions::declare(Declaration& d) {
    declare_solve(d, preconditioner, residual, max_iterations);
    d.number("min_liquid_fraction", min_liquid_fraction, unit::none, range_above_to(0, 0.1),
        "Share of a cube below which its liquid has no stress and keeps its velocity: slivers cost iterations.");
    d.number("min_fluid_fraction", min_fluid_fraction, unit::none, range_above_to(0, 0.5),
        "Share of a stress' cube outside of solids below which the liquid beside it moves with the solid: walls are "
        "out of place by at most this share of the spacing, and smaller ones make slivers of liquid stiffer.");
    d.number("no_penetration_layer", no_penetration_layer, unit::none, range_above_to(0, 1),
        "Surfaces with slip resist flow across them as a layer of liquid of this thickness would, in grid widths.");
}

} // namespace treacle::grid
