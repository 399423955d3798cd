#include "grid/surface_tension/curvature.hpp"

#include "grid/mac/pressure_faces.hpp"
#include "grid/transport/apic.hpp"

#include <cmath>
#include <utility>

namespace treacle::grid {

namespace {
constexpr int passes =
    3; // of (1 2 1)/4 along each axis, before the first curvature and again before the second; src/grid/theory.md
// [dx2] Variances along an axis: of a pass, and what the spread of particles and differences over a cell take besides, such
// that drops of four and eight cells of radius oscillate about as much too slowly as too fast.
constexpr double pass_variance = 0.5, other_variance = 0.75;
constexpr double first_variance = other_variance + passes * pass_variance,
                 second_variance = first_variance + passes * pass_variance;
constexpr double farthest = 1.5; // [dx] from the surface, as far as its curvature goes on

// One pass of (edge, 1 - 2 edge, edge) along each axis.
struct SmoothLoop {
    PressureFaces faces;
    CellBox cells;
    double edge;
    Array<double> from, to;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        int c[3];
        cells.cell(i, c);
        const int at = faces.window.index(c[0], c[1], c[2]);
        const int sx = static_cast<int>(faces.stride[0]), sy = static_cast<int>(faces.stride[1]),
                  sz = static_cast<int>(faces.stride[2]);
        const int up = faces.dimensions == 3 ? 1 : 0;
        const double middle = 1 - 2 * edge;
        double sum = 0;
        for (int z = -up; z <= up; ++z) {
            for (int y = -1; y <= 1; ++y) {
                const int row = at + y * sy + z * sz;
                const double weight = (y == 0 ? middle : edge) * (up == 0 ? 1.0 : z == 0 ? middle : edge);
                sum += weight * (middle * from(row) + edge * (from(row - sx) + from(row + sx)));
            }
        }
        to(at) = sum;
    }
};

// Collective; the halo of `values` must be current, and is afterwards.
void smooth(
    CellHalo& halo, const PressureFaces& faces, int times, double edge, Array<double>& values, Array<double>& scratch) {
    const CellBox cells = halo.owned();
    Kokkos::deep_copy(scratch, 0.0);
    for (int pass = 0; pass < times; ++pass) {
        Kokkos::parallel_for("treacle::smooth_fraction", static_cast<int>(cells.size()),
            SmoothLoop{faces, cells, edge, values, scratch});
        halo.gather({scratch});
        std::swap(values, scratch);
    }
}

// The divergence of the unit gradient, both by differences between centres and corners, which are adjoint.
struct CurvatureLoop {
    PressureFaces faces;
    CellBox cells;
    double dx;
    Array<double> fraction, curvature;

    KOKKOS_INLINE_FUNCTION void gradient(int at, int corner, double g[3]) const {
        for (int n = 0; n < (faces.dimensions == 2 ? 4 : 8); ++n) {
            int other = at;
            for (int a = 0; a < faces.dimensions; ++a) {
                other += ((corner >> a & 1) - 1 + (n >> a & 1)) * static_cast<int>(faces.stride[a]);
            }
            const double value = fraction(other);
            for (int a = 0; a < faces.dimensions; ++a) g[a] += n >> a & 1 ? value : -value;
        }
    }
    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const double least = 1e-12; // without dimension: nothing is near
        int c[3];
        cells.cell(i, c);
        const int at = faces.window.index(c[0], c[1], c[2]);
        double sum = 0;
        for (int corner = 0; corner < (faces.dimensions == 2 ? 4 : 8); ++corner) {
            double g[3] = {0, 0, 0};
            gradient(at, corner, g);
            const double size = math::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
            if (!(size > least)) continue;
            for (int a = 0; a < faces.dimensions; ++a) sum -= (corner >> a & 1 ? g[a] : -g[a]) / size;
        }
        curvature(at) = sum / ((faces.dimensions == 2 ? 2 : 4) * dx);
    }
};

// From the curvatures after both smoothings to that without any, on the surface.
struct SurfaceLoop {
    PressureFaces faces;
    CellBox cells;
    double dx;
    double once_weight, twice_weight; // of the smoothed fractions, for the surface to lie where that of the liquid does
    Array<double> once, twice, curvature, of_twice;

    KOKKOS_INLINE_FUNCTION double fraction(int at) const { return once_weight * once(at) + twice_weight * twice(at); }
    KOKKOS_INLINE_FUNCTION double distance(int at) const { // [dx]
        double slope2 = 0;
        for (int a = 0; a < faces.dimensions; ++a) {
            const int s = static_cast<int>(faces.stride[a]);
            const double slope = 0.5 * (fraction(at + s) - fraction(at - s));
            slope2 += slope * slope;
        }
        const double least = 1e-6;
        return math::max(-farthest, math::min((0.5 - fraction(at)) / math::max(math::sqrt(slope2), least), farthest));
    }
    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        int c[3];
        cells.cell(i, c);
        const int at = faces.window.index(c[0], c[1], c[2]);
        const double most = (faces.dimensions - 1) / dx; // that of a drop of one cell
        const double without =
            (second_variance * curvature(at) - first_variance * of_twice(at)) / (second_variance - first_variance);
        const double value = math::max(-most, math::min(without, most));
        curvature(at) = value + value * value / (faces.dimensions - 1) * dx * distance(at);
    }
};

// Liquid that is continued into solids, in cells, as the linear weights of particles would spread it.
void liquid_in_solids(CellHalo& halo, const PressureFaces& faces, const Fractions& fractions, Array<double>& out,
    Array<double>& scratch) {
    const CellBox owned = halo.owned();
    const auto more = out, liquid = fractions.cell_liquid, wet = fractions.cell_liquid_clipped;
    Kokkos::deep_copy(more, 0.0);
    Kokkos::parallel_for(
        "treacle::liquid_in_solids", static_cast<int>(owned.size()), KOKKOS_LAMBDA(int i) {
            int c[3];
            owned.cell(i, c);
            const int at = faces.window.index(c[0], c[1], c[2]);
            more(at) = liquid(at) - wet(at);
        });
    halo.gather({out});
    smooth(halo, faces, 1, 0.125, out, scratch);
}
} // namespace

void Curvature::find(const MacGrid& grid, CellHalo& halo, Array<double>& fraction) {
    const auto faces = pressure_faces(halo.window(), grid.dimensions);
    const CellBox owned = halo.owned();
    const int cells = static_cast<int>(owned.size()), window_size = static_cast<int>(halo.window().size());
    for (auto* array : {&twice_, &scratch_, &curvature_, &curvature_twice_}) {
        reserve(*array, static_cast<std::size_t>(window_size));
        Kokkos::deep_copy(*array, 0.0);
    }
    halo.gather({fraction});
    smooth(halo, faces, passes, 0.25, fraction, scratch_);
    const auto once = fraction, copy = twice_;
    Kokkos::parallel_for(
        "treacle::copy_fraction", window_size, KOKKOS_LAMBDA(int i) { copy(i) = once(i); });
    smooth(halo, faces, passes, 0.25, twice_, scratch_);
    Kokkos::parallel_for("treacle::curvature", cells, CurvatureLoop{faces, owned, grid.dx, fraction, curvature_});
    Kokkos::parallel_for("treacle::curvature", cells, CurvatureLoop{faces, owned, grid.dx, twice_, curvature_twice_});
    // A surface moves by half its curvature times the variance, and slopes fall as the deviation rises.
    const double twice_weight = -1 / (std::sqrt(second_variance / first_variance) - 1);
    Kokkos::parallel_for("treacle::surface_curvature", cells,
        SurfaceLoop{
            faces, owned, grid.dx, 1 - twice_weight, twice_weight, fraction, twice_, curvature_, curvature_twice_});
    halo.gather({curvature_});
}

void Curvature::find(const Scene& scene) {
    auto& halo = scene.halo;
    const auto faces = pressure_faces(halo.window(), scene.grid.dimensions);
    const int window_size = static_cast<int>(halo.window().size());
    for (auto* array : {&fraction_, &twice_, &scratch_}) reserve(*array, static_cast<std::size_t>(window_size));
    liquid_in_solids(halo, faces, scene.fractions, twice_, scratch_);
    fluidity_sums(
        scene.grid, {scene.particles, scene.cells, scene.particle_mass}, halo.window(), 0, {fraction_, scratch_});
    const auto fraction = fraction_, more = twice_;
    const double mass = scene.density * std::pow(scene.grid.dx, 3);
    Kokkos::parallel_for(
        "treacle::liquid_fraction", window_size, KOKKOS_LAMBDA(int i) { fraction(i) = fraction(i) / mass + more(i); });
    find(scene.grid, halo, fraction_);
}

} // namespace treacle::grid
