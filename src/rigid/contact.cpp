#include "rigid/contact.hpp"

#include "rigid/contact_features.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace treacle::rigid {

namespace {
// Contacts of a pair of bodies: enough for faces, and for a body that lies in a hollow.
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
    Finder(const RigidBodies& bodies, double dt) : bodies_(bodies), setup_(bodies.setup()), dt_(dt) {
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            const double speed =
                bodies.moves(b) ? length(bodies.velocity(b)) + length(bodies.spin(b)) * setup_.bodies[b].bounding_radius
                                : 0.0;
            margins_.push_back(0.02 * setup_.spacing + dt * (speed + dt * length(setup_.gravity)));
        }
    }

    std::vector<Contact> find() {
        for (std::size_t a = 0; a < bodies_.size(); ++a) {
            if (!bodies_.dynamic(a)) continue;
            for (const auto& wall : setup_.walls) meet_wall(a, wall);
            std::vector<std::size_t> near;
            for (std::size_t b = 0; b < bodies_.size(); ++b) {
                if (b != a && !setup_.joined(a, b) && !setup_.bodies[b].surface_velocity_only && close(a, b))
                    near.push_back(b);
            }
            if (near.empty()) continue;
            pose_solids(a, near);
            for (const std::size_t b : near) {
                if (!bodies_.dynamic(b) || b > a) meet_body(a, b);
            }
        }
        return std::move(found_);
    }

private:
    // Places body a and the nearest images of those near it; notes which of these are kinematic or static.
    void pose_solids(std::size_t a, const std::vector<std::size_t>& near) {
        posed_.clear();
        resting_.clear();
        const auto put = [&](std::size_t b, const Vec3& way) {
            const auto& body = setup_.bodies[b];
            posed_.emplace(
                b, PosedSolid(body.region.front(), body.centre, bodies_.pose(a).centre - way, bodies_.pose(b).turn));
        };
        put(a, {0, 0, 0});
        for (const std::size_t b : near) {
            put(b, nearest_image(bodies_.pose(a).centre - bodies_.pose(b).centre, setup_.period));
            if (!bodies_.dynamic(b)) resting_.push_back(b);
        }
    }

    void meet_wall(std::size_t a, const Wall& wall) {
        const auto& body = setup_.bodies[a];
        const auto axis = static_cast<std::size_t>(wall.axis);
        const double margin = margins_[a];
        if (wall.inwards * (bodies_.pose(a).centre[axis] - wall.at) > body.bounding_radius + margin) return;
        pose_solids(a, {});
        const Obstacle side(wall);
        NearestFeatures features(posed_.at(a), side, {}, setup_.spacing);
        features.set_turning(dt_ * length(spin(a)));
        std::vector<Contact> pair;
        const auto everywhere = [](const Vec3&, double) { return true; };
        for_touches(features, a, {margin, body.bounding_radius}, everywhere, [&](const Touch& touch) {
            pair.push_back({a, -1, touch.point - bodies_.pose(a).centre, {0, 0, 0}, touch.normal, touch.gap,
                body.restitution, body.friction});
        });
        keep_best(std::move(pair));
    }

    Vec3 spin(std::size_t b) const { return bodies_.moves(b) ? bodies_.spin(b) : Vec3{0, 0, 0}; }

    bool close(std::size_t a, std::size_t b) const {
        const auto& other = setup_.bodies[b];
        if (other.region.front().inverted() || !other.region.front().closed()) return true;
        const Vec3 way = nearest_image(bodies_.pose(a).centre - bodies_.pose(b).centre, setup_.period);
        return length(way) < setup_.bodies[a].bounding_radius + other.bounding_radius + margins_[a] + margins_[b];
    }

    void meet_body(std::size_t a, std::size_t b) {
        std::vector<Contact> pair;
        probe(a, b, 1, pair);
        probe(b, a, -1, pair);
        keep_best(std::move(pair));
    }

    // The samples of `of` against the solid of `at`; with sign -1 the contact is turned round.
    void probe(std::size_t of, std::size_t at, double sign, std::vector<Contact>& pair) const {
        const auto &body = setup_.bodies[of], &solid = setup_.bodies[at];
        const Obstacle obstacle(posed_.at(at));
        std::vector<const PosedSolid*> around;
        for (const std::size_t b : resting_) {
            if (b != at && b != of) around.push_back(&posed_.at(b));
        }
        NearestFeatures features(posed_.at(of), obstacle, std::move(around), setup_.spacing);
        features.set_probed_rests(!bodies_.dynamic(of));
        features.set_turning(dt_ * length(spin(of) - spin(at)));
        const double restitution = std::max(body.restitution, solid.restitution);
        const double friction = std::sqrt(body.friction * solid.friction);
        const Near near{margins_[of] + margins_[at], std::min(body.bounding_radius, solid.bounding_radius)};
        const bool finite = solid.region.front().closed() && !solid.region.front().inverted();
        const double cutoff = solid.bounding_radius + near.margin + setup_.spacing;
        const auto within = [&](const Vec3& x, double radius) {
            return !finite || length(x - posed_.at(at).centre()) <= cutoff + radius;
        };
        for_touches(features, of, near, within, [&](const Touch& touch) {
            const Vec3 one = touch.point - posed_.at(of).centre(), other = touch.point - posed_.at(at).centre();
            if (sign > 0) {
                pair.push_back({of, static_cast<int>(at), one, other, touch.normal, touch.gap, restitution, friction});
            } else {
                pair.push_back({at, static_cast<int>(of), other, one, -touch.normal, touch.gap, restitution, friction});
            }
        });
    }

    template <class Within, class Report>
    void for_touches(const NearestFeatures& features, std::size_t of, const Near& near, const Within& within,
        const Report& report) const {
        const auto& solid = posed_.at(of);
        for (const auto& sample : setup_.bodies[of].probes) {
            const Vec3 x = solid.to_world(sample.point);
            if (!within(x, sample.radius)) continue;
            const auto touch =
                sample.radius > 0
                    ? features.of_ball(x, sample.radius, near.margin)
                    : features.at(x, {solid.turned(sample.surface.edge), solid.turned(sample.surface.inwards)}, near);
            if (touch) report(*touch);
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
    double dt_;                   // [s]
    std::vector<double> margins_; // [m] how near counts
    std::map<std::size_t, PosedSolid> posed_;
    std::vector<std::size_t> resting_;
    std::vector<Contact> found_;
};
} // namespace

std::vector<Contact> find_contacts(const RigidBodies& bodies, double dt) { return Finder(bodies, dt).find(); }

} // namespace treacle::rigid
