#include "grid/geometry/density_relaxation.hpp"

#include "grid/geometry/seeding.hpp"
#include "grid/mac/small_matrix.hpp"

#include <cmath>

namespace treacle::grid {

namespace {
constexpr double whole = 1 - 1e-9; // share of a cell from which no solid cuts it
constexpr double strain = 0.125;   // in the least time that a step counts for
constexpr double fall = 1.0 / 32;  // of the width of a cell by gravity in that time

// Calls use(place, weight) for a cell and those around it, with weights 1, 2, 1 along each axis: by plain sums a lattice that
// turns would seem to become sparse and dense by some percent as its rows pass the sides of cells.
template <class Use>
KOKKOS_INLINE_FUNCTION void each_around(const int c[3], int dimensions, const CellBox& window, const Use& use) {
    const int deep = dimensions == 3 ? 1 : 0;
    for (int z = -deep; z <= deep; ++z) {
        for (int y = -1; y <= 1; ++y) {
            for (int x = -1; x <= 1; ++x) {
                use(window.index(c[0] + x, c[1] + y, c[2] + z), (2 - x * x) * (2 - y * y) * (2 - z * z));
            }
        }
    }
}

// Number of particles in each cell that has liquid on all sides, and that solids leave some room in.
struct WithinLoop {
    CellBox cells, window;
    int dimensions;
    CellList particles;
    Array<double> distance, fluid;
    Array<int> within;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        int c[3];
        cells.cell(i, c);
        const int at = window.index(c[0], c[1], c[2]);
        bool counts = fluid(at) > 0;
        each_around(c, dimensions, window, [&](int n, int) { counts = counts && distance(n) < 0; });
        const int in_list = particles.window.index(c[0], c[1], c[2]);
        within(at) = counts ? particles.end(in_list) - particles.begin(in_list) : -1;
    }
};

struct InflowLoop {
    CellBox owned, window;
    int dimensions;
    double full; // particles in a cell at rest
    double dead_band, steps, dx, dt;
    double falls; // 1/ the least time that a step counts for, by gravity [1/s]
    CellList particles;
    Array3 affine[3];
    Array<int> within;
    Array<double> fluid, inflow;

    KOKKOS_INLINE_FUNCTION SmallMatrix gradient(int particle) const {
        SmallMatrix out;
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) out.at[a][b] = affine[a](particle, b);
        }
        return out;
    }
    // 1/ the time that the step counts for: its own, or the least one by the strains and by gravity [1/s].
    KOKKOS_INLINE_FUNCTION double rate(const int c[3]) const {
        const int at = particles.window.index(c[0], c[1], c[2]), first = particles.begin(at), last = particles.end(at);
        if (first == last) return 1 / dt; // torn
        double sum = 0;
        for (int p = first; p < last; ++p) sum += 2 * gradient(p).strain_squares();
        return math::min(1 / dt, math::max(falls, math::sqrt(sum / (last - first)) / strain));
    }

    // Part of what is missing, or too much, that the dead band does not allow.
    KOKKOS_INLINE_FUNCTION double beyond(double missing) const {
        return missing - math::max(-dead_band, math::min(dead_band, missing));
    }

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        int c[3];
        owned.cell(i, c);
        const int at = window.index(c[0], c[1], c[2]);
        inflow(at) = 0;
        if (within(at) < 0 || fluid(at) < whole) return;
        int number = 0, cells = 0; // of whole cells
        double in_cut = 0, room_cut = 0;
        each_around(c, dimensions, window, [&](int n, int weight) {
            if (within(n) < 0) return;
            if (fluid(n) >= whole) {
                number += weight * within(n);
                cells += weight;
            } else {
                in_cut += weight * within(n);
                room_cut += weight * fluid(n);
            }
        });
        const double alone = beyond(1 - number / (full * cells));
        if (alone == 0) return;
        const double with_cut = beyond(1 - (number + in_cut) / (full * (cells + room_cut)));
        if (alone * with_cut <= 0) return;
        inflow(at) = dx / steps * rate(c) * (math::fabs(alone) < math::fabs(with_cut) ? alone : with_cut);
    }
};
} // namespace

void DensityRelaxation::find(const DensityRelaxationOptions& options, const Scene& scene, double dt) {
    const CellBox window = scene.halo.window(), owned = scene.halo.owned();
    const int dimensions = scene.grid.dimensions;
    reserve(within_, static_cast<std::size_t>(window.size()));
    reserve(inflow_, static_cast<std::size_t>(window.size()));
    if (owned.empty()) return;
    const CellBox around = grown(owned, 1, dimensions);
    Kokkos::parallel_for("treacle::within_liquid", static_cast<int>(around.size()),
        WithinLoop{around, window, dimensions, scene.cells, scene.distance, scene.fractions.cell_fluid, within_});
    const double full = std::pow(particles_per_axis, dimensions);
    const double dx = scene.grid.dx, falls = std::sqrt(scene.gravity / (2 * fall * dx));
    const auto& particles = scene.particles;
    Kokkos::parallel_for("treacle::density_relaxation", static_cast<int>(owned.size()),
        InflowLoop{owned, window, dimensions, full, options.dead_band, options.steps, dx, dt, falls, scene.cells,
            {particles.affine(0), particles.affine(1), particles.affine(2)}, within_, scene.fractions.cell_fluid,
            inflow_});
}

} // namespace treacle::grid
