#include "rigid/contact.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::rigid {

namespace {
// Of a pair of bodies: enough for faces, and for a body that lies in a hollow.
constexpr std::size_t contacts_per_pair = 12;

// The point of the nearest image of x to the origin along periodic axes.
Vec3 nearest_image(Vec3 x, const std::array<double, 3>& period) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (period[k] > 0) x[k] -= period[k] * std::round(x[k] / period[k]);
    }
    return x;
}

class Finder {
public:
    Finder(const RigidBodies& bodies, double dt) : bodies_(bodies), setup_(bodies.setup()) {
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            turns_.push_back(to_matrix(bodies.pose(b).turn));
            const auto& body = setup_.bodies[b];
            const double speed =
                bodies.moves(b) ? length(bodies.velocity(b)) + length(bodies.spin(b)) * body.reach : 0.0;
            margins_.push_back(0.02 * setup_.spacing + dt * (speed + dt * length(setup_.gravity)));
        }
    }

    std::vector<Contact> find() {
        for (std::size_t a = 0; a < bodies_.size(); ++a) {
            if (!bodies_.dynamic(a)) continue;
            for (const auto& wall : setup_.walls) meet_wall(a, wall);
            for (std::size_t b = 0; b < bodies_.size(); ++b) {
                if (b == a || (bodies_.dynamic(b) && b < a) || setup_.joined(a, b) || setup_.bodies[b].conveys) continue;
                if (close(a, b)) meet_body(a, b);
            }
        }
        return std::move(found_);
    }

private:
    void meet_wall(std::size_t a, const Wall& wall) {
        const auto& body = setup_.bodies[a];
        const auto axis = static_cast<std::size_t>(wall.axis);
        if (wall.inwards * (bodies_.pose(a).centre[axis] - wall.at) > body.reach + margins_[a]) return;
        std::vector<Contact> pair;
        Vec3 normal{0, 0, 0};
        normal[axis] = wall.inwards;
        for (const auto& probe : body.probes) {
            const Vec3 arm = turns_[a] * (probe.point - body.centre) - probe.radius * normal;
            const double gap = wall.inwards * (bodies_.pose(a).centre[axis] + arm[axis] - wall.at);
            if (gap < margins_[a]) pair.push_back({a, -1, arm, {0, 0, 0}, normal, gap, body.restitution, body.friction});
        }
        keep_best(std::move(pair));
    }

    bool close(std::size_t a, std::size_t b) const {
        const auto& other = setup_.bodies[b];
        if (other.region.front().inverted() || !other.region.front().closed()) return true;
        const Vec3 way = nearest_image(bodies_.pose(a).centre - bodies_.pose(b).centre, setup_.period);
        return length(way) < setup_.bodies[a].reach + other.reach + margins_[a] + margins_[b];
    }

    void meet_body(std::size_t a, std::size_t b) {
        std::vector<Contact> pair;
        probe(a, b, 1, pair);
        probe(b, a, -1, pair);
        keep_best(std::move(pair));
    }

    // The probes of `of` against the solid of `at`; with sign -1 the contact is turned round.
    void probe(std::size_t of, std::size_t at, double sign, std::vector<Contact>& pair) const {
        const auto &body = setup_.bodies[of], &solid = setup_.bodies[at];
        const auto& region = solid.region.front();
        const Vec3 way = nearest_image(bodies_.pose(of).centre - bodies_.pose(at).centre, setup_.period);
        const auto back = transposed(turns_[at]);
        const double margin = margins_[of] + margins_[at];
        const bool finite = region.closed() && !region.inverted();
        for (const auto& one : body.probes) {
            const Vec3 arm = turns_[of] * (one.point - body.centre);
            if (finite && length(way + arm) > solid.reach + one.radius + margin) continue;
            const Vec3 local = solid.centre + back * (way + arm);
            const double gap = region.distance(local) - one.radius;
            if (gap >= margin) continue;
            const Vec3 normal = turns_[at] * region.normal(local);
            const Vec3 surface = arm - one.radius * normal;
            const double restitution = std::max(body.restitution, solid.restitution);
            const double friction = std::sqrt(body.friction * solid.friction);
            if (sign > 0) {
                pair.push_back({of, static_cast<int>(at), surface, way + surface, normal, gap, restitution, friction});
            } else {
                pair.push_back({at, static_cast<int>(of), way + surface, surface, -normal, gap, restitution, friction});
            }
        }
    }

    // The one with the least gap, then those farthest from the ones kept.
    void keep_best(std::vector<Contact> pair) {
        std::vector<double> away(pair.size(), 1e300);
        for (std::size_t n = 0; n < contacts_per_pair && !pair.empty(); ++n) {
            std::size_t best = 0;
            for (std::size_t k = 1; k < pair.size(); ++k) {
                if (n == 0 ? pair[k].gap < pair[best].gap : away[k] > away[best]) best = k;
            }
            if (n > 0 && away[best] < 1e-6 * setup_.spacing) return;
            found_.push_back(pair[best]);
            for (std::size_t k = 0; k < pair.size(); ++k) {
                away[k] = std::min(away[k], length(pair[k].arm - pair[best].arm));
            }
        }
    }

    const RigidBodies& bodies_;
    const BodiesSetup& setup_;
    std::vector<Matrix3> turns_;
    std::vector<double> margins_; // [m] how near counts
    std::vector<Contact> found_;
};
} // namespace

std::vector<Contact> find_contacts(const RigidBodies& bodies, double dt) { return Finder(bodies, dt).find(); }

} // namespace treacle::rigid
