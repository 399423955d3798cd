#include "rigid/joints.hpp"

#include <array>

namespace treacle::rigid {

namespace {
using Axes = std::vector<Vec3>;

const Axes all{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

// Two unit vectors at right angles to the axis and to each other, carried by the other body.
Axes across(const JointSetup& joint, const BodyFrame& other) {
    const Vec3& axis = joint.axis;
    const Vec3 any = std::abs(axis[2]) < 0.9 ? Vec3{-axis[1], axis[0], 0} : Vec3{axis[2], 0, -axis[0]};
    const Vec3 first = (1 / length(any)) * any;
    const auto turn = to_matrix(other.pose.turn);
    return {turn * first, turn * cross(axis, first)};
}

// Directions in which the point, and about which the body, does not move against the other.
Axes constrained_shifts(const JointSetup& joint, const BodyFrame& other) {
    return joint.kind == scene::JointKind::slider ? across(joint, other) : all;
}
Axes constrained_turns(const JointSetup& joint, const BodyFrame& other) {
    switch (joint.kind) {
    case scene::JointKind::ball: return {};
    case scene::JointKind::hinge: return across(joint, other);
    case scene::JointKind::slider: return all;
    }
    return {};
}

// Rotation of the body against the other, as far as the joint is to prevent that [rad].
Vec3 wrong_turn(const JointSetup& joint, const BodyFrame& body, const BodyFrame& other) {
    if (joint.kind == scene::JointKind::hinge) {
        return cross(to_matrix(other.pose.turn) * joint.axis, to_matrix(body.pose.turn) * joint.axis);
    }
    return rotation_vector(product(body.pose.turn, conjugate(other.pose.turn)));
}
} // namespace

void append_rows(
    const JointSetup& joint, const BodyFrame& body, const BodyFrame& other, std::vector<ConstraintRow>& rows) {
    // Both impulses act at the one point, so that they add up to nothing about any other.
    const Vec3 point = body.to_world(joint.point);
    const Vec3 arm = point - body.pose.centre, other_arm = point - other.pose.centre;
    for (const auto& e : constrained_shifts(joint, other)) {
        rows.push_back({joint.body, joint.other, e, cross(arm, e), cross(other_arm, e)});
    }
    for (const auto& e : constrained_turns(joint, other)) {
        rows.push_back({joint.body, joint.other, {0, 0, 0}, joint.length_scale * e, joint.length_scale * e});
    }
}

void append_gaps(const JointSetup& joint, const BodyFrame& body, const BodyFrame& other, std::vector<double>& gaps) {
    const Vec3 way = body.to_world(joint.point) - other.to_world(joint.point);
    for (const auto& e : constrained_shifts(joint, other)) gaps.push_back(dot(way, e));
    const auto turns = constrained_turns(joint, other);
    if (turns.empty()) return;
    const Vec3 turn = wrong_turn(joint, body, other);
    for (const auto& e : turns) gaps.push_back(joint.length_scale * dot(turn, e));
}

} // namespace treacle::rigid
