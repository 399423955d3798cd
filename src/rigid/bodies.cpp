#include "rigid/bodies.hpp"

#include "base/text/contract.hpp"
#include "rigid/contact_features.hpp"

#include <algorithm>

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
    for (auto& body : setup_.bodies) {
        for (auto& probe : body.probes) {
            if (any_dynamic_ && probe.radius == 0)
                probe.surface = describe_surface(body.region.front(), probe.point, setup_.spacing);
        }
    }
    begin(0);
    contact_loads_.assign(6 * size(), 0.0);
    joint_loads_.assign(6 * size(), 0.0);
    begin_load_sums();
}

Matrix3 RigidBodies::inertia(std::size_t body, const Quaternion& turn) const {
    const auto axes = to_matrix(turn);
    return product(product(axes, setup_.bodies[body].inertia), transposed(axes));
}

std::array<bool, 3> RigidBodies::free_turns(std::size_t body) const {
    const auto& locked = setup_.bodies[body].locked;
    const bool plane = setup_.dimensions == 2;
    return {!locked[3] && !plane, !locked[4] && !plane, !locked[5]};
}

Matrix3 RigidBodies::inverse_inertia(std::size_t body, const Quaternion& turn) const {
    return inverse_on(inertia(body, turn), free_turns(body));
}

Vec3 RigidBodies::spin_at(std::size_t body, const Quaternion& turn) const {
    if (!dynamic(body)) return states_[body].angular_momentum;
    return inverse_inertia(body, turn) * states_[body].angular_momentum;
}

Vec3 RigidBodies::spin(std::size_t body) const { return spin_at(body, states_[body].pose.turn); }

Vec3 RigidBodies::end_velocity(std::size_t body) const {
    if (!dynamic(body)) return velocity(body);
    return velocity(body) + (1 / setup_.bodies[body].mass) * lead(body, 0);
}

Vec3 RigidBodies::end_spin(std::size_t body) const {
    if (!dynamic(body)) return spin(body);
    return spin(body) + inverse_inertia(body, states_[body].pose.turn) * lead(body, 3);
}

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
    if (setup.surface_velocity_only) return {setup.centre, {}};
    if (setup.keyframes.empty()) {
        return {setup.centre + time * setup.velocity, rotation_by(time * setup.angular_velocity)};
    }
    auto pose = interpolate(setup.keyframes, time);
    pose.centre = setup.centre + pose.centre;
    return pose;
}

void RigidBodies::begin(double dt) {
    if (dt > 0) begin_load_sums();
    step_ = dt;
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
    std::vector<double> weights(6 * size(), 0.0);
    for (std::size_t b = 0; b < size(); ++b) {
        if (!dynamic(b)) continue;
        for (std::size_t k = 0; k < static_cast<std::size_t>(setup_.dimensions); ++k) {
            weights[6 * b + k] = setup_.bodies[b].mass * setup_.gravity[k];
        }
    }
    push(weights, dt);
}

void RigidBodies::push(std::span<const double> loads, double dt) {
    TREACLE_EXPECT(loads.size() == 6 * size());
    std::vector<double> impulses(loads.begin(), loads.end());
    for (std::size_t b = 0; b < size(); ++b) {
        for (std::size_t k = 6 * b; k < 6 * b + 6; ++k) {
            impulses[k] *= dynamic(b) ? dt : 0;
            given_[k] += impulses[k];
        }
    }
    apply_impulses(impulses);
    constrain_joints(step_ > 0 ? step_ : dt);
}

// Each body by itself.
void RigidBodies::apply_impulses(std::span<const double> impulses) {
    for (std::size_t b = 0; b < size(); ++b) {
        if (!dynamic(b)) continue;
        const auto& setup = setup_.bodies[b];
        const auto turns = free_turns(b);
        for (std::size_t k = 0; k < 3; ++k) {
            if (!setup.locked[k] && k < static_cast<std::size_t>(setup_.dimensions)) {
                states_[b].velocity[k] += impulses[6 * b + k] / setup.mass;
            }
            if (turns[k]) states_[b].angular_momentum[k] += impulses[6 * b + 3 + k];
        }
    }
}

// The angular momentum stays; the axis of the rotation is that of the middle of the step, so that the energy is kept
// to third order.
Quaternion RigidBodies::next_turn(std::size_t body, double dt) const {
    const auto& turn = states_[body].pose.turn;
    Vec3 spin = spin_at(body, turn);
    for (int k = 0; k < 3; ++k) spin = spin_at(body, product(rotation_by((dt / 2) * spin), turn));
    return normalised(product(rotation_by(dt * spin), turn));
}

Pose RigidBodies::next_pose(std::size_t body, double dt) const {
    const auto& state = states_[body];
    if (!moves(body)) return state.pose;
    if (!dynamic(body)) return pose_at(body, time_ + gone_ + dt);
    return {state.pose.centre + dt * state.velocity, next_turn(body, dt)};
}

double RigidBodies::max_speed() const {
    double most = 0;
    for (std::size_t b = 0; b < size(); ++b) {
        if (moves(b)) most = std::max(most, length(velocity(b)) + length(spin(b)) * setup_.bodies[b].bounding_radius);
    }
    return most;
}

std::vector<double> RigidBodies::free_momenta() const {
    std::vector<double> out(momentum_numbers * size());
    for (std::size_t b = 0; b < size(); ++b) {
        if (!dynamic(b)) continue;
        const Vec3 p = setup_.bodies[b].mass * velocity(b), orbital = cross(pose(b).centre, p);
        auto to = out.begin() + static_cast<std::ptrdiff_t>(momentum_numbers * b);
        for (const Vec3& part : {p, angular_momentum(b), orbital}) to = std::ranges::copy(part, to).out;
    }
    return out;
}

std::vector<double> RigidBodies::weight_rates() const {
    std::vector<double> out(momentum_numbers * size());
    for (std::size_t b = 0; b < size(); ++b) {
        if (!dynamic(b)) continue;
        Vec3 force{0, 0, 0};
        for (std::size_t k = 0; k < static_cast<std::size_t>(setup_.dimensions); ++k) {
            if (!setup_.bodies[b].locked[k]) force[k] = setup_.bodies[b].mass * setup_.gravity[k];
        }
        const auto at = out.begin() + static_cast<std::ptrdiff_t>(momentum_numbers * b);
        std::ranges::copy(force, at);
        std::ranges::copy(cross(pose(b).centre, force), at + 6);
    }
    return out;
}

std::array<double, 6> RigidBodies::momentum() const {
    std::array<double, 6> sum{};
    for (std::size_t b = 0; b < size(); ++b) {
        if (!dynamic(b)) continue;
        const double mass = setup_.bodies[b].mass;
        const Vec3 p = mass * end_velocity(b);
        const Vec3 l = cross(pose(b).centre, p), own = end_angular_momentum(b);
        for (std::size_t k = 0; k < 3; ++k) {
            sum[k] += p[k];
            sum[3 + k] += l[k] + own[k];
        }
    }
    return sum;
}

Vec3 RigidBodies::moment_of_lead() const {
    Vec3 sum{0, 0, 0};
    for (std::size_t b = 0; b < size(); ++b) {
        if (dynamic(b)) sum = sum + cross(pose(b).centre, lead(b, 0)) - lead(b, 6);
    }
    return sum;
}

std::array<double, 2> RigidBodies::energy() const {
    std::array<double, 2> sum{};
    for (std::size_t b = 0; b < size(); ++b) {
        if (!dynamic(b)) continue;
        const double mass = setup_.bodies[b].mass;
        sum[0] += 0.5 * (mass * dot(end_velocity(b), end_velocity(b)) + dot(end_spin(b), end_angular_momentum(b)));
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
    TREACLE_EXPECT(state.size() == 1 + numbers_per_body * size());
    time_ = state[0];
    for (std::size_t b = 0; b < size(); ++b) {
        const double* v = &state[1 + numbers_per_body * b];
        states_[b] = {{{v[0], v[1], v[2]}, {v[3], {v[4], v[5], v[6]}}}, {v[7], v[8], v[9]}, {v[10], v[11], v[12]}};
    }
}

} // namespace treacle::rigid
