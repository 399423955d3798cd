#include "sph/solids/boundary_volume_factor.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::sph {

namespace {
constexpr std::size_t max_points = 60; // on the surface, of which the mean is taken
// Liquid that has moved stands closer to a layer than the lattice does: with this factor balls and discs of the
// liquid's density, of 8 and 12 spacings, stay where they are (src/sph/measurements.md).
constexpr double disordered_volume_factor = 1.15;
constexpr int cells_per_spacing = 4; // of the integrals over the liquid

double apart(const Vec3& a, const Vec3& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

template <class Kernel>
class SurfaceSums {
public:
    SurfaceSums(const Kernel& kernel, const ScaleSetup& setup, const std::vector<Vec3>& layer)
        : kernel_(kernel), setup_(setup), layer_(layer) {}

    // Sum of V_s W over the layer.
    double solid(const Vec3& x) const {
        double sum = 0;
        for (const auto& s : layer_) {
            const double r = apart(x, s);
            if (r < setup_.wall.support) sum += kernel_.value(r) * volume(s);
        }
        return sum;
    }

    // Integral of W over where `free` holds.
    template <class Free>
    double liquid(const Vec3& x, const Free& free) const {
        const double step = setup_.wall.spacing / cells_per_spacing;
        const int n = static_cast<int>(std::ceil(setup_.wall.support / step));
        const bool space = setup_.wall.dimensions == 3;
        double sum = 0;
        for (int k = space ? -n : 0; k < (space ? n : 1); ++k) {
            for (int j = -n; j < n; ++j) {
                for (int i = -n; i < n; ++i) {
                    const Vec3 shift{(i + 0.5) * step, (j + 0.5) * step, space ? (k + 0.5) * step : 0};
                    const double r = apart(shift, {0, 0, 0});
                    if (r >= setup_.wall.support) continue;
                    if (free({x[0] + shift[0], x[1] + shift[1], x[2] + shift[2]})) sum += kernel_.value(r);
                }
            }
        }
        return sum * std::pow(step, setup_.wall.dimensions);
    }

private:
    double volume(const Vec3& s) const {
        double sum = 0;
        for (const auto& other : layer_) {
            const double r = apart(s, other);
            if (r < setup_.wall.support) sum += kernel_.value(r);
        }
        return 1 / sum;
    }

    Kernel kernel_;
    ScaleSetup setup_;
    const std::vector<Vec3>& layer_;
};
} // namespace

double boundary_volume_factor(
    const ScaleSetup& setup, const scene::SolidRegion& region, const std::vector<Vec3>& layer) {
    const double half = setup.wall.spacing / 2;
    const auto points = scene::sample_surface(region, {setup.wall.spacing, -half, {}}).positions;
    const std::size_t stride = std::max<std::size_t>(1, points.size() / max_points);
    double wanted = 0, given = 0;
    with_kernel(setup.wall.kind, setup.wall.dimensions, setup.wall.support, [&](const auto& kernel) {
        const SurfaceSums sums(kernel, setup, layer);
        const double plane = sums.liquid({0, half, 0}, [](const Vec3& x) { return x[1] > 0; });
        // Sums of the lattice at a plane where it rests: what the plane's own layer leaves.
        const auto wall = compute_wall_sums(setup.wall, setup.gap);
        const double solid_at_plane = wall.solid_ratio / wall.density_ratio;
        for (std::size_t k = 0; k < points.size(); k += stride) {
            const double liquid = sums.liquid(points[k], [&](const Vec3& x) { return region.distance(x) > 0; });
            wanted += 1 - (1 - solid_at_plane) * liquid / plane;
            given += sums.solid(points[k]);
        }
    });
    return disordered_volume_factor * wanted / given;
}

} // namespace treacle::sph
