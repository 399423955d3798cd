#pragma once
#include "rigid/bodies.hpp"
#include "sph/model/domain.hpp"
#include "sph/model/moment_reference_points.hpp"
#include "sph/model/particles.hpp"

namespace treacle::sph {

// The rigid bodies of a run as the solid particles follow them. Body k of `rigid` carries the loads number
// first + k; the numbers before are the sides of the domain.
class Bodies {
public:
    Bodies() = default;
    // With factors on the volumes of the bodies' particles; none: 1. `sides` [m/s]: of the domain's sides, which are the first
    // numbers; none: they rest.
    Bodies(rigid::BodiesSetup setup, const std::vector<double>& scale, int first, int count, const DomainBox& domain,
        std::vector<Vec3> sides = {});

    rigid::RigidBodies rigid; // without the sides of the domain

    // Bodies of `rigid` that move, or that liquid moves.
    bool any_moves() const { return rigid.any_moves(); }
    bool any_dynamic() const { return rigid.any_dynamic(); }
    int first() const { return first_; } // number of body 0 of `rigid` among the solids with loads
    const MomentReferencePoints& moment_reference_points() const {
        return points_;
    } // of all solids with loads, where they are now

    // Marks the particles' positions at the start of the run, as long as none has moved.
    void mark_start(const SolidParticles& solid) const;
    // (S4b) Velocities of all particles of bodies that move, ghosts too, from their places.
    void set_velocities(const SolidParticles& solid);
    // (S9b) Places of the owned particles of bodies that move.
    void update_positions(const SolidParticles& solid);
    // Velocity [m/s] and spin [rad/s] of all solids, 6 numbers each; 0 of those that rest. As of set_velocities().
    const Array<double>& motion() const { return motion_; }
    // (S8b) Loads of the bodies among the loads of all solids.
    std::span<const double> loads_of(const std::vector<double>& loads) const {
        return std::span(loads).subspan(6 * static_cast<std::size_t>(first_), 6 * rigid.size());
    }

private:
    void upload();
    void move_sides(const Array<double>::HostMirror& motion) const;

    DomainBox domain_{};
    int first_ = 0;
    MomentReferencePoints points_;
    std::vector<Vec3> sides_;
    Array<double> motion_{"treacle::solid_motion", 0}; // [count][6]
    Array<double> frames_{"treacle::body_frames", 0};  // [count][frame_width]
};

} // namespace treacle::sph
