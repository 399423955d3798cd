#include "grid/pressure/closing.hpp"

#include "grid/geometry/seeding.hpp"
#include "grid/transport/face_fields.hpp"

#include <cmath>

namespace treacle::grid {

namespace {
constexpr double open_cell = -1, released_cell = -2; // in the place of what flows in
constexpr double overfilled = 0.02;                  // cells: what flows in beyond a cell's room without closing it
constexpr double depth = 0.5;                        // widths, of the centre of a cell that closes
constexpr int most_cells = 3;                        // that liquid moves by in a step; the layers of the halo
constexpr int most_sweeps = 6; // cells that liquid may back up by: what both sides of a gap may move by in a step

struct ClosingLoop {
    MacGrid grid;
    CellBox owned;
    PressureFaces faces;
    CellList cells;
    Array<double> fluid, distance, surface, inflow, factor;
    FaceField velocity;
    Array<int> number, occupied;
    BodyMotion motion;
    MotionPoints points;
    double full, dt; // particles in a cell; [s]

    KOKKOS_INLINE_FUNCTION int particles(const int c[3]) const {
        const int at = cells.window.index(c[0], c[1], c[2]);
        return cells.end(at) - cells.begin(at);
    }
    // True when liquid may come here in a step: gaps between dry bodies close without a pressure.
    KOKKOS_INLINE_FUNCTION bool near_liquid(const int c[3]) const {
        int lo[3], hi[3];
        for (int k = 0; k < 3; ++k) {
            const int radius = k < grid.dimensions ? most_cells : 0;
            lo[k] = math::max(c[k] - radius, faces.window.lo[k]);
            hi[k] = math::min(c[k] + radius, faces.window.hi[k] - 1);
        }
        for (int z = lo[2]; z <= hi[2]; ++z) {
            for (int y = lo[1]; y <= hi[1]; ++y) {
                for (int x = lo[0]; x <= hi[0]; ++x) {
                    if (occupied(faces.window.index(x, y, z)) != 0) return true;
                }
            }
        }
        return false;
    }
    // Flux that a solid takes in through the closed part of the lower (side 0) or upper face across an axis [m/s].
    KOKKOS_INLINE_FUNCTION double by_solids(int a, int side, const int c[3], std::size_t face) const {
        const double open = faces.open(a, face);
        if (!(open < 1)) return 0;
        int f[3] = {c[0], c[1], c[2]};
        f[a] += side;
        double x[3], v[3];
        const int all = grid.dimensions == 2 ? 3 : 7;
        const int solid = number(FineNodes::per_cell * static_cast<int>(face) + (all & ~(1 << a)));
        points.at(solid, a, f, face, x);
        motion.velocity(solid, x, v, false);
        return (side == 0 ? 1 : -1) * (1 - open) * v[a];
    }
    KOKKOS_INLINE_FUNCTION void operator()(int n, int& found) const {
        int c[3];
        owned.cell(n, c);
        const int i = faces.window.index(c[0], c[1], c[2]);
        factor(i) = 1;
        if (inflow(i) == released_cell) return;
        const bool closes = inflow(i) >= 0;
        if ((!closes && faces.is_liquid(static_cast<std::size_t>(i))) || !(fluid(i) > 0)) return;
        double in = 0, rest = 0; // through open faces; what else flows in, without what flows out
        for (int a = 0; a < grid.dimensions; ++a) {
            for (int side = 0; side < 2; ++side) {
                const auto face = static_cast<std::size_t>(i + side * faces.stride[a]);
                const double flow = (side == 0 ? 1 : -1) * faces.open(a, face) * velocity.axis[a](face);
                (flow > 0 ? in : rest) += flow;
                rest += by_solids(a, side, c, face);
            }
        }
        const double room = math::max(fluid(i) - particles(c) / full, 0.0) * grid.dx / dt;
        if (!(in + rest > room + overfilled * grid.dx / dt) || !(closes || near_liquid(c))) return;
        factor(i) = in > 0 ? math::max(0.0, math::min(1.0, (room - rest) / in)) : 1.0;
        if (closes) return;
        inflow(i) = room;
        surface(i) = distance(i);
        distance(i) = -depth * grid.dx;
        ++found;
    }
};

// Faces lose what the cell behind them has no room for.
struct BackUpLoop {
    CellBox owned;
    PressureFaces faces;
    Array<double> factor;
    FaceField velocity;

    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int c[3];
        owned.cell(n, c);
        const int i = faces.window.index(c[0], c[1], c[2]);
        for (int a = 0; a < faces.dimensions; ++a) {
            double& u = velocity.axis[a](i);
            const auto behind = u > 0 ? i : i - faces.stride[a];
            u *= factor(behind);
        }
    }
};
} // namespace

void Closing::clear(const CellHalo& halo) {
    reserve(inflow_, static_cast<std::size_t>(halo.window().size()));
    Kokkos::deep_copy(inflow_, open_cell);
    has_occupied_ = false;
}

void Closing::find_occupied(CellHalo& halo, const CellList& cells) {
    const CellBox window = halo.window(), owned = halo.owned();
    reserve(occupied_, static_cast<std::size_t>(window.size()));
    reserve(surface_, static_cast<std::size_t>(window.size()));
    Kokkos::deep_copy(occupied_, 0);
    const auto occupied = occupied_;
    Kokkos::parallel_for(
        "treacle::occupied", static_cast<int>(owned.size()), KOKKOS_LAMBDA(int n) {
            int c[3];
            owned.cell(n, c);
            const int at = cells.window.index(c[0], c[1], c[2]);
            occupied(window.index(c[0], c[1], c[2])) = cells.end(at) > cells.begin(at) ? 1 : 0;
        });
    halo.gather({occupied_});
    has_occupied_ = true;
}

bool Closing::find(const Comm& comm, const Scene& scene, double dt) {
    const CellBox owned = scene.halo.owned();
    const int n = static_cast<int>(owned.size());
    if (!has_occupied_) find_occupied(scene.halo, scene.cells);
    reserve(factor_, static_cast<std::size_t>(scene.halo.window().size()));
    Kokkos::deep_copy(factor_, 1.0);
    ClosingLoop loop{scene.grid, owned, scene.faces, scene.cells, scene.fractions.cell_fluid, scene.distance, surface_,
        inflow_, factor_, scene.velocity, scene.solids.number(), occupied_, scene.solids.motion(),
        scene.slip.points(scene.grid), std::pow(particles_per_axis, scene.grid.dimensions), dt};
    bool any = false;
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        int found = 0;
        if (n > 0) Kokkos::parallel_reduce("treacle::closing", n, loop, found);
        if (!comm.any(found > 0)) break;
        if (!any) {
            copy_faces(scene.grid, scene.halo.window(), scene.velocity, backed_up_);
            loop.velocity = backed_up_;
        }
        any = true;
        scene.halo.gather({factor_});
        if (n > 0) Kokkos::parallel_for("treacle::back_up", n, BackUpLoop{owned, scene.faces, factor_, backed_up_});
        gather_faces(scene.grid, scene.halo, backed_up_);
    }
    if (any) scene.halo.gather({scene.distance});
    return any;
}

bool Closing::release(const Comm& comm, const Scene& scene, const Array<double>& pressure) {
    const CellBox owned = scene.halo.owned(), window = scene.halo.window();
    const auto inflow = inflow_, surface = surface_, distance = scene.distance;
    int found = 0;
    if (!owned.empty()) {
        Kokkos::parallel_reduce(
            "treacle::release", static_cast<int>(owned.size()),
            KOKKOS_LAMBDA(int n, int& sum) {
                int c[3];
                owned.cell(n, c);
                const int i = window.index(c[0], c[1], c[2]);
                if (!(inflow(i) >= 0) || !(pressure(i) < 0)) return;
                inflow(i) = released_cell;
                distance(i) = surface(i);
                ++sum;
            },
            found);
    }
    if (!comm.any(found > 0)) return false;
    scene.halo.gather({scene.distance});
    return true;
}

} // namespace treacle::grid
