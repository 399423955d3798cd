#include "rigid/contact.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::rigid {

namespace {
constexpr int sweeps = 200;
constexpr double settled = 1e-10;     // change of velocity per sweep, over that by gravity and the largest speed
constexpr double taken_back = 0.2;    // of an overlap, per step
constexpr double tolerated = 0.005;   // overlap, in spacings, that keeps contacts closed

// One contact and its impulses so far.
struct Row {
    const Contact* contact;
    Vec3 tangents[2];
    double normal_mass = 0, tangent_mass[2] = {0, 0}; // [kg]
    double wanted = 0;                                // least velocity along the normal [m/s]
    double impulse = 0, drag[2] = {0, 0};             // [kg m/s]
    double push = 0;                                  // of the shift [kg m]
};

class Solver {
public:
    Solver(const std::vector<Contact>& contacts, std::vector<Movable>& bodies, const ContactStep& step)
        : bodies_(bodies), step_(step) {
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
        Row row{&contact, {}, 0, {0, 0}, 0, 0, {0, 0}, 0};
        const Vec3 relative = velocity(contact);
        const double approach = dot(relative, contact.normal);
        // Along the sliding, so that the friction of a sliding body points against it.
        const Vec3 sliding = relative - approach * contact.normal;
        const double speed = length(sliding);
        const Vec3 any = std::abs(contact.normal[2]) < 0.9 ? Vec3{-contact.normal[1], contact.normal[0], 0}
                                                           : Vec3{contact.normal[2], 0, -contact.normal[0]};
        row.tangents[0] = speed > 1e-12 ? (1 / speed) * sliding : (1 / length(any)) * any;
        row.tangents[1] = cross(contact.normal, row.tangents[0]);
        row.normal_mass = effective_mass(contact, contact.normal);
        for (int t = 0; t < 2; ++t) row.tangent_mass[t] = effective_mass(contact, row.tangents[t]);
        row.wanted = -std::max(0.0, contact.gap) / step_.dt;
        // What gravity gives in some steps is rest, not an impact.
        if (approach < row.wanted && approach < -4 * step_.gravity * step_.dt) {
            row.wanted = std::max(row.wanted, -contact.restitution * approach);
        }
        rows_.push_back(row);
    }

    double effective_mass(const Contact& contact, const Vec3& direction) const {
        double inverse = mobility(bodies_[contact.body], contact.arm, direction);
        if (contact.other >= 0) {
            inverse += mobility(bodies_[static_cast<std::size_t>(contact.other)], contact.other_arm, direction);
        }
        return inverse > 0 ? 1 / inverse : 0;
    }
    static double mobility(const Movable& body, const Vec3& arm, const Vec3& direction) {
        const Vec3 moment = cross(arm, direction);
        return dot(direction, body.response.linear * direction) + dot(moment, body.response.angular * moment);
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

    static void kick(Movable& body, const Vec3& arm, const Vec3& impulse) {
        const Vec3 moment = cross(arm, impulse);
        body.velocity = body.velocity + body.response.linear * impulse;
        body.spin = body.spin + body.response.angular * moment;
        body.impulse = body.impulse + moment;
    }
    void kick(const Contact& contact, const Vec3& impulse) {
        kick(bodies_[contact.body], contact.arm, impulse);
        if (contact.other >= 0) kick(bodies_[static_cast<std::size_t>(contact.other)], contact.other_arm, -impulse);
    }

    // Both return the change of the velocity at the contact [m/s].
    double press(Row& row) {
        const double change = row.wanted - dot(velocity(*row.contact), row.contact->normal);
        const double before = row.impulse;
        row.impulse = std::max(0.0, before + row.normal_mass * change);
        if (row.impulse == before) return 0;
        kick(*row.contact, (row.impulse - before) * row.contact->normal);
        return std::abs(row.impulse - before) / row.normal_mass;
    }
    double rub(Row& row) {
        const double most = row.contact->friction * row.impulse;
        const double before[2] = {row.drag[0], row.drag[1]};
        const Vec3 sliding = velocity(*row.contact);
        for (int t = 0; t < 2; ++t) row.drag[t] -= row.tangent_mass[t] * dot(sliding, row.tangents[t]);
        const double size = std::hypot(row.drag[0], row.drag[1]);
        if (size > most) {
            for (double& drag : row.drag) drag *= most / size;
        }
        double changed = 0;
        for (int t = 0; t < 2; ++t) {
            const double impulse = row.drag[t] - before[t];
            if (impulse == 0) continue;
            kick(*row.contact, impulse * row.tangents[t]);
            changed = std::max(changed, std::abs(impulse) / row.tangent_mass[t]);
        }
        return changed;
    }

    // Shifts of the poses, as an impulse gives velocities; returns their change [m].
    double part(Row& row) {
        const auto& contact = *row.contact;
        const double overlap = -contact.gap - tolerated * step_.spacing;
        if (overlap <= 0 || row.normal_mass == 0) return 0;
        auto& body = bodies_[contact.body];
        double moved = dot(body.shift + cross(body.twist, contact.arm), contact.normal);
        Movable* other = contact.other >= 0 ? &bodies_[static_cast<std::size_t>(contact.other)] : nullptr;
        if (other) moved -= dot(other->shift + cross(other->twist, contact.other_arm), contact.normal);
        const double before = row.push;
        row.push = std::max(0.0, before + row.normal_mass * (taken_back * overlap - moved));
        const Vec3 impulse = (row.push - before) * contact.normal;
        shift(body, contact.arm, impulse);
        if (other) shift(*other, contact.other_arm, -impulse);
        return std::abs(row.push - before) / row.normal_mass;
    }
    static void shift(Movable& body, const Vec3& arm, const Vec3& impulse) {
        body.shift = body.shift + body.response.linear * impulse;
        body.twist = body.twist + body.response.angular * cross(arm, impulse);
    }

    std::vector<Movable>& bodies_;
    ContactStep step_;
    std::vector<Row> rows_;
};
} // namespace

void solve_contacts(const std::vector<Contact>& contacts, std::vector<Movable>& bodies, const ContactStep& step) {
    Solver(contacts, bodies, step).solve();
}

} // namespace treacle::rigid
