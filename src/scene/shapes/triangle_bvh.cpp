#include "scene/shapes/triangle_bvh.hpp"

#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <numbers>
#include <numeric>

namespace treacle::scene {
namespace {

constexpr int leaf_size = 4;
constexpr int stack_size = 128;      // the tree is halved at each level: depth <= 32, two entries a level
constexpr double dipole_range = 2.0; // in radii of the group

double squared_distance(const Bounds& box, const Vec3& x) {
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
        const double out = std::max({box.min[a] - x[a], 0.0, x[a] - box.max[a]});
        sum += out * out;
    }
    return sum;
}

// Closest point of a triangle by Voronoi regions (Ericson, Real-Time Collision Detection, 5.1.5); correct
// for {a, b, b} too.
std::array<double, 3> closest_weights(const Triangle& t, const Vec3& x) {
    const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ax = x - t[0];
    const double d1 = dot(ab, ax), d2 = dot(ac, ax);
    if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
    const Vec3 bx = x - t[1];
    const double d3 = dot(ab, bx), d4 = dot(ac, bx);
    if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
    const Vec3 cx = x - t[2];
    const double d5 = dot(ab, cx), d6 = dot(ac, cx);
    if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
    const double va = d3 * d6 - d5 * d4, e = d4 - d3, f = d5 - d6;
    if (va <= 0 && e >= 0 && f >= 0 && e + f > 0) return {0, 1 - e / (e + f), e / (e + f)};
    const double sum = va + vb + vc;
    if (!(sum > 0)) return {1, 0, 0};
    return {va / sum, vb / sum, vc / sum};
}

Vec3 combine(const Triangle& t, const std::array<double, 3>& w) { return w[0] * t[0] + w[1] * t[1] + w[2] * t[2]; }

// Sum of angles in (-pi, pi], each given by a complex number of that argument: their product, and the wraps that its
// argument has lost, in place of an arc tangent for each.
class AngleSum {
public:
    // Adds the angle of re + i im; nothing for 0.
    void add(double re, double im) {
        const double size = std::abs(re) + std::abs(im);
        if (!(size > 0)) return;
        const double real = (re_ * re - im_ * im) / size, imaginary = (re_ * im + im_ * re) / size;
        if (im_ >= 0 && im >= 0 && imaginary < 0) ++wraps_;
        if (im_ < 0 && im < 0 && imaginary >= 0) --wraps_;
        const bool small = std::abs(real) + std::abs(imaginary) < least;
        re_ = small ? real / least : real;
        im_ = small ? imaginary / least : imaginary;
    }
    double revolutions() const { return wraps_ + std::atan2(im_, re_) / (2 * std::numbers::pi); } // the sum / 2 pi

private:
    static constexpr double least = 1e-100; // each factor is between 0.7 and 1
    double re_ = 1, im_ = 0;
    int wraps_ = 0;
};

// Adds half of the solid angle of a triangle (van Oosterom and Strackee 1983).
void add_half_angle(const Triangle& t, const Vec3& x, AngleSum& sum) {
    const Vec3 a = t[0] - x, b = t[1] - x, c = t[2] - x;
    const double la = length(a), lb = length(b), lc = length(c);
    const double numerator = dot(a, cross(b, c));
    const double denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    sum.add(denominator, numerator);
}

// Moeller and Trumbore 1997; infinite without a hit.
double hit_distance(const Triangle& t, const Vec3& origin, const Vec3& direction) {
    const Vec3 e1 = t[1] - t[0], e2 = t[2] - t[0], p = cross(direction, e2);
    const double determinant = dot(e1, p);
    if (determinant == 0) return Bounds::infinite;
    const Vec3 s = origin - t[0];
    const double u = dot(s, p) / determinant;
    if (u < 0 || u > 1) return Bounds::infinite;
    const Vec3 q = cross(s, e1);
    const double v = dot(direction, q) / determinant;
    if (v < 0 || u + v > 1) return Bounds::infinite;
    return dot(e2, q) / determinant;
}

// `inverse`: of the direction, 0 where that is.
bool ray_meets(const Bounds& box, const Vec3& origin, const Vec3& inverse, double limit) {
    double near = 0, far = limit;
    for (int a = 0; a < 3; ++a) {
        if (inverse[a] == 0) {
            if (origin[a] < box.min[a] || origin[a] > box.max[a]) return false;
            continue;
        }
        const double t0 = (box.min[a] - origin[a]) * inverse[a], t1 = (box.max[a] - origin[a]) * inverse[a];
        near = std::max(near, std::min(t0, t1));
        far = std::min(far, std::max(t0, t1));
    }
    return near <= far;
}

} // namespace

TriangleBvh::TriangleBvh(std::vector<Triangle> triangles)
    : triangles_(std::move(triangles)), number_(triangles_.size()) {
    std::iota(number_.begin(), number_.end(), std::size_t{0});
    nodes_.reserve(triangles_.size() + 1);
    nodes_.emplace_back();
    if (triangles_.empty()) return;
    build(0, 0, static_cast<int>(triangles_.size()));
    std::vector<Triangle> ordered(triangles_.size());
    for (std::size_t i = 0; i < ordered.size(); ++i) ordered[i] = triangles_[number_[i]];
    triangles_ = std::move(ordered);
}

namespace {

void enclose(const Triangle& triangle, Bounds& box) {
    for (const Vec3& corner : triangle)
        for (int a = 0; a < 3; ++a) {
            box.min[a] = std::min(box.min[a], corner[a]);
            box.max[a] = std::max(box.max[a], corner[a]);
        }
}

} // namespace

void TriangleBvh::measure(Node& node, int first, int count) const {
    node.box = Bounds::nothing();
    double total = 0;
    Vec3 weighted{0, 0, 0};
    for (int i = first; i < first + count; ++i) {
        const Triangle& t = triangles_[number_[i]];
        enclose(t, node.box);
        const Vec3 area = 0.5 * cross(t[1] - t[0], t[2] - t[0]);
        const double size = length(area);
        node.area_normal += area;
        weighted += (size / 3) * (t[0] + t[1] + t[2]);
        total += size;
    }
    node.centre = total > 0 ? (1 / total) * weighted : 0.5 * (node.box.min + node.box.max);
    for (int i = first; i < first + count; ++i)
        for (const Vec3& corner : triangles_[number_[i]])
            node.radius = std::max(node.radius, length(corner - node.centre));
}

void TriangleBvh::build(int index, int first, int count) {
    Node node;
    measure(node, first, count);
    if (count <= leaf_size) {
        node.first = first;
        node.count = count;
        nodes_[index] = node;
        return;
    }
    int axis = 0;
    for (int a = 1; a < 3; ++a)
        if (node.box.max[a] - node.box.min[a] > node.box.max[axis] - node.box.min[axis]) axis = a;
    const auto key = [&](std::size_t i) {
        const Triangle& t = triangles_[i];
        return t[0][axis] + t[1][axis] + t[2][axis];
    };
    const int half = count / 2;
    const auto begin = number_.begin() + first;
    std::nth_element(begin, begin + half, begin + count, [&](std::size_t a, std::size_t b) {
        const double ka = key(a), kb = key(b);
        return ka < kb || (ka == kb && a < b);
    });
    node.first = static_cast<int>(nodes_.size());
    nodes_[index] = node;
    nodes_.resize(nodes_.size() + 2);
    build(node.first, first, half);
    build(node.first + 1, first + half, count - half);
}

ClosestPoint TriangleBvh::closest(const Vec3& x, double at_most) const {
    struct Entry {
        int node;
        double squared;
    };
    std::array<Entry, stack_size> stack;
    int depth = 0;
    ClosestPoint best;
    bool found = false;
    double best_squared = at_most * at_most;
    stack[depth++] = {0, squared_distance(nodes_[0].box, x)};
    while (depth > 0) {
        const Entry entry = stack[--depth];
        if (entry.squared >= best_squared) continue;
        const Node& node = nodes_[entry.node];
        for (int i = node.first; i < node.first + node.count; ++i) {
            const auto weights = closest_weights(triangles_[i], x);
            const Vec3 point = combine(triangles_[i], weights), gap = x - point;
            const double squared = dot(gap, gap);
            if (squared < best_squared) {
                found = true;
                best_squared = squared;
                best = {point, number_[i], weights, 0};
            }
        }
        if (node.count > 0) continue;
        const Entry left{node.first, squared_distance(nodes_[node.first].box, x)};
        const Entry right{node.first + 1, squared_distance(nodes_[node.first + 1].box, x)};
        const bool left_first = left.squared <= right.squared;
        stack[depth++] = left_first ? right : left;
        stack[depth++] = left_first ? left : right;
    }
    if (!found) return closest(x); // within round-off of `at_most`
    best.distance = std::sqrt(best_squared);
    return best;
}

double TriangleBvh::winding(const Vec3& x) const {
    std::array<int, stack_size> stack;
    int depth = 0;
    double dipoles = 0;
    AngleSum angles;
    stack[depth++] = 0;
    while (depth > 0) {
        const Node& node = nodes_[stack[--depth]];
        const Vec3 gap = node.centre - x;
        const double squared = dot(gap, gap), range = dipole_range * node.radius;
        if (squared > range * range) {
            dipoles += dot(gap, node.area_normal) / (4 * std::numbers::pi * squared * std::sqrt(squared));
        } else if (node.count > 0) {
            for (int i = node.first; i < node.first + node.count; ++i) add_half_angle(triangles_[i], x, angles);
        } else {
            stack[depth++] = node.first;
            stack[depth++] = node.first + 1;
        }
    }
    return dipoles + angles.revolutions();
}

double TriangleBvh::first_hit(const Vec3& origin, const Vec3& direction, double skip) const {
    Vec3 inverse{};
    for (std::size_t a = 0; a < 3; ++a) {
        if (direction[a] != 0) inverse[a] = 1 / direction[a];
    }
    std::array<int, stack_size> stack;
    int depth = 0;
    double best = Bounds::infinite;
    stack[depth++] = 0;
    while (depth > 0) {
        const Node& node = nodes_[stack[--depth]];
        if (!ray_meets(node.box, origin, inverse, best)) continue;
        for (int i = node.first; i < node.first + node.count; ++i) {
            const double t = hit_distance(triangles_[i], origin, direction);
            if (t > skip && t < best) best = t;
        }
        if (node.count > 0) continue;
        stack[depth++] = node.first;
        stack[depth++] = node.first + 1;
    }
    return best;
}

} // namespace treacle::scene
