#pragma once
#include "base/losses.hpp"
#include "scene/scene.hpp"

namespace treacle::flow {

// Fate of liquid beyond a side of the domain, for kernels: LossCause::none where a wall or a period keeps it.
inline int beyond(const scene::Face& face) {
    if (face.kind != scene::BoundaryKind::open) return static_cast<int>(LossCause::none);
    return static_cast<int>(face.outflow ? LossCause::outflow : LossCause::open_side);
}

} // namespace treacle::flow
