#pragma once
#include "sph/model/moment_reference_points.hpp"
#include "sph/model/neighbourhood.hpp"

namespace treacle::sph {

// Solids in the viscous sums. The layer of solid particles lies below the surface; along the line from a liquid
// particle to a solid one the velocity is taken to fall linearly to that of the solid at the surface, and on at the same
// rate to the layer (Morris et al. 1997).
struct ViscousWalls {
    Pairs pairs;
    Array<double> volume;   // V_s
    Array<int> body;        // [solids] number of the body
    Array3 normal;          // unit, out of the solid
    Array<double> friction; // [body] 0: free slip, nothing of it counts; 1: no slip
    Array<double> motion;   // [body][6] velocity [m/s] and spin [rad/s]
    MomentReferencePoints points;
    double viscous_factor; // factor on V_s, Constants::wall_viscous_factor
    double depth;          // of the layer below the surface [m]
    double least;          // distance from the surface below which particles are not taken to be [m]
    bool resting;          // as if no solid moved

    // One liquid particle and one solid particle.
    struct Contact {
        double beta;        // 1 / tau: (u_i - u_w) beta is the difference at the solid particle
        double velocity[3]; // u_w at x_i - tau x_is [m/s]
        double position[3]; // that point [m]
    };

    // True for a solid particle whose friction is not 0.
    KOKKOS_INLINE_FUNCTION bool no_slip(int s) const { return friction(body(s)) > 0; }
    // Contact of a liquid particle at the distance (dx, dy, dz) [m] from solid particle s.
    KOKKOS_INLINE_FUNCTION Contact touch(int s, double dx, double dy, double dz) const {
        const double height = math::max(normal(s, 0) * dx + normal(s, 1) * dy + normal(s, 2) * dz, depth + least);
        const double tau = (height - depth) / height;
        const auto& x = pairs.among;
        Contact out{1 / tau, {0, 0, 0}, {x(s, 0) + (1 - tau) * dx, x(s, 1) + (1 - tau) * dy, x(s, 2) + (1 - tau) * dz}};
        if (resting) return out;
        points.velocity(motion, body(s), out.position, out.velocity);
        return out;
    }
};

} // namespace treacle::sph
