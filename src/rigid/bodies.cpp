#include "rigid/bodies.hpp"

#include "rigid/contact.hpp"

#include <algorithm>
#include <cassert>

namespace treacle::rigid {

namespace {
constexpr std::size_t numbers_per_body = 13;
} // namespace

RigidBodies::RigidBodies(BodiesSetup setup) : setup_(std::move(setup)), states_(setup_.bodies.size()) {
    for (std::size_t b = 0; b < size(); ++b) {
        const auto& body = setup_.bodies[b];
        states_[b].pose.centre = body.centre;
        any_moves_ = any_moves_ || moves(b);
        any_dynamic_ = any_dynamic_ || dynamic(b);
        if (!dynamic(b)) continue;
        for (std::size_t k = 0; k < 3; ++k) states_[b].velocity[k] = body.locked[k] ? 0 : body.velocity[k];
        Vec3 spin = body.angular_velocity;
        for (std::size_t k = 0; k < 3; ++k) spin[k] = body.locked[3 + k] ? 0 : spin[k];
        states_[b].angular_momentum = body.inertia * spin;
    }
    begin(0);
}

Matrix3 RigidBodies::inverse_inertia(std::size_t body, const Quaternion& turn) const {
    const auto& setup = setup_.bodies[body];
    const bool plane = setup_.dimensions == 2;
    const std::array<bool, 3> free{!setup.locked[3] && !plane, !setup.locked[4] && !plane, !setup.locked[5]};
    const auto axes = to_matrix(turn);
    return inverse_on(product(product(axes, setup.inertia), transposed(axes)), free);
}

Vec3 RigidBodies::spin_at(std::size_t body, const Quaternion& turn) const {
    if (!dynamic(body)) return states_[body].angular_momentum;
    return inverse_inertia(body, turn) * states_[body].angular_momentum;
}

Vec3 RigidBodies::spin(std::size_t body) const { return spin_at(body, states_[body].pose.turn); }

Response RigidBodies::response(std::size_t body) const {
    Response out;
    if (!dynamic(body)) return out;
    const auto& setup = setup_.bodies[body];
    for (std::size_t k = 0; k < static_cast<std::size_t>(setup_.dimensions); ++k) {
        out.linear[k][k] = setup.locked[k] ? 0 : 1 / setup.mass;
    }
    out.angular = inverse_inertia(body, states_[body].pose.turn);
    return out;
}

Pose RigidBodies::pose_at(std::size_t body, double time) const {
    const auto& setup = setup_.bodies[body];
    if (setup.keyframes.empty()) {
        return {setup.centre + time * setup.velocity, rotation_by(time * setup.angular_velocity)};
    }
    auto pose = interpolate(setup.keyframes, time);
    pose.centre = setup.centre + pose.centre;
    return pose;
}

void RigidBodies::begin(double dt) {
    for (std::size_t b = 0; b < size(); ++b) {
        if (!moves(b) || dynamic(b)) continue;
        auto& state = states_[b];
        const auto& setup = setup_.bodies[b];
        if (setup.keyframes.empty()) {
            state.velocity = setup.velocity;
            state.angular_momentum = setup.angular_velocity;
            continue;
        }
        // Without a step, the velocity ahead, for the choice of the step's length.
        const double ahead = dt > 0 ? dt : 1e-6 * setup.keyframes.back().time;
        if (!(ahead > 0)) continue;
        const auto next = pose_at(b, time_ + ahead);
        state.velocity = (1 / ahead) * (next.centre - state.pose.centre);
        state.angular_momentum = (1 / ahead) * rotation_vector(product(next.turn, conjugate(state.pose.turn)));
    }
}

void RigidBodies::fall(double dt) {
    for (std::size_t b = 0; b < size(); ++b) {
        if (!dynamic(b)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            if (!setup_.bodies[b].locked[k]) states_[b].velocity[k] += dt * setup_.gravity[k];
        }
    }
}

void RigidBodies::push(std::span<const double> loads, double dt) {
    assert(loads.size() == 6 * size());
    for (std::size_t b = 0; b < size(); ++b) {
        if (!dynamic(b)) continue;
        const double* load = &loads[6 * b];
        auto& state = states_[b];
        const double dims = setup_.dimensions;
        for (std::size_t k = 0; k < 3; ++k) {
            if (!setup_.bodies[b].locked[k] && double(k) < dims) {
                state.velocity[k] += dt / setup_.bodies[b].mass * load[k];
            }
            const bool turns = !setup_.bodies[b].locked[3 + k] && (dims == 3 || k == 2);
            if (turns) state.angular_momentum[k] += dt * load[3 + k];
        }
    }
}

void RigidBodies::meet(double dt) {
    auto contacts = find_contacts(*this, dt);
    contacts_ = static_cast<int>(contacts.size());
    if (contacts.empty()) return;
    std::vector<Movable> bodies(size());
    for (std::size_t b = 0; b < size(); ++b) {
        bodies[b] = {states_[b].pose.centre, states_[b].velocity, spin(b), response(b)};
    }
    solve_contacts(contacts, bodies, {dt, length(setup_.gravity), setup_.spacing});
    for (std::size_t b = 0; b < size(); ++b) {
        if (!dynamic(b)) continue;
        auto& state = states_[b];
        state.velocity = bodies[b].velocity;
        for (std::size_t k = 0; k < 3; ++k) {
            if (bodies[b].response.angular[k][k] > 0) state.angular_momentum[k] += bodies[b].impulse[k];
        }
        state.pose.centre = state.pose.centre + bodies[b].shift;
        state.pose.turn = normalised(product(rotation_by(bodies[b].twist), state.pose.turn));
    }
}

// The angular momentum stays; the axis of the rotation is that of the middle of the step, so that the energy is kept
// to third order.
void RigidBodies::turn(std::size_t body, double dt) {
    auto& turn = states_[body].pose.turn;
    Vec3 spin = spin_at(body, turn);
    for (int k = 0; k < 3; ++k) spin = spin_at(body, product(rotation_by((dt / 2) * spin), turn));
    turn = normalised(product(rotation_by(dt * spin), turn));
}

void RigidBodies::move(double dt) {
    if (any_dynamic_) meet(dt);
    time_ += dt;
    for (std::size_t b = 0; b < size(); ++b) {
        if (!moves(b)) continue;
        if (dynamic(b)) {
            states_[b].pose.centre = states_[b].pose.centre + dt * states_[b].velocity;
            turn(b, dt);
        } else {
            states_[b].pose = pose_at(b, time_);
        }
    }
    begin(0);
}

double RigidBodies::max_speed() const {
    double most = 0;
    for (std::size_t b = 0; b < size(); ++b) {
        if (moves(b)) most = std::max(most, length(velocity(b)) + length(spin(b)) * setup_.bodies[b].reach);
    }
    return most;
}

std::array<double, 6> RigidBodies::momentum() const {
    std::array<double, 6> sum{};
    for (std::size_t b = 0; b < size(); ++b) {
        if (!dynamic(b)) continue;
        const Vec3 p = setup_.bodies[b].mass * velocity(b), l = cross(pose(b).centre, p);
        for (std::size_t k = 0; k < 3; ++k) {
            sum[k] += p[k];
            sum[3 + k] += l[k] + states_[b].angular_momentum[k];
        }
    }
    return sum;
}

std::array<double, 2> RigidBodies::energy() const {
    std::array<double, 2> sum{};
    for (std::size_t b = 0; b < size(); ++b) {
        if (!dynamic(b)) continue;
        const double mass = setup_.bodies[b].mass;
        sum[0] += 0.5 * (mass * dot(velocity(b), velocity(b)) + dot(spin(b), states_[b].angular_momentum));
        sum[1] -= mass * dot(setup_.gravity, pose(b).centre);
    }
    return sum;
}

std::vector<double> RigidBodies::state() const {
    std::vector<double> out{time_};
    for (const auto& state : states_) {
        const auto append = [&](const Vec3& v) { out.insert(out.end(), v.begin(), v.end()); };
        append(state.pose.centre);
        out.push_back(state.pose.turn.w);
        append(state.pose.turn.v);
        append(state.velocity);
        append(state.angular_momentum);
    }
    return out;
}

void RigidBodies::restore(std::span<const double> state) {
    assert(state.size() == 1 + numbers_per_body * size());
    time_ = state[0];
    for (std::size_t b = 0; b < size(); ++b) {
        const double* v = &state[1 + numbers_per_body * b];
        states_[b] = {{{v[0], v[1], v[2]}, {v[3], {v[4], v[5], v[6]}}}, {v[7], v[8], v[9]}, {v[10], v[11], v[12]}};
    }
}

} // namespace treacle::rigid
