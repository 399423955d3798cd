#pragma once
#include "base/text/vec3.hpp"
#include "grid/mac/mac_grid.hpp"
#include "grid/pressure/pressure_system.hpp"
#include "mpi/cell_halo.hpp"

#include <span>

namespace treacle::grid {

// (L) Liquid that separates from walls above it. A pressure solve holds liquid to every wall, by pressures below that
// of the air where need be. Full cells under a wall whose pressure is negative become cells beyond the surface for the
// rest of the step: their pressure is zero and they may widen, but not take in more than they hold, which (K) ensures.
// This is the complementarity p >= 0, div u >= 0 (Batty, Bertails & Bridson 2007, for walls), of cells under walls from
// which gravity pulls: what moves in the liquid sucks at other walls, and there the pressure of the air holds them
// together.
class Separation {
public:
    // Input of find(); arrays are over the window of the halo.
    struct Scene {
        CellHalo& halo;
        const PressureSystem& system;
        const Array<double>& pressure; // [window] of owned cells [Pa]
        const Array<double>&
            distance; // [window] of centres from the surface [m]; that of separated cells becomes positive
        std::span<const int>
            closed; // [rows] -1: of a part of the liquid with a surface, others separate from nothing; none: no
                    // part is closed
        Vec3 gravity{0, 0, 0}; // [m/s2]
        double dx = 0;         // [m]
    };
    // Collective. Returns whether any cell separates that had not.
    bool find(const Comm& comm, const Scene& scene);
    // Local: no cell separates yet.
    void clear() { any_ = false; }
    // [window] 1: cells that have separated; no extent: there are none on any rank.
    Array<int> separated() const { return any_ ? separated_ : Array<int>(); }
    std::size_t bytes() const { return sizeof(int) * (closed_.span() + separated_.span()); }

private:
    bool any_ = false; // on any rank
    Array<int> separated_{"treacle::separated", 0};
    Array<int> closed_{"treacle::closed_rows", 0}; // [rows], of the scene
};

} // namespace treacle::grid
