#include "scene/shapes/moments.hpp"

#include "scene/shapes/vector_math.hpp"

#include <algorithm>

namespace treacle::scene {

namespace {
// Integrals of 1, x, x x^T about a point near the solid, where they lose no digits.
struct Sums {
    double volume = 0;
    Vec3 first{0, 0, 0};
    std::array<Vec3, 3> second{};

    void add(double weight, const Vec3& x) {
        volume += weight;
        first += weight * x;
        for (std::size_t i = 0; i < 3; ++i) second[i] += (weight * x[i]) * x;
    }

    Moments about(const Vec3& origin, int dimensions) const {
        Moments out;
        out.volume = volume;
        const Vec3 mean = (1 / volume) * first;
        out.centre = origin + mean;
        std::array<Vec3, 3> covariance = second;
        for (std::size_t i = 0; i < 3; ++i) covariance[i] += (-volume * mean[i]) * mean;
        if (dimensions == 2) {
            out.inertia[2][2] = covariance[0][0] + covariance[1][1];
            return out;
        }
        const double trace = covariance[0][0] + covariance[1][1] + covariance[2][2];
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) out.inertia[i][j] = (i == j ? trace : 0) - covariance[i][j];
        }
        return out;
    }
};

// Cells of a tree that are halved along each edge until the surface is resolved.
class Tree {
public:
    Tree(const SampledSolid& solid, const Vec3& origin, int depth) : solid_(solid), origin_(origin), depth_(depth) {}

    void add(const Vec3& centre, const Vec3& half, int level) {
        const double bounding_radius = length(half),
                     bound = solid_.bound ? solid_.bound(centre) : solid_.distance(centre);
        if (bound >= bounding_radius) return;
        const double volume = size(half);
        if (bound <= -bounding_radius) {
            add_cell(centre, half, volume);
        } else if (level == depth_) {
            const double distance = solid_.bound ? solid_.distance(centre) : bound;
            add_cell(centre, half, volume * std::clamp(0.5 - distance / width(centre, half), 0.0, 1.0));
        } else {
            const Vec3 quarter = 0.5 * half;
            for (int corner = 0; corner < 1 << solid_.dimensions; ++corner) {
                Vec3 next = centre;
                for (int k = 0; k < solid_.dimensions; ++k) {
                    const auto u = static_cast<std::size_t>(k);
                    next[u] += (corner >> k & 1 ? 1 : -1) * quarter[u];
                }
                add(next, quarter, level + 1);
            }
        }
    }
    const Sums& sums() const { return sums_; }

private:
    double size(const Vec3& half) const {
        double out = 1;
        for (int k = 0; k < solid_.dimensions; ++k) out *= 2 * half[static_cast<std::size_t>(k)];
        return out;
    }
    // Width of a cell at right angles to the surface [m].
    double width(const Vec3& centre, const Vec3& half) const {
        double squares = 0;
        const Vec3 normal = solid_.normal ? solid_.normal(centre) : Vec3{0, 0, 0};
        for (int k = 0; k < solid_.dimensions; ++k) {
            const auto u = static_cast<std::size_t>(k);
            const double change = solid_.normal ? 2 * half[u] * normal[u] : change_of(centre, half, u);
            squares += change * change;
        }
        return std::max(std::sqrt(squares), 1e-300);
    }
    // Change of the distance from one side of a cell to the other [m].
    double change_of(const Vec3& centre, const Vec3& half, std::size_t axis) const {
        Vec3 above = centre, below = centre;
        above[axis] += half[axis] / 4;
        below[axis] -= half[axis] / 4;
        return 4 * (solid_.distance(above) - solid_.distance(below));
    }
    void add_cell(const Vec3& centre, const Vec3& half, double volume) {
        if (volume == 0) return;
        sums_.add(volume, centre - origin_);
        for (std::size_t k = 0; k < 3; ++k) sums_.second[k][k] += volume * half[k] * half[k] / 3;
    }

    const SampledSolid& solid_;
    Vec3 origin_;
    int depth_;
    Sums sums_;
};
} // namespace

// Tetrahedra from a point to the triangles: integrals of x x^T by their corners (Tonon 2004).
Moments moments_of(const TriangleMesh& mesh) {
    const Vec3 origin = mesh.vertices.front();
    Sums sums;
    for (const auto& triangle : mesh.triangles) {
        std::array<Vec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.vertices[static_cast<std::size_t>(triangle[k])] - origin;
        const double volume = dot(p[0], cross(p[1], p[2])) / 6;
        const Vec3 sum = p[0] + p[1] + p[2];
        sums.volume += volume;
        sums.first += (volume / 4) * sum;
        for (std::size_t i = 0; i < 3; ++i) {
            sums.second[i] += (volume / 20 * sum[i]) * sum;
            for (const auto& corner : p) sums.second[i] += (volume / 20 * corner[i]) * corner;
        }
    }
    return sums.about(origin, 3);
}

Moments moments_of(const SampledSolid& solid) {
    auto box = solid.bounds;
    if (solid.dimensions == 2) box.min[2] = box.max[2] = 0;
    const Vec3 centre = 0.5 * (box.min + box.max), half = 0.5 * (box.max - box.min);
    Tree tree(solid, centre, solid.dimensions == 3 ? 7 : 10);
    tree.add(centre, half, 0);
    if (!(tree.sums().volume > 0)) return {};
    auto out = tree.sums().about(centre, solid.dimensions);
    if (solid.volume == 0) return out;
    const double scale = solid.volume / out.volume;
    out.volume = solid.volume;
    for (auto& row : out.inertia) row = scale * row;
    return out;
}

} // namespace treacle::scene
