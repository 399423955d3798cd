#pragma once
#include "grid/geometry/fractions.hpp"
#include "grid/pressure/pressure_coupling.hpp"

#include <vector>

namespace treacle::grid {

// Solids whose place does not change: the six sides of the domain, which may move along themselves, and bodies at rest.
// Numbered as Solids::place() does: the sides, then all bodies; those that move have no share here. With their shares in the
// cubes around faces and the motion of the sides, P2 and V5 give the loads on them as those on bodies.
class RestingSolids {
public:
    RestingSolids(const MacGrid& grid, const scene::Domain& domain, std::size_t bodies);

    // Local. For the solids as `builder` found the fluid's fractions of them last.
    void find(const Solids& solids, const FractionBuilder& builder, const rigid::RigidBodies& bodies);

    std::size_t count() const { return count_; } // 6 sides and all bodies
    // [window], by the axis that the faces are across.
    const FaceBodyFractions& body_fractions() const { return body_fractions_; }
    // All about one point, the middle of periodic axes, so that a position and its images have one arm.
    const BodyMotion& motion() const { return motion_; }
    // Loads about that point become those about the origin.
    void about_origin(std::vector<double>& loads) const;
    bool any_moves() const { return any_moves_; }   // along itself
    double max_speed() const { return max_speed_; } // [m/s]
    std::size_t bytes() const;

    // Adds factor times the velocity of each, by its share, to a number per face across `axis`; factor [window], or none: 1.
    void add_velocities(int axis, const CellBox& window, const Array<double>& factor, const Array<double>& out) const;
    // Number here of a solid by its number in Solids::number, or -1 of one that moves or of none: [n] numbers.
    void renumber(const Array<int>& number, std::size_t n, Array<int>& out) const;

private:
    std::size_t count_ = 0;
    FaceBodyFractions body_fractions_;
    BodyMotion motion_;
    Vec3 centre_{0, 0, 0};
    bool any_moves_ = false;
    double max_speed_ = 0;
    Array<int> counts_{"treacle::resting", 0};        // [count] 1 of those that rest
    Array<int> number_{"treacle::resting_number", 0}; // [fine nodes]
    CellBox found_;                                   // window of the shares
    bool any_found_ = false;
};

} // namespace treacle::grid
