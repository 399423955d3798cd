#pragma once
#include "grid/geometry/solids.hpp"
#include "grid/mac/pressure_faces.hpp"
#include "grid/pressure/pressure_coupling.hpp"
#include "kokkos/cells.hpp"
#include "mpi/cell_halo.hpp"

namespace treacle::grid {

// (K) Gaps that close within a step. A pressure that acts in the liquid alone is independent of the other side of a
// gap: liquid that meets a wall, liquid or a void overlaps it by all that it moves in the step, and a cell was found to
// take three times what it holds. A cell beyond the surface into which more flows than it has room for has a pressure
// of its own for the rest of the step, such that no more flows in than that; what backs up into the cell before it may
// close that one as well. This is the inequality of unilateral incompressibility, div u >= -room/dt, p >= 0 (Narain et
// al. 2010, Gerszewski & Bargteil 2013), cell by cell, found by solving again.
class Closing {
public:
    // Input of find() and release(); arrays are over the window of the halo.
    struct Scene {
        const MacGrid& grid;
        CellHalo& halo;
        const CellList& cells;      // of the particles
        const Fractions& fractions; // cell_fluid
        const Solids& solids;       // with the motion of the step
        const PressureFaces& faces; // with the distances below
        const FaceField& velocity;  // current around the owned faces, continued beyond the surface
        const Array<double>&
            distance;   // [window] of centres from the surface [m]; that of closing cells becomes negative
        SlipAreas slip; // of bodies that liquid slides along
    };
    // Local: no cell closes yet.
    void clear(const CellHalo& halo);
    // Collective: finds those that close within dt [s]. Returns whether there are more than before.
    bool find(const Comm& comm, const Scene& scene, double dt);
    // Collective: cells that would have to be pulled full, by their pressure [Pa], stay open for the rest of the step. Returns
    // whether there are any.
    bool release(const Comm& comm, const Scene& scene, const Array<double>& pressure);

    // [window] what may flow into a cell that closes, over a face's area [m/s]; below 0 of all others.
    const Array<double>& inflow() const { return inflow_; }
    std::size_t bytes() const {
        return sizeof(double) * (inflow_.span() + surface_.span() + factor_.span()) + sizeof(int) * occupied_.span();
    }

    // Part of find(); not private, since nvcc takes no kernel in a private function.
    void find_occupied(CellHalo& halo, const CellList& cells);

private:
    bool has_occupied_ = false; // in this step
    Array<double> inflow_{"treacle::closing", 0};
    Array<double> surface_{"treacle::closing_surface", 0}; // [window] the distances before
    Array<double> factor_{"treacle::closing_factor", 0};   // [window] of what flows into a cell, what it has room for
    Array<int> occupied_{"treacle::occupied", 0};          // [window] 1: with particles
    FaceField backed_up_;
};

} // namespace treacle::grid
