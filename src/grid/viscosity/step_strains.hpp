#pragma once
#include "grid/geometry/solids.hpp"
#include "grid/mac/small_matrix.hpp"
#include "mpi/cell_halo.hpp"

namespace treacle::grid {

// (S) Strains of a step along straight lines beyond the rates at its middle. Particles move by x += dt u with velocities
// of the middle of the step at places of its beginning. Their gradient there is L (I - dt/2 L)^-1 where L is that at the places
// of the middle, so that a rotation has the strain rate -dt/2 w^2 across its axis, and a step that solves for div u = 0 and
// for rates without it would let whatever turns grow. The pressure and the viscosity hold div u and the strain rates to
// these in the place of zero. L is that of the step before.
//
// What flows along a solid bends with it, a = L (u - U) + w x (u - V) in the frame that moves with the solid (U: its velocity
// there, w: its spin, V: of its centre), and its straight step leads off the surface by dt a/2. The flux of that through the
// open parts of a cell's faces flows in; of a whole cell it is the trace of the rates, whatever the frame.
class StepStrains {
public:
    // Input of find(); arrays are over the window of the halo.
    struct Scene {
        const MacGrid& grid;
        const CellHalo& halo;
        const FaceField& velocity; // that particles brought along, at their present places
        const FaceField& mass;     // faces with a mass have one
        const Fractions& fractions;
        const Solids& solids;      // with the motion of the step
        double before = 0, dt = 0; // [s] length of the step before and of this one
        // [6 sides, then bodies] slip lengths: liquid that slides along a solid is not strained as that is.
        Array<double> slip;
    };
    // Local, within the window of the halo but its two outermost layers.
    void find(const Scene& scene);
    // Adds what must flow into the owned cells for that, through the parts of their faces that are open, to `inflow`
    // ([window], over a face's area [m/s]).
    void add_flux(const MacGrid& grid, const CellHalo& halo, const FaceField& open, const Array<double>& inflow) const;

    const Array<double>& normal(int axis) const { return normal_[axis]; } // [window] at centres [1/s]
    const EdgeField& shear() const { return shear_; }                     // twice the shear strain, at edges [1/s]
    std::size_t bytes() const;                                            // of this rank [bytes]

private:
    Array<double> centre_[6]; // xx, yy, zz, xy, yz, zx
    Array<double> normal_[3];
    Array<double> path_[6]; // dt a/2 at the centre [m/s], and how each component rises along its own axis [1/s]
    EdgeField shear_;
};

} // namespace treacle::grid
