#pragma once
// Private to src/scene: a bounding volume hierarchy over triangles.
#include "scene/shapes/bounds.hpp"

#include <array>
#include <cstddef>
#include <vector>

namespace treacle::scene {

using Triangle = std::array<Vec3, 3>; // corners [m]

// Point of the triangles that is nearest to a position.
struct ClosestPoint {
    Vec3 point{0, 0, 0};                    // [m]
    std::size_t triangle = 0;               // as numbered at construction
    std::array<double, 3> weights{0, 0, 0}; // barycentric
    double distance = 0;                    // [m] >= 0
};

// Immutable tree of boxes; leaves hold a few triangles.
class TriangleBvh {
public:
    // A segment is the triangle {a, b, b}.
    explicit TriangleBvh(std::vector<Triangle> triangles);

    // The closest point to x [m]; not for an empty tree. `at_most` [m]: no smaller than its distance.
    ClosestPoint closest(const Vec3& x, double at_most = Bounds::infinite) const;

    // Generalised winding number: 1 inside and 0 outside a closed surface, to about 1 %. Far groups of
    // triangles count as dipoles (Barill et al. 2018, "Fast winding numbers for soups and clouds").
    double winding(const Vec3& x) const;

    // Distance along the unit direction to the first triangle beyond `skip` [m]; infinite without a hit.
    double first_hit(const Vec3& origin, const Vec3& direction, double skip) const;

private:
    struct Node {
        Bounds box;
        Vec3 centre{0, 0, 0}; // area-weighted
        Vec3 area_normal{0, 0, 0};
        double radius = 0;        // of the sphere around centre that holds the triangles
        int first = 0, count = 0; // leaf: triangles; else count = 0 and the children are at first, first + 1
    };
    void build(int index, int first, int count);
    void measure(Node& node, int first, int count) const;

    std::vector<Triangle> triangles_; // in the order of the leaves
    std::vector<std::size_t> number_;
    std::vector<Node> nodes_;
};

} // namespace treacle::scene
