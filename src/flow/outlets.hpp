#pragma once
#include "flow/inflow.hpp"

namespace treacle::flow {

// Regions where particles are taken out, as kernels read them.
struct Outlets {
    Array<double> rows{"treacle::outlets", 0}; // [count][7] 1 for a box, then its corners, or a point and the normal
    int count = 0;
    int dimensions = 3;

    // True for a position [m] in a box, its faces included, or behind a plane.
    KOKKOS_INLINE_FUNCTION bool take(const double x[3]) const {
        for (int o = 0; o < count; ++o) {
            if (in_outlet(&rows(7 * o), x)) return true;
        }
        return false;
    }

private:
    KOKKOS_INLINE_FUNCTION bool in_outlet(const double* outlet, const double x[3]) const {
        if (outlet[0] == 0) {
            double along = 0;
            for (int k = 0; k < 3; ++k) along += (x[k] - outlet[1 + k]) * outlet[4 + k];
            return along < 0;
        }
        bool in = true;
        for (int k = 0; k < dimensions; ++k) in = in && x[k] >= outlet[1 + k] && x[k] <= outlet[4 + k];
        return in;
    }
};
// Copy to the device; with 2 dimensions boxes have no end in z.
Outlets make_outlets(const std::vector<OutletSetup>& outlets, int dimensions);

} // namespace treacle::flow
