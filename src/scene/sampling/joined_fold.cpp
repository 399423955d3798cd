#include "scene/sampling/joined_fold.hpp"

#include "scene/shapes/vector_math.hpp"

#include <algorithm>

namespace treacle::scene {
namespace {

// Bounds of a solid, or of its outside.
Bounds extent(const Solid& solid, bool outside) {
    const bool inverted = solid.inverted != outside;
    if (solid.parts.empty()) {
        if (!solid.surface) return inverted ? Bounds{} : Bounds::nothing();
        return inverted ? Bounds{} : solid.surface->bounds();
    }
    // The outside of a union is the intersection of the outsides.
    const bool unites = (solid.join == Solid::Join::unite) != inverted;
    Bounds out = unites ? Bounds::nothing() : Bounds{};
    for (const Solid& part : solid.parts) {
        const Bounds box = extent(part, inverted);
        for (int a = 0; a < 3; ++a) {
            out.min[a] = unites ? std::min(out.min[a], box.min[a]) : std::max(out.min[a], box.min[a]);
            out.max[a] = unites ? std::max(out.max[a], box.max[a]) : std::min(out.max[a], box.max[a]);
        }
    }
    return out;
}

} // namespace

Bounds bounds_of(const Solid& solid) { return extent(solid, false); }

Fold::Term Fold::flatten(const Solid& solid, double sign) {
    Term out;
    out.inverted = solid.inverted;
    out.join = solid.join;
    if (solid.inverted) sign = -sign;
    if (solid.parts.empty()) {
        out.leaf = static_cast<int>(leaves_.size());
        leaves_.push_back({solid.surface, solid.crosses_itself, sign});
    }
    for (const Solid& part : solid.parts) out.parts.push_back(flatten(part, sign));
    return out;
}

Hit Fold::evaluate(const Term& term, const Vec3& x, int forced, double value) const {
    Hit out;
    if (term.leaf >= 0) {
        const Leaf& leaf = leaves_[static_cast<std::size_t>(term.leaf)];
        if (term.leaf == forced) {
            out = {value, {0, 0, 0}, term.leaf};
        } else if (leaf.surface) {
            const Nearest near = leaf.surface->nearest(x);
            out = {near.distance, near.normal, term.leaf};
        }
    } else {
        const bool unites = term.join == Solid::Join::unite;
        out.distance = unites ? Bounds::infinite : -Bounds::infinite;
        for (const Term& part : term.parts) {
            const Hit one = evaluate(part, x, forced, value);
            if (unites ? one.distance < out.distance : one.distance > out.distance) out = one;
        }
    }
    if (term.inverted) {
        out.distance = -out.distance;
        out.normal = -out.normal;
    }
    return out;
}

bool Fold::bounds(int leaf, const Vec3& p, const Vec3& normal, double eps) const {
    const bool forced = !leaves_[static_cast<std::size_t>(leaf)].crosses_itself;
    const auto outside = [&](double side) {
        return evaluate(root_, p + side * normal, forced ? leaf : -1, side).distance > 0;
    };
    return outside(eps) != outside(-eps);
}

} // namespace treacle::scene
