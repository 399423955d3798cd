#include "grid/closing.hpp"

#include "grid/seeding.hpp"

#include <cmath>

namespace treacle::grid {

namespace {
constexpr double overfilled = 0.02; // cells: what flows in beyond a cell's room without closing it
constexpr double depth = 0.5;      // widths, of the centre of a cell that closes

struct ClosingLoop {
    MacGrid grid;
    CellBox owned;
    PressureFaces faces;
    CellList cells;
    Array<double> fluid, distance, inflow;
    FaceField velocity;
    Array<int> number;
    BodyMotion motion;
    double full, dt; // particles in a cell; [s]

    KOKKOS_INLINE_FUNCTION int particles(const int c[3]) const {
        const int at = cells.window.index(c[0], c[1], c[2]);
        return cells.end(at) - cells.begin(at);
    }
    // What flows in through the lower (side 0) or upper face across an axis [m/s].
    KOKKOS_INLINE_FUNCTION double through(int a, int side, const int c[3], std::size_t face) const {
        const double open = faces.open(a, face);
        double flow = open * velocity.axis[a](face);
        if (open < 1) {
            int f[3] = {c[0], c[1], c[2]};
            f[a] += side;
            double x[3], v[3];
            grid.face(a, f, x);
            const int all = grid.dimensions == 2 ? 3 : 7;
            motion.velocity(number(FineNodes::per_cell * static_cast<int>(face) + (all & ~(1 << a))), x, v, false);
            flow += (1 - open) * v[a];
        }
        return side == 0 ? flow : -flow;
    }
    KOKKOS_INLINE_FUNCTION void operator()(int n, int& found) const {
        int c[3];
        owned.cell(n, c);
        const int i = faces.window.index(c[0], c[1], c[2]);
        if (faces.is_liquid(static_cast<std::size_t>(i)) || !(fluid(i) > 0)) return;
        double sum = 0;
        bool liquid = particles(c) > 0;
        for (int a = 0; a < grid.dimensions; ++a) {
            for (int side = 0; side < 2; ++side) {
                const auto face = static_cast<std::size_t>(i + side * faces.stride[a]);
                sum += through(a, side, c, face);
                int next[3] = {c[0], c[1], c[2]};
                next[a] += 2 * side - 1;
                liquid = liquid || (faces.open(a, face) > 0 && particles(next) > 0);
            }
        }
        if (!liquid) return;
        const double room = math::max(fluid(i) - particles(c) / full, 0.0);
        if (!(sum * dt / grid.dx > room + overfilled)) return;
        inflow(i) = room * grid.dx / dt;
        distance(i) = -depth * grid.dx;
        ++found;
    }
};
} // namespace

void Closing::clear(const CellHalo& halo) {
    reserve(inflow_, static_cast<std::size_t>(halo.window().size()));
    Kokkos::deep_copy(inflow_, -1.0);
}

bool Closing::find(const Comm& comm, const Scene& scene, double dt) {
    int found = 0;
    const CellBox owned = scene.halo.owned();
    if (!owned.empty()) {
        Kokkos::parallel_reduce("treacle::closing", static_cast<int>(owned.size()),
                                ClosingLoop{scene.grid, owned, scene.faces, scene.cells, scene.fractions.cell_fluid, scene.distance,
                                            inflow_, scene.velocity, scene.solids.number(), scene.solids.motion(),
                                            std::pow(particles_per_axis, scene.grid.dimensions), dt},
                                found);
    }
    if (!comm.any(found > 0)) return false;
    scene.halo.gather({scene.distance});
    return true;
}

} // namespace treacle::grid
