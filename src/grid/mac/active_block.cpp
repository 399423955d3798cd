#include "grid/mac/active_block.hpp"

#include <cmath>
#include <limits>
#include <span>

namespace treacle::grid {

namespace {
constexpr int step = 4; // cells that the block grows and shrinks by

int rounded_down(int c) { return step * static_cast<int>(std::floor(double(c) / step)); }
} // namespace

CellBox active_block(const Comm& comm, const MacGrid& grid, const CellBox& occupied, int band) {
    constexpr auto none = std::numeric_limits<std::int64_t>::min() / 2;
    std::int64_t ends[6]; // upper ends, and lower ones with the other sign
    for (int k = 0; k < 3; ++k) {
        ends[k] = occupied.empty() ? none : occupied.hi[k];
        ends[3 + k] = occupied.empty() ? none : -std::int64_t(occupied.lo[k]);
    }
    comm.max(std::span(ends));
    CellBox block;
    if (ends[0] == none) return block;
    const CellBox all = grid.cells.all();
    for (int k = 0; k < 3; ++k) {
        if (k >= grid.dimensions) {
            block.hi[k] = all.hi[k];
            continue;
        }
        block.lo[k] = rounded_down(static_cast<int>(-ends[3 + k]) - band);
        block.hi[k] = -rounded_down(-static_cast<int>(ends[k]) - band);
        // A part that reaches over the border of a periodic axis goes on at its other end.
        const bool around = grid.cells.periodic(k) && (block.lo[k] < all.lo[k] || block.hi[k] > all.hi[k]);
        if (around || block.lo[k] < all.lo[k]) block.lo[k] = all.lo[k];
        if (around || block.hi[k] > all.hi[k]) block.hi[k] = all.hi[k];
    }
    return block;
}

} // namespace treacle::grid
