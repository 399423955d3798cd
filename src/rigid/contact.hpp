#pragma once
#include "rigid/bodies.hpp"

namespace treacle::rigid {

// Two bodies close to each other, or a body and a wall of the domain.
struct Contact {
    std::size_t body = 0;
    int other = -1;                       // -1: a wall
    Vec3 arm{0, 0, 0};                    // from the body's centre to the point [m]
    Vec3 other_arm{0, 0, 0};              // from the other's
    Vec3 normal{0, 0, 0};                 // unit, towards `body`
    double gap = 0;                       // [m], negative where they overlap
    double restitution = 0, friction = 0; // of two bodies the larger one; the geometric mean
    double wanted = 0;                    // least velocity along the normal after the impulses [m/s]
};

// Contacts that a step of dt [s] may close, in a fixed order; of each pair of bodies those that hold it best. Bodies
// that a joint links do not touch each other.
std::vector<Contact> find_contacts(const RigidBodies& bodies, double dt);

// A body while contacts are solved.
struct SolverBody {
    Vec3 velocity{0, 0, 0}, spin{0, 0, 0}; // after the impulses so far [m/s], [rad/s]
    Response response;                     // by itself
    Vec3 impulse{0, 0, 0};                 // of contacts, received [kg m/s]
    Vec3 angular_impulse{0, 0, 0};         // about the centre [kg m2/s]
    Vec3 shift{0, 0, 0};                   // out of an overlap [m]
    Vec3 twist{0, 0, 0};                   // [rad]
};

// Impulses such that each contact has at least the target velocity along its normal, with Coulomb's friction; then
// shifts that take back a share of each overlap. They change neither momentum nor, but for the lever arms that a shift
// changes, angular momentum. `together` gives the response of bodies linked by joints. `speed` [m/s] is the scale of
// velocities, `spacing` [m] that of shifts.
void solve_contacts(const std::vector<Contact>& contacts, std::vector<SolverBody>& bodies,
    const ConstrainedInverseMass& together, double speed, double spacing);

} // namespace treacle::rigid
