#pragma once
#include "grid/geometry/solids.hpp"

namespace treacle::grid {

// Centres of the solid parts of faces. A motion that leads along a solid's surface takes nothing out of a cell: sum
// over the faces of the closed areas times the velocity is then zero for any linear velocity, but only with that
// velocity at the centres of the solid parts (the rest of their border is the surface).
class ClosedCentres {
public:
    // Local, of all faces of the solids' window that have their parts in it; nothing is done where the distances are those of the last call.
    void find(const Solids& solids);
    // `solid`: distances at the fine nodes [m].
    void find(const FineNodes& nodes, const Array<double>& solid);
    // [window] from the middle of the faces across `axis`, along axis + 1 + k (k = 0, 1) [cells].
    const Array<double>& offset(int axis, int k) const { return offset_[axis][k]; }
    std::size_t bytes() const;

private:
    Array<double> offset_[3][2];
    std::int64_t changes_ = -1; // Solids::changes() of the offsets
    Array<int> sides_{"treacle::sides_of_solids", 0};
};

} // namespace treacle::grid
