#pragma once
// Private to src/scene: the distances of joined solids by those of their parts.
#include "scene/sampling/solid.hpp"

#include <vector>

namespace treacle::scene {

// One of the surfaces that a solid is joined from.
struct Leaf {
    SurfacePointer surface;      // null: nowhere
    bool crosses_itself = false; // as Solid::crosses_itself
    double sign = 1;             // -1: what is joined is the outside of it, counted over all levels
};

// Part that bounds the whole at a point.
struct Hit {
    double distance = Bounds::infinite; // [m] negative inside the whole
    Vec3 normal{0, 0, 0};               // unit, out of the whole; 0 where no part has a surface
    int leaf = -1;
};

// Minima of unions, maxima of intersections.
class Fold {
public:
    explicit Fold(const Solid& solid) { root_ = flatten(solid, 1); }

    const std::vector<Leaf>& leaves() const { return leaves_; }       // Hit::leaf is the index
    Hit at(const Vec3& x) const { return evaluate(root_, x, -1, 0); } // nearest part at x [m]
    // True when the point p of a leaf's surface, with that leaf's outward normal, is one of the whole: on its two
    // sides, `eps` away [m], one is inside and one is outside.
    bool bounds(int leaf, const Vec3& p, const Vec3& normal, double eps) const;

private:
    struct Term {
        int leaf = -1;
        Solid::Join join = Solid::Join::unite;
        bool inverted = false;
        std::vector<Term> parts;
    };
    Term flatten(const Solid& solid, double sign);
    // The leaf `forced` has this distance wherever x is.
    Hit evaluate(const Term& term, const Vec3& x, int forced, double value) const;

    std::vector<Leaf> leaves_;
    Term root_;
};

} // namespace treacle::scene
