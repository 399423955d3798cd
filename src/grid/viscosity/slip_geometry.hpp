#pragma once
#include "grid/geometry/fractions.hpp"
#include "grid/geometry/level_set.hpp"
#include "grid/pressure/pressure_coupling.hpp"
#include "grid/viscosity/viscosity.hpp"

#include <vector>

namespace treacle::grid {

// Along which solids liquid slides.
struct SlipSetup {
    std::vector<scene::Slip> slip;   // [bodies]
    std::vector<double> slip_length; // [bodies] [m], by the slip's option
};

// Geometry of solids that liquid slides along, where there are any, for the viscous solve: the volume fractions of the
// no-slip solids alone, and the slip length near each cell.
class SlipGeometry {
public:
    // Sides of the domain have their slip in `domain`.
    SlipGeometry(const MacGrid& grid, const scene::Domain& domain, const SlipSetup& setup);

    bool any() const { return any_; } // liquid slides along some solid
    // Local. `solids`, the centres of their parts of faces and `liquid` are those of all solids, of the window of the halo.
    void update(const CellHalo& halo, const rigid::RigidBodies& bodies, const Solids& solids,
        const ClosedCentres& closed, const LevelSet& liquid, FractionMethod method);
    const SlipSolids& slip() const { return slip_; }
    const FaceBodyFractions& body_fractions() const { return body_fractions_; } // of no-slip bodies
    const Solids& no_slip() const { return no_slip_; }
    const FractionBuilder& no_slip_fractions() const { return builder_; }
    const Array<double>& lengths() const {
        return lengths_;
    } // [6 sides, then bodies] 0: no slip, infinity: does not hold [m]

private:
    void find_lengths(const Solids& solids);

    bool any_ = false;
    int dimensions_;
    Solids no_slip_;
    FractionBuilder builder_;
    SlipSolids slip_;
    FaceBodyFractions body_fractions_;
    Array<double> lengths_{"treacle::slip_lengths", 0}; // [6 sides, then bodies] 0: no slip [m]
};

} // namespace treacle::grid
