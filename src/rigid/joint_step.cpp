#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "rigid/bodies.hpp"

#include <algorithm>

// Effect of joints and locked degrees of freedom on the bodies in a step.
namespace treacle::rigid {

namespace {
constexpr int corrections = 30;
constexpr double closed = 1e-12; // gap, in spacings, at which correcting ends
constexpr double open = 1e-2;    // gap, in spacings, that ends the run

BodyFrame frame_of(const BodiesSetup& setup, const std::vector<Pose>& poses, int body) {
    if (body < 0) return {};
    const auto b = static_cast<std::size_t>(body);
    return {poses[b], setup.bodies[b].centre};
}

double largest(const std::vector<double>& values) {
    double most = 0;
    for (const double value : values) most = std::max(most, std::abs(value));
    return most;
}
} // namespace

bool BodiesSetup::joined(std::size_t a, std::size_t b) const {
    return std::ranges::any_of(joints, [&](const JointSetup& joint) {
        const auto other = static_cast<std::size_t>(joint.other);
        return joint.other >= 0 && ((joint.body == a && other == b) || (joint.body == b && other == a));
    });
}

std::vector<ConstraintRow> RigidBodies::joint_rows() const {
    std::vector<Pose> poses;
    for (const auto& state : states_) poses.push_back(state.pose);
    std::vector<ConstraintRow> rows;
    for (const auto& joint : setup_.joints) {
        append_rows(
            joint, frame_of(setup_, poses, static_cast<int>(joint.body)), frame_of(setup_, poses, joint.other), rows);
    }
    return rows;
}

std::vector<double> RigidBodies::gaps(const std::vector<Pose>& poses) const {
    std::vector<double> out;
    for (const auto& joint : setup_.joints) {
        append_gaps(
            joint, frame_of(setup_, poses, static_cast<int>(joint.body)), frame_of(setup_, poses, joint.other), out);
    }
    return out;
}

double RigidBodies::constraint_error() const {
    std::vector<Pose> poses;
    for (const auto& state : states_) poses.push_back(state.pose);
    return largest(gaps(poses));
}

ConstrainedInverseMass RigidBodies::mobility() const {
    std::vector<Response> responses;
    for (std::size_t b = 0; b < size(); ++b) responses.push_back(response(b));
    return {std::move(responses), joint_rows()};
}

// Impulses of the joints where the bodies are, such that the motion of the step ends with closed joints
// (SHAKE, Ryckaert et al. 1977): no drift, and as the motion without joints symplectic. The velocities are
// those along the chords of the step.
void RigidBodies::constrain_joints(double dt) {
    if (setup_.joints.empty() || !(dt > 0)) return;
    const auto together = mobility();
    double gap = 0;
    for (int k = 0; k < corrections; ++k) {
        std::vector<Pose> next;
        for (std::size_t b = 0; b < size(); ++b) next.push_back(next_pose(b, dt));
        auto changes = gaps(next);
        gap = largest(changes);
        if (gap <= closed * setup_.spacing) return;
        for (double& change : changes) change /= -dt;
        const auto impulses = together.impulses_for(changes);
        for (std::size_t i = 0; i < impulses.size(); ++i) joint_loads_[i] += impulses[i];
        apply_impulses(impulses);
    }
    if (gap <= open * setup_.spacing) return;
    const auto names = [&] {
        std::string text;
        for (const auto& joint : setup_.joints) text += (text.empty() ? "" : ", ") + joint.name;
        return text;
    };
    throw SimulationError({"joints " + names(), "they would be " + format_number(gap) + " m apart after this step",
        "joints and locked degrees of freedom contradict each other, or a body turns too far in a step",
        "remove what contradicts, or take a smaller time step"});
}

std::array<double, 6> RigidBodies::own_momentum(std::size_t body) const {
    const Vec3 p = setup_.bodies[body].mass * velocity(body);
    const Vec3 l = inertia(body, pose(body).turn) * spin(body);
    return {p[0], p[1], p[2], l[0], l[1], l[2]};
}

void RigidBodies::begin_load_sums() {
    given_.assign(6 * size(), 0.0);
    contact_loads_.assign(6 * size(), 0.0);
    joint_loads_.assign(6 * size(), 0.0);
    before_.assign(6 * size(), 0.0);
    impact_momenta_.assign(momentum_numbers * size(), 0.0);
    for (std::size_t b = 0; b < size(); ++b) {
        if (dynamic(b)) std::ranges::copy(own_momentum(b), before_.begin() + static_cast<std::ptrdiff_t>(6 * b));
    }
}

// Loads of locked degrees of freedom are what is missing from the change of the momentum.
void RigidBodies::close_ledger(double dt) {
    for (std::size_t b = 0; b < size(); ++b) {
        if (dynamic(b)) {
            const auto after = own_momentum(b);
            for (std::size_t k = 0; k < 6; ++k) {
                const std::size_t at = 6 * b + k;
                const bool outside = setup_.dimensions == 2 && k >= 2 && k < 5;
                if (!setup_.bodies[b].locked[k] || outside) continue;
                joint_loads_[at] = after[k] - before_[at] - given_[at] - contact_loads_[at];
            }
        }
        for (auto* loads : {&contact_loads_, &joint_loads_}) {
            double* load = &(*loads)[6 * b];
            if (dt > 0) {
                for (int k = 0; k < 6; ++k) load[k] /= dt;
            }
            if (moves(b)) continue;
            const Vec3 force{load[0], load[1], load[2]}, moment = cross(pose(b).centre, force);
            for (std::size_t k = 0; k < 3; ++k) load[3 + k] += moment[k];
        }
    }
}

} // namespace treacle::rigid
