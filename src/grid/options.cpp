#include "grid/options.hpp"

#include "base/options/options.hpp"

namespace treacle::grid {

namespace {
void declare_advection(Declaration& d, AdvectionOptions& options) {
    d.number("clearance", options.clearance, unit::none, range_between(0, 0.5),
        "Least distance of particles from solids, in grid widths: nearer ones are moved off.");
    d.number("leak_depth", options.leak_depth, unit::none, range_above(0),
        "Depth in a solid, in grid widths, from which a particle is lost.");
}

void declare_correction(Declaration& d, GridOptions& options) {
    auto& c = options.correction;
    d.choice("method", c.method,
        {{"density", PositionMethod::density}, {"distance", PositionMethod::distance}, {"none", PositionMethod::none}},
        "What spreads particles evenly after they have moved: constraints on their density (dissertation, 5.3.5), on "
        "their distances (Ando & Tsuruno 2011), or nothing.");
    d.integer("every", options.correction_every, range_at_least(1), "Steps from one correction to the next.");
    d.integer("iterations", c.iterations, range_at_least(1), "Most iterations of a correction.");
    d.number("tolerance", c.tolerance, unit::none, range_above_to(0, 1),
        "Largest density error at which a correction ends, as a share of the rest density.");
    d.number("dead_band", c.dead_band, unit::none, range_between(0, 1),
        "Density error up to which nothing is moved apart, as a share of the rest density: what no iteration draws "
        "together again would swell the liquid.");
    d.number("relaxation", c.relaxation, unit::none, range_above_to(0, 10),
        "Factor on each iteration's moves; 1 to 5 where only own constraints count.");
    d.boolean("neighbour_constraints", c.neighbour_constraints,
        "Whether the neighbours' constraints move a particle as well (Macklin & Mueller 2013), or its own alone.");
    d.number("cfm_epsilon", c.cfm_epsilon, unit::none, range_at_least(0),
        "Softness of the constraints, as a share of the sum of squared gradients within a lattice.");
    d.number("scale_min", c.scale_min, unit::none, range_above(0),
        "Factor on what particles at solids move (alpha_min of 5.3.5); it grows with the distance in grid widths.");
    d.number("scale_max", c.scale_max, unit::none, range_above(0),
        "Factor on what particles far from solids move (alpha_max of 5.3.5).");
    d.check(c.scale_max >= c.scale_min, "scale_max",
        {"must not be below scale_min", "the factor grows from the one to the other",
            "1 and 5 are the dissertation's"});
    d.number("cap", c.cap, unit::none, range_above_to(0, 1),
        "Most that a correction moves a particle, in grid widths, which bounds the potential energy that it adds.");
}

void declare_density_relaxation(Declaration& d, DensityRelaxationOptions& options) {
    d.number("steps", options.steps, unit::none, range_at_least(0),
        "Steps in which liquid that has become sparse, as what is torn or splashes does, draws together again, and "
        "liquid that has become too dense spreads; 0: never. Fewer than 3 overshoot. Steps in which liquid is strained "
        "by less than 1/8 and would fall by less than 1/32 of a cell count for less.");
    d.number("dead_band", options.dead_band, unit::none, range_between(0, 1),
        "Share of the rest density that may be missing or too much: particles in motion are never spread quite "
        "evenly.");
}
} // namespace

void GridOptions::declare(Declaration& d) {
    d.choice("fractions", fractions,
        {{"consistent", FractionMethod::consistent}, {"independent", FractionMethod::independent},
            {"supersampled", FractionMethod::supersampled}},
        "Shares of liquid and solid around faces, edges and centres: summed from the parts of a grid of half the "
        "width, so that all have one volume (dissertation, 5.3.3); or, to compare with, each from the level sets at "
        "its own corners, or from points inside of it.");
    d.choice("coupling", coupling,
        {{"strong", Coupling::strong}, {"weak", Coupling::weak}, {"one_way", Coupling::one_way}},
        "Dynamic bodies as unknowns beside the liquid; or, to compare with, bodies that feel the forces of a liquid "
        "that took them as they moved, or that feel nothing of it.");
    d.boolean("second_projection", second_projection,
        "Whether the pressure is solved for again after the viscosity, which leaves velocities with a divergence.");
    d.block("pressure", pressure, "The pressure solves.");
    d.block("viscosity", viscosity, "The viscous solve.");
    d.block("stokes", stokes, "How pressure and viscosity act on each other.");
    d.block_of(
        "advection", [this](Declaration& inner) { declare_advection(inner, advection); }, "How particles move.");
    d.block_of(
        "correction", [this](Declaration& inner) { declare_correction(inner, *this); },
        "The correction of the particles' places.");
    d.block_of(
        "density_relaxation", [this](Declaration& inner) { declare_density_relaxation(inner, density_relaxation); },
        "What keeps the liquid's volume where its particles have come to lie too far apart.");
    d.integer("band", band, range_between(3, 64),
        "Cells around the liquid that arrays reach over beside it; bodies beyond them are not seen.");
    d.number("max_load_imbalance", max_load_imbalance, unit::none, range_at_least(1),
        "Largest over mean number of particles of a rank above which the domain is cut anew.");
}

} // namespace treacle::grid
