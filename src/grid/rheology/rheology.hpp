#pragma once
#include "flow/viscosity_model.hpp"
#include "grid/mac/body_motion.hpp"
#include "grid/mac/particles.hpp"
#include "grid/pressure/pressure_coupling.hpp"
#include "grid/transport/apic.hpp"
#include "grid/viscosity/step_strains.hpp"
#include "grid/viscosity/viscosity.hpp"
#include "kokkos/cells.hpp"

#include <vector>

namespace treacle::grid {

class RestingSolids;

// Input of a shear rate; arrays over the window of the halo.
struct StrainContext {
    const MacGrid& grid;
    CellHalo& halo;
    const Fractions& fractions;              // cell_liquid_clipped, edge_liquid_clipped
    const Fractions& no_slip_fractions;      // of the no-slip solids alone: cell_fluid, face_fluid, edge_fluid
    const FaceBodyFractions& body_fractions; // of no-slip bodies
    const BodyMotion& motion;
    const ViscosityOptions& options; // which stresses there are
    // Velocities that have been carried along straight lines since the middle of the last step strain by -carried (S) of what does
    // not strain; solids likewise.
    const StepStrains* strains = nullptr;
    double carried = 0;                     // length of the last step over that of this one
    const RestingSolids* resting = nullptr; // the no-slip ones, where sides of the domain move
};

// Viscosities that depend on the shear rate G = sqrt(2 D : D). The strains D are those of the viscous stresses (V1), each
// where its stress is: D v / W_F with the mean velocity v = W_F u + sum_b W_S R V of a face's cube, so that walls are where
// they are for the stresses. What another place needs is the mean of those beside it, by their liquid. Tags: README.md.
class Rheology {
public:
    // A curve for each liquid; none, or newtonian ones alone: no viscosity depends on the shear rate.
    explicit Rheology(std::vector<flow::ViscosityModel> curves);

    bool any() const { return any_; } // some curve depends on the shear rate

    // (R1) Local. Of owned centres and edges, for velocities that are current in the window. 0 where there is no stress.
    void compute_rates(const StrainContext& scene, const FaceField& velocity);
    // (R2) Collective. What the liquids of the particles around each centre and edge resist (R3), each with its viscosity at
    // the rate there; newtonian ones keep their own.
    void find_viscosities(const StrainContext& scene, const LiquidScene& liquids, Viscosities& out);
    // For frames: viscosities of the owned particles whose liquid has a curve, at the rate of their cell.
    void to_particles(const StrainContext& scene, const GridParticles& particles) const;

    const Array<double>& rate() const { return cell_rate_; }  // [window] of centres [1/s]
    const EdgeField& edge_rate() const { return edge_rate_; } // [1/s]
    std::size_t bytes() const;                                // of this rank [bytes]

    // Part of find_viscosities(); not private, since nvcc takes no kernel in a private function.
    void mean(const StrainContext& scene, const LiquidScene& liquids, int node, const Array<double>& rate,
        Array<double>& out);

private:
    std::vector<flow::ViscosityModel> curves_;
    bool any_ = false, any_newtonian_ = false;
    FaceField mean_velocity_;
    Array<double> normal_[3]; // [window] D_aa at centres [1/s]
    EdgeField shear_;         // 2 D_ab at edges [1/s]
    Array<double> cell_rate_{"treacle::shear_rate", 0};
    EdgeField edge_rate_;
    Array<double> mass_{"treacle::rheology_mass", 0}, sums_{"treacle::rheology_sums", 0},
        total_{"treacle::rheology_total", 0};
    Array<double> some_mass_{"treacle::particle_mass_of_one", 0}; // [liquids] all but one are zero
};

} // namespace treacle::grid
