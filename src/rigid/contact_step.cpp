#include "rigid/contact.hpp"

#include <algorithm>

// Effect of contacts on the bodies in a step, and the motion of the step, in parts that impacts end.
namespace treacle::rigid {

namespace {
constexpr int most_parts = 24;   // of a step; in the last one nothing bounces
constexpr double at_once = 0.01; // of a step: impacts no farther apart in time count as one
constexpr double resting = 4;    // steps: what gravity gives in them is rest, not an impact
} // namespace

// Velocity along the normal, negative when the gap closes [m/s].
double RigidBodies::approach(const Contact& contact) const {
    Vec3 relative = velocity(contact.body) + cross(spin(contact.body), contact.arm);
    if (contact.other >= 0) {
        const auto other = static_cast<std::size_t>(contact.other);
        if (moves(other)) relative = relative - velocity(other) - cross(spin(other), contact.other_arm);
    }
    return dot(relative, contact.normal);
}

// Relative acceleration along the normal by gravity [m/s2].
double RigidBodies::gravity_along(const Contact& contact) const {
    const auto along = [&](std::size_t body) {
        double sum = 0;
        for (std::size_t k = 0; k < 3 && dynamic(body); ++k) {
            if (!setup_.bodies[body].locked[k]) sum += contact.normal[k] * setup_.gravity[k];
        }
        return sum;
    };
    return along(contact.body) - (contact.other >= 0 ? along(static_cast<std::size_t>(contact.other)) : 0);
}

// State of the contact in the rest of the step, and its target velocity. Velocities are those of the
// middle of the step, from which gravity makes those at the time of an impact: with them the speed before it is given
// back, times the restitution, and the motion along straight lines, before and after, leads where the one along
// parabolas does.
RigidBodies::Meeting RigidBodies::expect(Contact& contact, double dt) const {
    const double speed = approach(contact), gap = std::max(0.0, contact.gap);
    contact.wanted = -gap / (dt - gone_);
    if (contact.restitution == 0 || speed >= contact.wanted) return Meeting::touches;
    const double until = gap / -speed, bend = gravity_along(contact) * (gone_ + until - dt / 2);
    const double arrival = speed + bend;
    if (arrival > -resting * length(setup_.gravity) * dt) return Meeting::touches;
    if (until > at_once * dt) return Meeting::later;
    contact.wanted = std::max(contact.wanted, -contact.restitution * arrival - bend);
    return Meeting::hits;
}

void RigidBodies::solve(const std::vector<Contact>& contacts, double dt) {
    if (contacts.empty()) return;
    const auto together = mobility();
    std::vector<SolverBody> bodies(size());
    for (std::size_t b = 0; b < size(); ++b) bodies[b] = {states_[b].velocity, spin(b), response(b)};
    solve_contacts(contacts, bodies, together, dt * length(setup_.gravity), setup_.spacing);
    std::vector<double> impulses(6 * size());
    for (std::size_t b = 0; b < size(); ++b) {
        for (std::size_t k = 0; k < 3; ++k) {
            impulses[6 * b + k] = bodies[b].impulse[k];
            impulses[6 * b + 3 + k] = bodies[b].angular_impulse[k];
        }
        if (!dynamic(b)) continue;
        auto& pose = states_[b].pose;
        pose.centre = pose.centre + bodies[b].shift;
        pose.turn = normalised(product(rotation_by(bodies[b].twist), pose.turn));
    }
    const auto answer = together.reaction(impulses);
    for (std::size_t k = 0; k < impulses.size(); ++k) {
        contact_loads_[k] += impulses[k];
        joint_loads_[k] += answer[k];
        impulses[k] += answer[k];
    }
    apply_impulses(impulses);
}

void RigidBodies::hit(const std::vector<Contact>& contacts, double dt) {
    const auto before = free_momenta();
    solve(contacts, dt);
    const auto after = free_momenta();
    for (std::size_t k = 0; k < after.size(); ++k) impact_momenta_[k] += after[k] - before[k];
}

// Impulses of contacts where the bodies are; returns for how long they move without an impact, at most to the end of the step [s].
double RigidBodies::meet(double dt, Impacts impacts) {
    auto contacts = find_contacts(*this, dt - gone_);
    contacts_ = static_cast<int>(contacts.size());
    std::vector<Contact> now, later;
    bool hits = false;
    for (auto& contact : contacts) {
        auto meeting = expect(contact, dt);
        if (impacts == Impacts::stop && meeting != Meeting::touches) {
            contact.wanted = -std::max(0.0, contact.gap) / (dt - gone_);
            meeting = Meeting::touches;
        }
        (meeting == Meeting::later ? later : now).push_back(contact);
        hits = hits || meeting == Meeting::hits;
    }
    if (hits) {
        hit(now, dt);
        return 0; // others may be on their way to each other now
    }
    solve(now, dt);
    double free = dt - gone_;
    for (const auto& contact : later) {
        const double speed = approach(contact);
        if (speed < 0) free = std::min(free, std::max(0.0, contact.gap) / -speed);
    }
    return free;
}

void RigidBodies::advance(double dt) {
    constrain_joints(dt);
    for (std::size_t b = 0; b < size(); ++b) states_[b].pose = next_pose(b, dt);
    gone_ += dt;
}

void RigidBodies::move(double dt) {
    gone_ = 0;
    for (int part = 1; any_dynamic_ && part <= most_parts; ++part) {
        const double free = meet(dt, part < most_parts ? Impacts::bounce : Impacts::stop);
        if (free >= dt - gone_) break;
        if (free > 0) advance(free);
    }
    advance(dt - gone_);
    gone_ = 0;
    time_ += dt;
    close_ledger(dt);
    begin(0);
}

} // namespace treacle::rigid
