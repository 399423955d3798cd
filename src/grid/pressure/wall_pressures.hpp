#pragma once
#include "grid/geometry/solids.hpp"
#include "grid/pressure/pressure_system.hpp"

namespace treacle::grid {

// The pressures that particles show (A7). At the centres of cells in solids, beside such with a pressure, they go on linearly from
// two cells in a row, or by the weight of the liquid from one: what is interpolated between the two is the liquid's own up to
// the surface of the solid. Elsewhere they are those of the cells, 0 outside of the liquid.
class WallPressures {
public:
    // Input of find().
    struct Scene {
        const MacGrid& grid;
        CellHalo& halo;
        const PressureSystem& system;
        const Solids& solids;
        const Array<double>& pressures; // [window] of owned cells [Pa]
        double gravity[3];              // times the density [Pa/m]
    };
    // Collective.
    void find(const Scene& scene);
    const Array<double>& at_centres() const { return shown_; } // [window], halo as well [Pa]
    std::size_t bytes() const { return 8 * (shown_.span() + known_.span()); }

    // Part of find(); not private, since nvcc takes no kernel in a private function.
    void mark(const Scene& scene);

private:
    Array<double> shown_{"treacle::shown_pressures", 0}, known_{"treacle::known_pressures", 0};
    Array<double> copy_{"treacle::copied_pressures", 0};
};

} // namespace treacle::grid
