// Discs and rings: cuts at right angles to the axis of a body of revolution.
#include "scene/sampling/surface.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace treacle::scene {
namespace {

constexpr double pi = std::numbers::pi;

class Ring final : public Surface {
public:
    Ring(const Vec3& centre, double inner, double outer) : centre_(centre), inner_(inner), outer_(outer) {}

    Nearest nearest(const Vec3& x) const override {
        const Vec3 gap{x[0] - centre_[0], x[1] - centre_[1], 0};
        const double r = length(gap);
        const Vec3 out = r > 0 ? (1 / r) * gap : Vec3{1, 0, 0};
        if (r - outer_ >= inner_ - r || inner_ == 0) return {r - outer_, out};
        return {inner_ - r, -out};
    }
    Bounds bounds() const override {
        return {{centre_[0] - outer_, centre_[1] - outer_, 0}, {centre_[0] + outer_, centre_[1] + outer_, 0}};
    }
    double volume() const override { return pi * (outer_ * outer_ - inner_ * inner_); }
    double area() const override { return 2 * pi * (outer_ + inner_); }

    SurfaceSamples sample(const SurfaceSampling& sampling) const override {
        SurfaceSamples result;
        const double out = outer_ - sampling.inset, in = inner_ > 0 ? inner_ + sampling.inset : 0;
        if (out < in) {
            add_circle(0.5 * (inner_ + outer_) * (inner_ > 0), 1, sampling.spacing, result);
            result.thin = result.positions.size();
            return result;
        }
        add_circle(out, 1, sampling.spacing, result);
        if (inner_ > 0) add_circle(std::max(0.0, in), -1, sampling.spacing, result);
        return result;
    }

private:
    void add_circle(double radius, double side, double spacing, SurfaceSamples& result) const {
        const auto n = std::max<std::int64_t>(1, count_intervals(2 * pi * radius, spacing));
        for (std::int64_t i = 0; i < n; ++i) {
            const double angle = 2 * pi * static_cast<double>(i) / static_cast<double>(n);
            const Vec3 out{std::cos(angle), std::sin(angle), 0};
            result.positions.push_back(Vec3{centre_[0], centre_[1], 0} + (n == 1 ? 0 : radius) * out);
            result.normals.push_back(side * out);
        }
    }

    Vec3 centre_;
    double inner_, outer_;
};

} // namespace

SurfacePointer make_ring(const Vec3& centre, double inner, double outer) {
    return std::make_shared<Ring>(centre, inner, outer);
}

} // namespace treacle::scene
