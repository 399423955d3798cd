#include "rigid/contact.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::rigid {

namespace {
constexpr int sweeps = 200;
constexpr double settled = 1e-10;     // change of velocity per sweep, over that by gravity and the largest speed
constexpr double taken_back = 0.2;    // of an overlap, per step
constexpr double tolerated = 0.005;   // overlap, in spacings, that keeps contacts closed

// Below this share of what bodies would give way by themselves, joints hold them.
constexpr double held = 1e-9;

// A direction of a contact: what an impulse along it does.
struct Line {
    Vec3 direction{0, 0, 0};
    double mass = 0;            // [kg]; 0: nothing gives way
    std::vector<double> answer; // of all bodies, per impulse; empty when no joint takes part
};

// One contact and its impulses so far.
struct Row {
    const Contact* contact = nullptr;
    Line normal, tangents[2];
    double wanted = 0;                    // least velocity along the normal [m/s]
    double impulse = 0, drag[2] = {0, 0}; // [kg m/s]
    double push = 0;                      // of the shift [kg m]
};

class Solver {
public:
    Solver(const std::vector<Contact>& contacts, std::vector<Movable>& bodies, const Mobility& together,
           const ContactStep& step)
        : bodies_(bodies), together_(together), step_(step) {
        for (const auto& contact : contacts) prepare(contact);
    }

    void solve() {
        double speed = step_.gravity * step_.dt;
        for (const auto& body : bodies_) speed = std::max(speed, length(body.velocity));
        for (int k = 0; k < sweeps; ++k) {
            double changed = 0;
            for (auto& row : rows_) {
                changed = std::max(changed, press(row));
                changed = std::max(changed, rub(row));
            }
            if (changed <= settled * speed) break;
        }
        for (int k = 0; k < sweeps; ++k) {
            double changed = 0;
            for (auto& row : rows_) changed = std::max(changed, part(row));
            if (changed <= 1e-6 * step_.spacing) break;
        }
    }

private:
    void prepare(const Contact& contact) {
        Row row;
        row.contact = &contact;
        const Vec3 relative = velocity(contact);
        const double approach = dot(relative, contact.normal);
        // Along the sliding, so that the friction of a sliding body points against it.
        const Vec3 sliding = relative - approach * contact.normal;
        const double speed = length(sliding);
        const Vec3 any = std::abs(contact.normal[2]) < 0.9 ? Vec3{-contact.normal[1], contact.normal[0], 0}
                                                           : Vec3{contact.normal[2], 0, -contact.normal[0]};
        const Vec3 first = speed > 1e-12 ? (1 / speed) * sliding : (1 / length(any)) * any;
        row.normal = make_line(contact, contact.normal);
        row.tangents[0] = make_line(contact, first);
        row.tangents[1] = make_line(contact, cross(contact.normal, first));
        row.wanted = -std::max(0.0, contact.gap) / step_.dt;
        // What gravity gives in some steps is rest, not an impact.
        if (approach < row.wanted && approach < -4 * step_.gravity * step_.dt) {
            row.wanted = std::max(row.wanted, -contact.restitution * approach);
        }
        rows_.push_back(row);
    }

    Line make_line(const Contact& contact, const Vec3& direction) const {
        Line line{direction, 0, {}};
        double inverse = mobility(bodies_[contact.body], contact.arm, direction);
        if (contact.other >= 0) {
            inverse += mobility(bodies_[static_cast<std::size_t>(contact.other)], contact.other_arm, direction);
        }
        const double alone = inverse;
        const bool joins = together_.linked(contact.body) ||
                           (contact.other >= 0 && together_.linked(static_cast<std::size_t>(contact.other)));
        if (joins) {
            const auto impulse = unit_impulse(contact, direction);
            line.answer = together_.respond(impulse);
            inverse = 0;
            for (std::size_t k = 0; k < impulse.size(); ++k) inverse += impulse[k] * line.answer[k];
        }
        line.mass = inverse > held * alone ? 1 / inverse : 0;
        return line;
    }
    static double mobility(const Movable& body, const Vec3& arm, const Vec3& direction) {
        const Vec3 moment = cross(arm, direction);
        return dot(direction, body.response.linear * direction) + dot(moment, body.response.angular * moment);
    }
    std::vector<double> unit_impulse(const Contact& contact, const Vec3& direction) const {
        std::vector<double> out(6 * bodies_.size(), 0.0);
        const auto add = [&](std::size_t body, const Vec3& arm, double sign) {
            const Vec3 moment = cross(arm, direction);
            for (std::size_t k = 0; k < 3; ++k) {
                out[6 * body + k] += sign * direction[k];
                out[6 * body + 3 + k] += sign * moment[k];
            }
        };
        add(contact.body, contact.arm, 1);
        if (contact.other >= 0) add(static_cast<std::size_t>(contact.other), contact.other_arm, -1);
        return out;
    }

    Vec3 velocity(const Contact& contact) const {
        const auto& body = bodies_[contact.body];
        Vec3 out = body.velocity + cross(body.spin, contact.arm);
        if (contact.other >= 0) {
            const auto& other = bodies_[static_cast<std::size_t>(contact.other)];
            out = out - other.velocity - cross(other.spin, contact.other_arm);
        }
        return out;
    }

    // An impulse of this size along the line.
    void kick(const Contact& contact, const Line& line, double size) {
        const Vec3 impulse = size * line.direction;
        receive(bodies_[contact.body], contact.arm, impulse);
        if (contact.other >= 0) receive(bodies_[static_cast<std::size_t>(contact.other)], contact.other_arm, -impulse);
        answer(contact, line, size, &Movable::velocity, &Movable::spin);
    }
    static void receive(Movable& body, const Vec3& arm, const Vec3& impulse) {
        body.impulse = body.impulse + impulse;
        body.angular_impulse = body.angular_impulse + cross(arm, impulse);
    }
    // Adds what the bodies answer to linear and angular velocities, or to shifts and twists.
    void answer(const Contact& contact, const Line& line, double size, Vec3 Movable::*linear, Vec3 Movable::*angular) {
        if (!line.answer.empty()) {
            for (std::size_t b = 0; b < bodies_.size(); ++b) {
                const double* v = &line.answer[6 * b];
                bodies_[b].*linear = bodies_[b].*linear + size * Vec3{v[0], v[1], v[2]};
                bodies_[b].*angular = bodies_[b].*angular + size * Vec3{v[3], v[4], v[5]};
            }
            return;
        }
        const auto add = [&](Movable& body, const Vec3& arm, const Vec3& impulse) {
            body.*linear = body.*linear + body.response.linear * impulse;
            body.*angular = body.*angular + body.response.angular * cross(arm, impulse);
        };
        const Vec3 impulse = size * line.direction;
        add(bodies_[contact.body], contact.arm, impulse);
        if (contact.other >= 0) add(bodies_[static_cast<std::size_t>(contact.other)], contact.other_arm, -impulse);
    }

    // Both return the change of the velocity at the contact [m/s].
    double press(Row& row) {
        const double change = row.wanted - dot(velocity(*row.contact), row.normal.direction);
        const double before = row.impulse;
        row.impulse = std::max(0.0, before + row.normal.mass * change);
        if (row.impulse == before) return 0;
        kick(*row.contact, row.normal, row.impulse - before);
        return std::abs(row.impulse - before) / row.normal.mass;
    }
    double rub(Row& row) {
        const double most = row.contact->friction * row.impulse;
        const double before[2] = {row.drag[0], row.drag[1]};
        const Vec3 sliding = velocity(*row.contact);
        for (int t = 0; t < 2; ++t) {
            row.drag[t] -= row.tangents[t].mass * dot(sliding, row.tangents[t].direction);
        }
        const double size = std::hypot(row.drag[0], row.drag[1]);
        if (size > most) {
            for (double& drag : row.drag) drag *= most / size;
        }
        double changed = 0;
        for (int t = 0; t < 2; ++t) {
            const double impulse = row.drag[t] - before[t];
            if (impulse == 0) continue;
            kick(*row.contact, row.tangents[t], impulse);
            if (row.tangents[t].mass > 0) changed = std::max(changed, std::abs(impulse) / row.tangents[t].mass);
        }
        return changed;
    }

    // Shifts of the poses, as an impulse gives velocities; returns their change [m].
    double part(Row& row) {
        const auto& contact = *row.contact;
        const double overlap = -contact.gap - tolerated * step_.spacing;
        if (overlap <= 0 || row.normal.mass == 0) return 0;
        const auto& body = bodies_[contact.body];
        double moved = dot(body.shift + cross(body.twist, contact.arm), contact.normal);
        const Movable* other = contact.other >= 0 ? &bodies_[static_cast<std::size_t>(contact.other)] : nullptr;
        if (other) moved -= dot(other->shift + cross(other->twist, contact.other_arm), contact.normal);
        const double before = row.push;
        row.push = std::max(0.0, before + row.normal.mass * (taken_back * overlap - moved));
        answer(contact, row.normal, row.push - before, &Movable::shift, &Movable::twist);
        return std::abs(row.push - before) / row.normal.mass;
    }

    std::vector<Movable>& bodies_;
    const Mobility& together_;
    ContactStep step_;
    std::vector<Row> rows_;
};
} // namespace

void solve_contacts(const std::vector<Contact>& contacts, std::vector<Movable>& bodies, const Mobility& together,
                    const ContactStep& step) {
    Solver(contacts, bodies, together, step).solve();
}

} // namespace treacle::rigid
