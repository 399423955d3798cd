#include "surface/mesh/smoothing.hpp"

#include "kokkos/scan.hpp"

namespace treacle::surface {

namespace {
constexpr double lambda = 0.5, mu = -0.6;
} // namespace

// Triangles around each vertex, in their order.
void Smoothing::link(const Patch& patch) {
    const int n = patch.vertices, per = patch.corners_per_triangle;
    const int corners = per * patch.triangles;
    reserve(offsets_, static_cast<std::size_t>(n + 1));
    reserve(stars_, static_cast<std::size_t>(corners));
    reserve(next_, 3 * static_cast<std::size_t>(n));
    const auto offsets = offsets_, stars = stars_;
    const auto corner = patch.corner;
    Kokkos::parallel_for(
        "treacle::clear_stars", n + 1, KOKKOS_LAMBDA(int v) { offsets(v) = 0; });
    Kokkos::parallel_for(
        "treacle::count_stars", corners, KOKKOS_LAMBDA(int k) { Kokkos::atomic_increment(&offsets(corner(k))); });
    counts_to_offsets(offsets_, n);
    // Each row is filled from its start, which the offset of the row before then is.
    Kokkos::parallel_for(
        "treacle::fill_stars", corners,
        KOKKOS_LAMBDA(int k) { stars(Kokkos::atomic_fetch_add(&offsets(corner(k)), 1)) = k / per; });
    Kokkos::parallel_for(
        "treacle::order_stars", n, KOKKOS_LAMBDA(int v) {
            const int begin = v == 0 ? 0 : offsets(v - 1);
            for (int k = begin + 1; k < offsets(v); ++k) {
                const int moved = stars(k);
                int slot = k;
                for (; slot > begin && stars(slot - 1) > moved; --slot) stars(slot) = stars(slot - 1);
                stars(slot) = moved;
            }
        });
}

void Smoothing::step(const Patch& patch, double factor) {
    const int per = patch.corners_per_triangle;
    const auto offsets = offsets_, stars = stars_;
    const auto corner = patch.corner, fixed = patch.fixed;
    const auto position = patch.position, next = next_;
    Kokkos::parallel_for(
        "treacle::smoothing_step", patch.vertices, KOKKOS_LAMBDA(int v) {
            const int stays = fixed(v);
            double sum[3] = {0, 0, 0};
            int count = 0;
            if ((stays & 8) == 0) {
                for (int s = v == 0 ? 0 : offsets(v - 1); s < offsets(v); ++s) {
                    for (int k = 0; k < per; ++k) {
                        const int other = corner(std::int64_t(per) * stars(s) + k);
                        if (other == v) continue;
                        // Along the rim of a face the vertices whole on it count for nothing.
                        if (stays != 0 && ((fixed(other) & 8) != 0 || (fixed(other) & stays) != stays)) continue;
                        for (int a = 0; a < 3; ++a) sum[a] += position(3 * std::int64_t(other) + a);
                        ++count;
                    }
                }
            }
            for (int a = 0; a < 3; ++a) {
                const double x = position(3 * std::int64_t(v) + a);
                const bool moves = count > 0 && (stays >> a & 1) == 0;
                next(3 * std::int64_t(v) + a) = moves ? x + factor * (sum[a] / count - x) : x;
            }
        });
    Kokkos::parallel_for(
        "treacle::take_smoothed", 3 * patch.vertices, KOKKOS_LAMBDA(int k) { position(k) = next(k); });
}

void Smoothing::smooth(Patch& patch, int passes) {
    link(patch);
    for (int pass = 0; pass < passes; ++pass) {
        step(patch, lambda);
        step(patch, mu);
    }
}

const Array<double>& Smoothing::normals(const Patch& patch) {
    reserve(normal_, 3 * static_cast<std::size_t>(patch.vertices));
    const int per = patch.corners_per_triangle;
    const auto offsets = offsets_, stars = stars_;
    const auto corner = patch.corner;
    const auto position = patch.position, normal = normal_;
    Kokkos::parallel_for(
        "treacle::surface_normals", patch.vertices, KOKKOS_LAMBDA(int v) {
            double sum[3] = {0, 0, 0};
            for (int s = v == 0 ? 0 : offsets(v - 1); s < offsets(v); ++s) {
                const std::int64_t t = std::int64_t(per) * stars(s);
                const std::int64_t a = 3 * std::int64_t(corner(t)), b = 3 * std::int64_t(corner(t + 1));
                double u[3], w[3] = {0, 0, 1};
                for (int k = 0; k < 3; ++k) u[k] = position(b + k) - position(a + k);
                if (per == 3) {
                    const std::int64_t c = 3 * std::int64_t(corner(t + 2));
                    for (int k = 0; k < 3; ++k) w[k] = position(c + k) - position(a + k);
                }
                // In 2D the liquid is on the left of a segment: u x z points out of it.
                for (int k = 0; k < 3; ++k) sum[k] += u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3];
            }
            const double length = math::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
            for (int k = 0; k < 3; ++k) normal(3 * std::int64_t(v) + k) = length > 0 ? sum[k] / length : 0;
        });
    return normal_;
}

} // namespace treacle::surface
