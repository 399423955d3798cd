#pragma once
#include "grid/geometry/open_flux.hpp"
#include "grid/mac/pressure_faces.hpp"
#include "mpi/cell_halo.hpp"
#include "rigid/bodies.hpp"

namespace treacle::grid {

class Pressure;
struct ViscousFaces;

// Resistance of cells to what flows out of them, stiffness (A u) A for the areas A of their faces, which adds to the viscous matrix
// where pressure and viscosity are solved together (U). In kernels.
struct VolumeStiffness {
    PressureFaces faces;     // of the pressure
    Array<double> stiffness; // [window] by a flux in face areas [kg/s]; none: no cell resists

    // True when any cell beside the face resists.
    KOKKOS_INLINE_FUNCTION bool resists(int a, std::ptrdiff_t i) const {
        return stiffness.extent(0) > 0 && faces.open(a, static_cast<std::size_t>(i)) > 0 &&
               (stiffness(i) > 0 || stiffness(i - faces.stride[a]) > 0);
    }
    // Row (a, i): use(b, j, entry) for each face j across b whose velocity a flux takes that takes that of face i, too; some come more than once.
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_entry(const OpenFlux& flux, int a, std::ptrdiff_t i, const Use& use) const {
        if (stiffness.extent(0) == 0) return;
        flux.each_taking(a, i, [&](std::ptrdiff_t through, double weight) {
            const double own = weight * faces.open(a, static_cast<std::size_t>(through));
            if (!(own > 0)) return;
            for (int side = 0; side < 2; ++side) {
                const std::ptrdiff_t cell = side == 0 ? through : through - faces.stride[a];
                if (stiffness(cell) > 0) each_in_flux(flux, cell, side, own, use);
            }
        });
    }
    // Of a flux `own` through side `side` of a cell: entries of the faces in the flux of that cell.
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_in_flux(
        const OpenFlux& flux, std::ptrdiff_t cell, int side, double own, const Use& use) const {
        for (int b = 0; b < faces.dimensions; ++b) {
            for (int end = 0; end < 2; ++end) {
                const std::ptrdiff_t j = cell + end * faces.stride[b];
                const double open = faces.open(b, static_cast<std::size_t>(j));
                if (!(open > 0)) continue;
                const double factor = side == end ? stiffness(cell) : -stiffness(cell);
                flux.each_taken(b, j,
                    [&](std::ptrdiff_t taken, double weight) { use(b, taken, factor * (own * (weight * open))); });
            }
        }
    }
};

// Pressure that a flux into a cell makes against the viscosity alone, by the resistance of its faces' own stresses; and
// as much again for the matrix to hold (src/grid/theory.md, U). Cells beside dynamic bodies have no such part, since
// the unknown motion of the body belongs to their flux.
class VolumeStresses {
public:
    // Collective, for the faces of the pressure's matrix and the stresses as they are. `face` [m2], of a 2D scene [m].
    void find(Pressure& pressure, const ViscousFaces& viscous, const OpenFlux& flux, const rigid::RigidBodies& bodies,
        CellHalo& halo, double face);

    const VolumeStiffness& stiffness() const { return stiffness_; } // for kernels, as of find()
    // [rows of the pressure] pressure by flux, the part that is in the matrix included [Pa s/m3].
    const Array<double>& by_row() const { return by_row_; }
    const Array<double>& stiffness_by_row() const { return stiffness_by_row_; } // that part alone
    std::size_t bytes() const {
        return 8 * (stiffness_.stiffness.span() + by_row_.span() + stiffness_by_row_.span()) + 4 * by_body_.span();
    }

private:
    VolumeStiffness stiffness_;
    Array<int> by_body_{"treacle::by_body", 0}; // [rows] 1 where a dynamic body contributes to the flux
    Array<double> by_row_{"treacle::pressure_by_flux", 0}, stiffness_by_row_{"treacle::stiffness_by_flux", 0};
};

} // namespace treacle::grid
