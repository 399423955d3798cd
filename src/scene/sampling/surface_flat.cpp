// Boxes and planes.
#include "base/text/error.hpp"
#include "scene/sampling/surface.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::scene {
namespace {

class Box final : public Surface {
public:
    Box(const BoxPose& pose, int dimensions)
        : dimensions_(dimensions), turned_(pose.turned), centre_(pose.centre), axes_(pose.axes) {
        min_ = turned_ ? -pose.half : pose.min;
        max_ = turned_ ? pose.half : pose.max;
        if (dimensions_ == 2) min_[2] = max_[2] = centre_[2] = 0;
    }

    Nearest nearest(const Vec3& x) const override {
        const Vec3 p = turned_ ? to_local(x) : x;
        Vec3 out{0, 0, 0};
        double squared = 0, depth = -Bounds::infinite;
        Vec3 deepest{0, 0, 0};
        for (int a = 0; a < dimensions_; ++a) {
            const double below = min_[a] - p[a], above = p[a] - max_[a];
            const double beyond = std::max(below, above);
            const double sign = below > above ? -1 : 1;
            if (beyond > 0) {
                out[a] = sign * beyond;
                squared += beyond * beyond;
            } else if (beyond > depth) {
                depth = beyond;
                deepest = {0, 0, 0};
                deepest[a] = sign;
            }
        }
        if (squared > 0) {
            const double distance = std::sqrt(squared);
            return {distance, turn((1 / distance) * out)};
        }
        return {depth, turn(deepest)};
    }

    Bounds bounds() const override {
        if (!turned_) return {min_, max_};
        Bounds box{centre_, centre_};
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < dimensions_; ++b) {
                box.min[a] -= std::abs(axes_[b][a]) * max_[b];
                box.max[a] += std::abs(axes_[b][a]) * max_[b];
            }
        return box;
    }

    double volume() const override {
        const Vec3 e = max_ - min_;
        return dimensions_ == 2 ? e[0] * e[1] : e[0] * e[1] * e[2];
    }
    double area() const override {
        const Vec3 e = max_ - min_;
        return dimensions_ == 2 ? 2 * (e[0] + e[1]) : 2 * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0]);
    }

    // A regular lattice on each face; neighbouring faces share the points of their edges.
    SurfaceSamples sample(const SurfaceSampling& sampling) const override {
        Vec3 low = min_, high = max_;
        std::array<std::int64_t, 3> n{0, 0, 0};
        bool thin = false;
        for (int a = 0; a < dimensions_; ++a) {
            low[a] += sampling.inset;
            high[a] -= sampling.inset;
            if (high[a] < low[a]) {
                thin = true;
                low[a] = high[a] = 0.5 * (min_[a] + max_[a]);
            }
            n[a] = count_intervals(high[a] - low[a], sampling.spacing);
        }
        SurfaceSamples result;
        for (std::int64_t k = 0; k <= n[2]; ++k)
            for (std::int64_t j = 0; j <= n[1]; ++j) {
                const bool whole_row = j == 0 || j == n[1] || (dimensions_ == 3 && (k == 0 || k == n[2]));
                const std::int64_t step = whole_row ? 1 : std::max<std::int64_t>(1, n[0]);
                for (std::int64_t i = 0; i <= n[0]; i += step) add_node({i, j, k}, n, low, high, result);
            }
        result.thin = thin ? result.positions.size() : 0;
        return result;
    }

private:
    Vec3 to_local(const Vec3& x) const {
        const Vec3 r = x - centre_;
        return {dot(r, axes_[0]), dot(r, axes_[1]), dot(r, axes_[2])};
    }
    Vec3 turn(const Vec3& v) const { return turned_ ? v[0] * axes_[0] + v[1] * axes_[1] + v[2] * axes_[2] : v; }
    void add_node(const std::array<std::int64_t, 3>& index, const std::array<std::int64_t, 3>& n, const Vec3& low,
        const Vec3& high, SurfaceSamples& result) const {
        Vec3 p{0, 0, 0}, normal{0, 0, 0}, flat{0, 0, 0};
        for (int a = 0; a < dimensions_; ++a) {
            const double fraction = n[a] == 0 ? 0 : static_cast<double>(index[a]) / static_cast<double>(n[a]);
            p[a] = index[a] == n[a] ? high[a] : low[a] + fraction * (high[a] - low[a]);
            if (n[a] == 0)
                flat[a] = 1;
            else if (index[a] == 0)
                normal[a] = -1;
            else if (index[a] == n[a])
                normal[a] = 1;
        }
        result.positions.push_back(turned_ ? centre_ + turn(p) : p);
        result.normals.push_back(turn(unit(normal, unit(flat))));
    }

    int dimensions_;
    bool turned_;
    Vec3 centre_;
    std::array<Vec3, 3> axes_;
    Vec3 min_, max_; // turned: about the centre
};

class Plane final : public Surface {
public:
    Plane(const Vec3& point, const Vec3& normal, int dimensions)
        : point_(point), normal_(normal), dimensions_(dimensions) {}

    Nearest nearest(const Vec3& x) const override { return {dot(x - point_, normal_), normal_}; }
    Bounds bounds() const override { return {}; }
    double volume() const override { return Bounds::infinite; }
    double area() const override { return Bounds::infinite; }

    // A square lattice, half a spacing off the corner of the clip: on a plane along the axes it is the
    // lattice of a liquid whose domain is the clip.
    SurfaceSamples sample(const SurfaceSampling& sampling) const override {
        const Bounds& clip = sampling.clip;
        for (int a = 0; a < dimensions_; ++a)
            if (!std::isfinite(clip.min[a]) || !std::isfinite(clip.max[a]))
                throw InputError({"", "a plane cannot be covered with particles without an end", "it is infinite",
                    "bound it by the domain"});
        const Vec3 t = dimensions_ == 2 ? Vec3{-normal_[1], normal_[0], 0} : in_plane_axis();
        const Vec3 u = dimensions_ == 2 ? Vec3{0, 0, 0} : cross(normal_, t);
        Vec3 corner = clip.min;
        if (dimensions_ == 2) corner[2] = 0;
        const Vec3 origin = corner - (dot(corner - point_, normal_) + sampling.inset) * normal_;
        std::array<double, 4> extent{0, 0, 0, 0}; // of the clip along t and u, from the origin
        for (int c = 0; c < 8; ++c) {
            Vec3 x{c & 1 ? clip.max[0] : clip.min[0], c & 2 ? clip.max[1] : clip.min[1],
                c & 4 ? clip.max[2] : clip.min[2]};
            if (dimensions_ == 2) x[2] = 0;
            const double along_t = dot(x - origin, t), along_u = dot(x - origin, u);
            extent = {std::min(extent[0], along_t), std::max(extent[1], along_t), std::min(extent[2], along_u),
                std::max(extent[3], along_u)};
        }
        const double d = sampling.spacing;
        const auto index = [&](double x) { return static_cast<std::int64_t>(std::floor(x / d)); };
        SurfaceSamples result;
        for (auto j = index(extent[2]); j <= index(extent[3]); ++j)
            for (auto i = index(extent[0]); i <= index(extent[1]); ++i) {
                const Vec3 x =
                    origin + ((static_cast<double>(i) + 0.5) * d) * t + ((static_cast<double>(j) + 0.5) * d) * u;
                bool inside = true;
                for (int a = 0; a < dimensions_; ++a) inside = inside && clip.min[a] <= x[a] && x[a] <= clip.max[a];
                if (!inside) continue;
                result.positions.push_back(x);
                result.normals.push_back(normal_);
            }
        return result;
    }

private:
    // A coordinate axis turned into the plane.
    Vec3 in_plane_axis() const {
        int least = 0;
        for (int a = 1; a < 3; ++a)
            if (std::abs(normal_[a]) < std::abs(normal_[least])) least = a;
        Vec3 e{0, 0, 0};
        e[least] = 1;
        return unit(e - dot(e, normal_) * normal_);
    }

    Vec3 point_, normal_;
    int dimensions_;
};

} // namespace

SurfacePointer make_box(const BoxPose& pose, int dimensions) { return std::make_shared<Box>(pose, dimensions); }

SurfacePointer make_plane(const Vec3& point, const Vec3& normal, int dimensions) {
    return std::make_shared<Plane>(point, normal, dimensions);
}

} // namespace treacle::scene
