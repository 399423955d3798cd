#pragma once
#include "kokkos/types.hpp"

namespace treacle {

// A box with axes that may be periodic, as kernels need it.
struct PeriodicBox {
    double lo[3]{}, hi[3]{}; // [m]
    double period[3]{};      // [m], 0: not periodic
    double quantum = 0;      // positions along periodic axes are multiples of it [m]; 0: anything

    // Moves a point back into the box along periodic axes. Positions and periods being multiples of one quantum, a
    // particle and its image differ by the period exactly, and pair terms stay symmetric bit for bit.
    KOKKOS_INLINE_FUNCTION double wrap(int axis, double x) const {
        if (period[axis] == 0) return x;
        if (quantum > 0) x = math::floor(x / quantum + 0.5) * quantum;
        if (x < lo[axis]) x += period[axis];
        if (x >= hi[axis]) x -= period[axis];
        return x;
    }
};

} // namespace treacle
