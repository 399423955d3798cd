#pragma once
#include "grid/geometry/solids.hpp"
#include "grid/mac/particles.hpp"

namespace treacle::grid {

// Solids that mirror particles: bodies alone, or the sides of the domain as well.
enum class MirroredIn { bodies, all_solids };

// Writes the field `image` of all particles, ghosts too: the mirror image in the nearest solid of those nearer to it
// than `reach` [m], and MirrorParticles::none where there is none.
struct MirrorParticles {
    static constexpr double none = 1e100; // [m]
    static void find(const GridParticles& particles, const DistanceSampler& solid, const Array<int>& number,
        MirroredIn which, double cutoff);
};

} // namespace treacle::grid
