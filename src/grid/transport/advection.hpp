#pragma once
#include "base/losses.hpp"
#include "flow/outlets.hpp"
#include "grid/mac/fine_nodes.hpp"
#include "grid/transport/apic.hpp"
#include "grid/transport/body_steps.hpp"

#include <vector>

namespace treacle::grid {

// Limits of particles at solids.
struct AdvectionOptions {
    double clearance = 0.05; // least distance of particles from solids, over dx
    double leak_depth = 1;   // over dx: deeper than this in a solid, after it was pushed out, a particle is lost
};

// The sides of the domain, for kernels.
struct DomainSides : PeriodicBox {
    int open[6]; // flow::beyond() of the sides x_min, x_max, y_min, ...
    int dimensions;
};
DomainSides make_domain_sides(const MacGrid& grid, const scene::Domain& domain);

// Particles of this rank that depart.
struct DepartureCounts {
    int lost = 0, outflow = 0; // for remove_departed to take out
    int projected_out = 0;     // moved out of solids
};

// Moves the owned particles by dt times their velocity, that of the middle of the step (faces_to_particles), along the solids in their
// way; takes their affine matrices along; wraps along periodic axes; marks those that are
// lost in the field `cause`. Straight lines are exact to second order whatever flies along, but cross where the velocity changes by
// itself within a step: there (bent_share) paths bend more and more along the velocities of the faces, by
// the second order Runge-Kutta scheme of Ralston (1962). Local.
struct Advection {
    FaceSampler faces;     // velocities of the middle of the step, at places of its beginning
    DistanceSampler solid; // with the bodies where they will be
    DomainSides domain;
    AdvectionOptions options;
    flow::Outlets outlets;
    BodySteps bodies; // in this step
};
DepartureCounts advect(const Advection& how, const GridParticles& particles, double dt);

// Least slope of an interpolated distance: in a corner of three walls it is 0.58.
inline constexpr double least_slope = 0.5;

// Pushes one place to at least `clearance` [m] from solids; returns whether it was moved.
KOKKOS_INLINE_FUNCTION bool push_out(const DistanceSampler& solid, double clearance, double x[3]) {
    bool moved = false;
    // Distances are linear between nodes: what curves takes more than one go.
    for (int k = 0; k < 4; ++k) {
        const double distance = solid.at(x);
        if (distance >= clearance) return moved;
        double gradient[3];
        solid.gradient(x, gradient);
        const double square = gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2];
        if (!(square > 1e-12)) return moved; // at the middle of a solid: it has no side
        // The interpolant is flatter than a distance where two solids meet: its slope would throw the place far off.
        const double slope = math::sqrt(square);
        const double step = (clearance * 1.0001 - distance) / math::max(slope, least_slope);
        for (int c = 0; c < 3; ++c) x[c] += step * gradient[c] / slope;
        moved = true;
    }
    return moved;
}

// Takes x from `start` to `end`, along solids where they are in its way, and keeps `clearance` [m] from them; returns whether they were.
// By a quarter of a cell at a time: what is pushed out of a thin solid from where it would end leaves it on the other side.
KOKKOS_INLINE_FUNCTION bool walk(
    const DistanceSampler& solid, double clearance, const double start[3], const double end[3], double x[3]) {
    double square = 0;
    for (int c = 0; c < 3; ++c) square += (end[c] - start[c]) * (end[c] - start[c]);
    const double length = math::sqrt(square), longest = 0.5 * solid.nodes.width;
    if (solid.at(start) >= length + clearance || !(length < 1e3 * longest)) {
        for (int c = 0; c < 3; ++c) x[c] = end[c];
        return push_out(solid, clearance, x);
    }
    const int steps = 1 + static_cast<int>(length / longest);
    bool moved = false;
    for (int c = 0; c < 3; ++c) x[c] = start[c];
    for (int k = 0; k < steps; ++k) {
        for (int c = 0; c < 3; ++c) x[c] += (end[c] - start[c]) / steps;
        moved = push_out(solid, clearance, x) || moved;
    }
    return moved;
}

// Takes the particles that advect() marked out of the store and returns those that are lost; others have flowed out.
std::vector<LostParticle> remove_departed(GridParticles& particles);

} // namespace treacle::grid
