#pragma once
#include "grid/pressure/resting_solids.hpp"
#include "grid/transport/face_fields.hpp"
#include "grid/viscosity/viscous_faces.hpp"

namespace treacle::grid {

// Momentum that solids at rest take from the liquid besides the pressures of P2, where these hold another mass than
// there is (W). At faces with the mass of the liquid m and the pressure's mass A theta, velocities that a projection
// changes by du leave -(m - A theta) du with the solids in the face's cube; those of closed faces, which no pressure
// holds, leave all of m du where A2 takes them. At the wall of a tank that is the weight of half a cell.
class WallMomentum {
public:
    // Input of add(); arrays are over the window.
    struct Scene {
        const MacGrid& grid;
        const CellBox& owned;
        const PressureFaces& faces;
        const Fractions& fractions;
        const RestingSolids& resting;
        double density; // [kg/m3]
        // Faces whose mass the viscous solve had do not count: held ones, and with the pressure in the same solve all with a mass.
        const ViscousFaces* viscous = nullptr;
        bool together = false;
    };
    // Clears all sums; for so many solids.
    void clear(std::size_t solids) { lost_.assign(6 * solids, 0.0); }
    // Resets to the start of the step, for a repeat.
    const std::vector<double>& lost() const { return lost_; }
    void go_back(const std::vector<double>& to) { lost_ = to; }
    // From here on changes count.
    void begin(const MacGrid& grid, const CellBox& window, const FaceField& velocity) {
        copy_faces(grid, window, velocity, before_);
    }
    enum class Which { with_pressure, closed }; // faces
    // Local: adds what the changes since begin() have left at these faces.
    void add(const Scene& scene, Which which, const FaceField& velocity);
    // Collective: the loads that this is in dt, 6 numbers a solid [N], [N m], in 2D per metre.
    std::vector<double> loads(const Comm& comm, double dt) const;
    std::size_t bytes() const { return 8 * (before_.axis[0].span() + before_.axis[1].span() + before_.axis[2].span()); }

private:
    FaceField before_;
    std::vector<double> lost_; // [solids * 6] of this rank [N s], [N m s]
};

} // namespace treacle::grid
