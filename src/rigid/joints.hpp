#pragma once
#include "rigid/constrained_inverse_mass.hpp"
#include "rigid/keyframes.hpp"

#include <string>

namespace treacle::rigid {

// Link between two bodies, or of one to the world. The place is that at the start of the run.
struct JointSetup {
    std::string name;
    scene::JointKind kind = scene::JointKind::hinge;
    std::size_t body = 0;
    int other = -1;          // -1: the world
    Vec3 point{0, 0, 0};     // [m]
    Vec3 axis{0, 0, 1};      // of a hinge or a slider; unit vector
    double length_scale = 1; // [m] how much a rotation counts beside a shift
};

// Pose of a body, and its centre at the start; none for the world.
struct BodyFrame {
    Pose pose;
    Vec3 start{0, 0, 0}; // [m]

    // Present position of a point given at the start [m]; in the world the same.
    Vec3 to_world(const Vec3& at_start) const { return pose.centre + to_matrix(pose.turn) * (at_start - start); }
};

// The conditions of a joint, with both bodies where they are: no relative velocity of the point that the
// first one carries, no relative rotation but about a hinge's axis; of a slider no relative motion but along
// its axis.
void append_rows(
    const JointSetup& joint, const BodyFrame& body, const BodyFrame& other, std::vector<ConstraintRow>& rows);

// Distance of each of them from being met [m]; the rows hold their rates.
void append_gaps(const JointSetup& joint, const BodyFrame& body, const BodyFrame& other, std::vector<double>& gaps);

} // namespace treacle::rigid
