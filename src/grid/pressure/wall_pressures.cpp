#include "grid/pressure/wall_pressures.hpp"

namespace treacle::grid {

namespace {
struct ContinueLoop {
    CellBox window, owned;
    std::ptrdiff_t stride[3];
    int dimensions;
    double dx, gravity[3];
    Array<double> known, from, to, solid;

    // Adds what the cells in the direction d make of the pressure here.
    KOKKOS_INLINE_FUNCTION void look(std::ptrdiff_t i, const int d[3], double& sum, int& count) const {
        std::ptrdiff_t step = 0;
        double weight = 0;
        for (int k = 0; k < dimensions; ++k) {
            step += d[k] * stride[k];
            weight -= d[k] * gravity[k] * dx;
        }
        const auto next = i + step, second = next + step;
        if (!(known(next) > 0)) return;
        sum += known(second) > 0 ? 2 * from(next) - from(second) : from(next) + weight;
        ++count;
    }
    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int c[3];
        owned.cell(n, c);
        const std::ptrdiff_t i = window.index(c[0], c[1], c[2]);
        if (known(i) > 0 || !(solid(FineNodes::per_cell * i + (dimensions == 2 ? 3 : 7)) < 0)) return;
        double sum = 0;
        int count = 0;
        for (int k = 0; k < dimensions; ++k) {
            for (int side = -1; side <= 1; side += 2) {
                int d[3] = {0, 0, 0};
                d[k] = side;
                look(i, d, sum, count);
            }
        }
        const int deep = dimensions == 3 ? 1 : 0;
        for (int z = -deep; z <= deep && count == 0; ++z) { // in corners
            for (int y = -1; y <= 1; ++y) {
                for (int x = -1; x <= 1; ++x) {
                    const int d[3] = {x, y, z};
                    if (x != 0 || y != 0 || z != 0) look(i, d, sum, count);
                }
            }
        }
        if (count > 0) to(i) = sum / count;
    }
};
} // namespace

// Marks cells that have a pressure of their own; cells of the halo as well.
void WallPressures::mark(const Scene& scene) {
    const CellBox window = scene.halo.window(), owned = scene.halo.owned();
    const auto n = static_cast<std::size_t>(window.size());
    for (auto* array : {&shown_, &known_, &copy_}) {
        reserve(*array, n);
        Kokkos::deep_copy(*array, 0.0);
    }
    const auto known = known_, copy = copy_, pressures = scene.pressures;
    const auto row = scene.system.row_of();
    Kokkos::parallel_for(
        "treacle::mark_pressures", static_cast<int>(owned.size()), KOKKOS_LAMBDA(int i) {
            int c[3];
            owned.cell(i, c);
            const int at = window.index(c[0], c[1], c[2]);
            known(at) = row(at) >= 0 ? 1 : 0;
            copy(at) = pressures(at);
        });
    scene.halo.gather({copy_, known_});
}

void WallPressures::find(const Scene& scene) {
    mark(scene);
    const CellBox window = scene.halo.window(), owned = scene.halo.owned();
    const auto all = Kokkos::make_pair(std::size_t(0), static_cast<std::size_t>(window.size()));
    Kokkos::deep_copy(Kokkos::subview(shown_, all), Kokkos::subview(copy_, all));
    ContinueLoop loop{window, owned, {1, 1, 1}, scene.grid.dimensions, scene.grid.dx,
        {scene.gravity[0], scene.gravity[1], scene.gravity[2]}, known_, copy_, shown_, scene.solids.distance()};
    for (int k = 1; k < 3; ++k) loop.stride[k] = loop.stride[k - 1] * (window.hi[k - 1] - window.lo[k - 1]);
    Kokkos::parallel_for("treacle::continue_pressures", static_cast<int>(owned.size()), loop);
    scene.halo.gather({shown_});
}

} // namespace treacle::grid
