#pragma once
#include "kokkos/cells.hpp"
#include "kokkos/simd.hpp"

namespace treacle {

// The smallest block of space around some positions; starts with none.
struct Bounds {
    static constexpr double far = 1e300; // [m]; beyond all positions
    double lo[3] = {far, far, far};      // [m]
    double hi[3] = {-far, -far, -far};   // [m]

    // Grows the block to hold one position [m].
    KOKKOS_INLINE_FUNCTION void include(double x, double y, double z) {
        const double p[3] = {x, y, z};
        for (int k = 0; k < 3; ++k) {
            lo[k] = math::min(lo[k], p[k]);
            hi[k] = math::max(hi[k], p[k]);
        }
    }
    // The smallest block of cells that holds them: a position's cell never falls as the position rises.
    CellBox cells(const CellGrid& grid) const {
        CellBox box;
        if (lo[0] > hi[0]) return box;
        grid.locate(lo[0], lo[1], lo[2], box.lo);
        grid.locate(hi[0], hi[1], hi[2], box.hi);
        for (int& end : box.hi) ++end;
        return box;
    }
};

// visit(row, bounds, count) for the rows [first, last): returns the bounds of what the visits included, and adds to
// `count` what they added. On the host, rows go in runs whose bounds and count stay in registers.
template <class Visit>
Bounds reduce_bounds(const char* label, int first, int last, int& count, const Visit& visit) {
    constexpr int run = lanes == 1 ? 1 : 512;
    Bounds out;
    Kokkos::parallel_reduce(
        label, (last - first + run - 1) / run,
        KOKKOS_LAMBDA(int k, double& lx, double& ly, double& lz, double& hx, double& hy, double& hz, int& sum) {
            Bounds bounds;
            int added = 0;
            const int begin = first + k * run, end = math::min(begin + run, last);
            for (int i = begin; i < end; ++i) visit(i, bounds, added);
            lx = math::min(lx, bounds.lo[0]);
            ly = math::min(ly, bounds.lo[1]);
            lz = math::min(lz, bounds.lo[2]);
            hx = math::max(hx, bounds.hi[0]);
            hy = math::max(hy, bounds.hi[1]);
            hz = math::max(hz, bounds.hi[2]);
            sum += added;
        },
        Kokkos::Min<double>(out.lo[0]), Kokkos::Min<double>(out.lo[1]), Kokkos::Min<double>(out.lo[2]),
        Kokkos::Max<double>(out.hi[0]), Kokkos::Max<double>(out.hi[1]), Kokkos::Max<double>(out.hi[2]),
        Kokkos::Sum<int>(count));
    return out;
}

} // namespace treacle
