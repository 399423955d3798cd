#pragma once
#include "sph/viscosity/operator/interface_law.hpp"

namespace treacle::sph {

// The particles of a ViscousOperator that have neighbours of another viscosity, and what their pairs read of them: fields of owned
// particles and ghosts, declared when there first are any.
struct ViscousInterface {
    bool any = false; // on any rank
    int count = 0;
    Array<int> rows{"treacle::interface_rows", 0};          // [count] owned particles
    InterfaceShapes shapes{"treacle::interface_shapes", 0}; // [count]
    int normal = -1, tilted = -1, across[3] = {-1, -1, -1};
    ViscousContrast contrast;

    // Memory of this rank [bytes].
    std::size_t bytes() const { return sizeof(int) * rows.span() + sizeof(double) * shapes.span(); }
};

} // namespace treacle::sph
