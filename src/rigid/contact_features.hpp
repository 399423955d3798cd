#pragma once
// Private to src/rigid: which points of two solids are nearest to each other.
#include "rigid/bodies.hpp"

#include <optional>

namespace treacle::rigid {

// A solid where it stands.
class PosedSolid {
public:
    PosedSolid(const scene::SolidRegion& region, const Vec3& start, const Vec3& centre, const Quaternion& turn)
        : region_(&region), start_(start), centre_(centre), turn_(to_matrix(turn)), back_(transposed(turn_)) {}

    // Signed distance [m] and outward unit normal at a point of space x [m].
    double distance(const Vec3& x) const { return region_->distance(local(x)); }
    Vec3 normal(const Vec3& x) const { return turn_ * region_->normal(local(x)); }
    // Vector of space of one that is fixed to the body.
    Vec3 turned(const Vec3& v) const { return turn_ * v; }
    Vec3 to_world(const Vec3& at_start) const { return centre_ + turn_ * (at_start - start_); }
    const Vec3& centre() const { return centre_; }

private:
    Vec3 local(const Vec3& x) const { return start_ + back_ * (x - centre_); }

    const scene::SolidRegion* region_;
    Vec3 start_, centre_;
    Matrix3 turn_, back_;
};

// A point of the one solid, and how the other lies to it.
struct Touch {
    Vec3 point{0, 0, 0};  // of the probed solid
    Vec3 normal{0, 0, 0}; // unit, out of the other one
    double gap = 0;       // [m]
};

// A half-space of the domain's side, or a solid.
class Obstacle {
public:
    explicit Obstacle(const PosedSolid& solid) : solid_(&solid) {}
    explicit Obstacle(const Wall& wall) : wall_(wall) { normal_[static_cast<std::size_t>(wall.axis)] = wall.inwards; }

    // Signed distance [m], negative in the obstacle, at x [m].
    double distance(const Vec3& x) const {
        return solid_ ? solid_->distance(x) : wall_.inwards * (x[static_cast<std::size_t>(wall_.axis)] - wall_.at);
    }
    Vec3 normal(const Vec3& x) const { return solid_ ? solid_->normal(x) : normal_; } // unit, out of the obstacle
    bool flat(const Vec3& x, double length) const; // equal normals at x and `length` [m] beside it, two ways

private:
    const PosedSolid* solid_ = nullptr;
    Wall wall_;
    Vec3 normal_{0, 0, 0};
};

// Largest gap of a contact [m], and bounding radius of the smaller solid [m].
struct Near {
    double margin = 0, size = 0; // [m]
};

// Pairs of points of two solids that are nearest to each other: their normal lies in the normal cones of both. The signed distance
// is the criterion: a direction d is in the cone of the point x when the point at x + e d is at the distance e.
// Solids that rest count as one, so that no face counts that another one covers.
class NearestFeatures {
public:
    // `around`: what else rests near the two.
    NearestFeatures(
        const PosedSolid& probed, const Obstacle& other, std::vector<const PosedSolid*> around, double spacing)
        : probed_(probed), other_(other), around_(std::move(around)), spacing_(spacing) {
        set_turning(0);
    }

    // `rests`: the probed solid is one of those that count as one.
    void set_probed_rests(bool rests) { rests_ = rests; }

    // Angle by which the two turn to each other in the step [rad]: faces that are as nearly parallel touch with both their ends.
    void set_turning(double angle);

    // The nearest pair at the point of the probed surface, or within the sampling's spacing of it; if there is none, nothing.
    std::optional<Touch> at(const Vec3& x, const SurfacePoint& surface, const Near& near) const;
    // Contact of a ball about x.
    std::optional<Touch> of_ball(const Vec3& x, double radius, double margin) const;

private:
    Touch measure(const Vec3& x) const;
    bool in_cone(const Vec3& x, const Vec3& direction) const;
    bool covered(const Vec3& foot, const Vec3& normal) const;
    std::optional<Touch> seen(Touch touch, const Vec3& inwards) const;
    std::optional<Vec3> settle(const Vec3& first, double size) const;
    std::optional<Touch> along_edge(const Vec3& x, const Vec3& edge) const;

    const PosedSolid& probed_;
    const Obstacle& other_;
    std::vector<const PosedSolid*> around_;
    double spacing_;
    bool rests_ = false;
    double askew_; // what a direction out of the cone may lose, over the way along it
};

// Edge and inward direction of a solid's surface at x [m], from distances 2e-3 spacings around it.
SurfacePoint describe_surface(const scene::SolidRegion& region, const Vec3& x, double spacing);

} // namespace treacle::rigid
