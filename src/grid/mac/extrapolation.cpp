#include "grid/mac/extrapolation.hpp"

namespace treacle::grid {

void mark_faces(const MacGrid& grid, const CellBox& window, const FaceField& field, double least, FaceValidity& known) {
    for (int a = 0; a < grid.dimensions; ++a) {
        reserve(known.axis[a], static_cast<std::size_t>(window.size()));
        const auto mark = known.axis[a];
        const auto value = field.axis[a];
        Kokkos::parallel_for(
            "treacle::mark_faces", static_cast<int>(window.size()),
            KOKKOS_LAMBDA(int i) { mark(i) = value(i) > least ? 1 : 0; });
    }
}

namespace {
// The cells of a window that have an owner: those of the block and their images.
struct Block {
    CellBox active;
    int period[3]; // cells, 0: none
    int dimensions;

    KOKKOS_INLINE_FUNCTION bool contains(int c[3]) const {
        for (int k = 0; k < dimensions; ++k) {
            if (period[k] > 0) c[k] = (c[k] % period[k] + period[k]) % period[k];
        }
        return active.contains(c);
    }
};

void add_layer(const CellBox& window, const Block& block, int layer, const Array<double>& u, const Array<int>& known) {
    const int dimensions = block.dimensions;
    Kokkos::parallel_for(
        "treacle::extrapolate", static_cast<int>(window.size()), KOKKOS_LAMBDA(int i) {
            if (known(i) != 0) return;
            int c[3];
            window.cell(i, c);
            int stride = 1, count = 0;
            double sum = 0;
            for (int k = 0; k < dimensions; ++k) {
                for (int up = 0; up < 2; ++up) {
                    if (up ? c[k] + 1 >= window.hi[k] : c[k] <= window.lo[k]) continue;
                    const int j = i + (up ? stride : -stride);
                    // Values that this layer itself finds do not count.
                    if (known(j) == 0 || known(j) > layer) continue;
                    sum += u(j);
                    ++count;
                }
                stride *= window.hi[k] - window.lo[k];
            }
            if (count == 0 || !block.contains(c)) return;
            u(i) = sum / count;
            known(i) = layer + 1;
        });
}

void gather_faces(const MacGrid& grid, CellHalo& halo, const FaceField& velocity, const FaceValidity& known) {
    if (grid.dimensions == 2) {
        halo.gather({velocity.axis[0], velocity.axis[1]});
        halo.gather({known.axis[0], known.axis[1]});
    } else {
        halo.gather({velocity.axis[0], velocity.axis[1], velocity.axis[2]});
        halo.gather({known.axis[0], known.axis[1], known.axis[2]});
    }
}
} // namespace

void extrapolate(const MacGrid& grid, CellHalo& halo, FaceField& velocity, FaceValidity& known, int layers) {
    Block block{halo.active(), {0, 0, 0}, grid.dimensions};
    for (int k = 0; k < 3; ++k) block.period[k] = grid.cells.periodic(k) ? grid.cells.count[k] : 0;
    gather_faces(grid, halo, velocity, known);
    // Each layer is right in one layer of halo less than the one before.
    int right = halo.layers();
    for (int layer = 1; layer <= layers; ++layer) {
        if (right == 0) {
            gather_faces(grid, halo, velocity, known);
            right = halo.layers();
        }
        for (int a = 0; a < grid.dimensions; ++a)
            add_layer(halo.window(), block, layer, velocity.axis[a], known.axis[a]);
        --right;
    }
    gather_faces(grid, halo, velocity, known);
}

} // namespace treacle::grid
