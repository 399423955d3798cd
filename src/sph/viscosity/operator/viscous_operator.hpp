#pragma once
#include "kokkos/float4x4.hpp"
#include "sph/model/symmetric.hpp"
#include "sph/viscosity/operator/viscous_interface.hpp"
#include "sph/viscosity/operator/viscous_walls.hpp"
#include "sph/viscosity/operator/wall_slip.hpp"

namespace treacle::sph {

// C u = u - dt/m f(u) on the owned particles, f being the viscous force (dissertation, chapter 4) in the form that
// `viscosity.form` names: matrix-free, and but for the published form symmetric and positive definite (src/sph/theory.md,
// Implicit viscosity). Of several liquids the first term has the relative density as a factor.
class ViscousOperator {
public:
    // Declares the fields that are exchanged. Slip lengths as in ForceOptions.
    // bulk: resistance of stretched liquid to expansion, over the viscosity; 0: none.
    explicit ViscousOperator(LiquidParticles& liquid, const std::vector<double>& slip_lengths = {}, double bulk = 0);

    // Collective: viscosities, gradient corrections and diagonal blocks for the present places and a step of dt [s].
    // Returns the largest dt/m V mu of all ranks [m2]; 0: C is the identity.
    double prepare(const ViscousContext& parts, double dt);

    // Motion of the solids: by `motion`, or none.
    enum class Walls { moving, resting };
    // Collective: product = C u of the owned particles. Gathers the ghosts' u.
    void multiply(const ViscousContext& parts, int u_field, Walls which, const Array3& product);

    // The same in single precision but for u itself: C u + O(1e-6) C u, in a third of the time. Of the symmetric
    // forms with gradients (`has_tiles`).
    void multiply_single_precision(const ViscousContext& parts, int u_field, Walls which, const Array3& product);
    static bool has_tiles(ViscosityForm form) {
        return form == ViscosityForm::corrected || form == ViscosityForm::adjoint;
    }

    // z = D^-1 r with the diagonal blocks, nearly.
    void precondition(const LiquidParticles& liquid, const Array3& r, const Array3& z) const;

    // This rank's share of the force and torque on each solid [N], [N m]. After a multiply with moving walls, whose u
    // it is for.
    BodyLoads loads(const ViscousContext& parts) const;
    // And of how the liquid would hold each solid if nothing else moved, times dt/m: 36 numbers each, roughly.
    std::vector<double> stiffness(const ViscousContext& parts) const;

    // Viscosities of the particles at the shear rates of the last multiply; forms with gradients only.
    void thin(const ViscousContext& parts, const Array<flow::ViscosityModel>& curves) const;

    // (S4e) Tension s of stretched liquid (augmented Lagrangian, Fortin & Glowinski 1983): s + zeta tr D of the last
    // multiply that the tension acted in; 0 of particles that are no longer stretched.
    // Pressures hold no liquid together, since they are not negative either.
    void keep_tension(const LiquidParticles& liquid) const;
    // No particle is under tension, as at the start of a run.
    void clear_tension(const LiquidParticles& liquid) const;
    // Force of the tension in products, which does not depend on u; with it they measure the expansion.
    void let_tension_act(bool acts) { tension_acts_ = acts && tension_ >= 0; }

    // After prepare(): B_i^+ of the owned particles, whose elements are those of sph::Symmetric; dt/m V mu of owned and ghost
    // particles [m2]; and the solids.
    const Array6& correction() const { return correction_; }
    const Array<float>& weights() const { return weights_; } // V0 |W'|/r of each pair in the list [1/m2]
    double damping() const { return damping_; }
    double max_viscous_coefficient() const { return max_viscous_coefficient_; } // of all ranks [m2]
    const Array<double>& viscous_coefficient(const LiquidParticles& liquid) const {
        return liquid.store.get<Array<double>>(viscous_coefficient_);
    }
    ViscousWalls walls(const ViscousContext& parts, Walls which) const;
    const WallSlip& slip() const { return slip_; }
    // Of the owned particles: what holds them but their neighbours, the mass and the solids, roughly; that of the diagonal block
    // where an inlet prescribes the velocity.
    const Array<float>& inertia_and_wall_diagonal() const { return inertia_and_wall_diagonal_; }
    // Half of their own share and half of the mean of their neighbours', whose stresses hold them as well: where viscosities jump, a
    // thin liquid follows a thick one as far as the support reaches.
    const Array<float>& smoothed_viscous_coefficient() const { return smoothed_viscous_coefficient_; }
    using Blocks = Kokkos::View<float* [6], Memory>;
    const Blocks& block() const { return block_; } // inverses of the diagonal blocks, nearly

    // The particles beside another viscosity; of the corrected form, where liquids differ.
    const ViscousInterface& interface() const { return interface_; }

    std::size_t bytes() const; // of this rank [bytes]

private:
    void find_stretched(const LiquidParticles& liquid, double bulk);
    Array<double> tension(const LiquidParticles& liquid) const; // or empty
    void prepare_interface(const ViscousContext& parts);
    template <class Stress>
    void stress_interface(const ViscousContext& parts, Walls which, int u_field, const Stress& stress);
    template <class Stress>
    void force_interface(
        const ViscousContext& parts, Walls which, int u_field, const Stress& stress, const Array3& product);
    void write_tiles(LiquidParticles& liquid, const Array<double>& viscous_coefficient, int dimensions);
    void exchange_tiles(const ViscousContext& parts, Walls which);
    void add_slip(const ViscousContext& parts, Walls which, const Array3& product) const;

    double dt_ = 0;
    double max_viscous_coefficient_ = 0;
    double damping_ = 0;           // of checkerboards, 0 for forms without gradients
    int stress_[3] = {-1, -1, -1}; // fields: columns of Q_i [m2/s]
    WallSlip slip_;
    Array<double> rate_{"treacle::shear_rate", 0}; // of owned particles [1/s], where a viscosity depends on it
    int tension_ = -1;                             // field, with `viscosity.bulk`: s / mu [1/s]
    bool tension_acts_ = false;
    Array<float> bulk_{"treacle::bulk_viscosity", 0}; // over the viscosity, of owned particles
    Array<double> trace_{"treacle::expansion", 0};    // tr D of the last multiply, of owned particles [1/s]
    int viscous_coefficient_ = -1;                    // field: dt/m V mu [m2]
    Array<float> weights_{"treacle::viscous_weights", 0};
    Array4 wall_sums_{"treacle::viscous_wall_sums", 0};    // see ViscousLoop
    Array6 correction_{"treacle::gradient_correction", 0}; // B_i^+
    Array<float> inertia_and_wall_diagonal_{"treacle::viscous_ground", 0},
        smoothed_viscous_coefficient_{"treacle::smoothed_viscous_coefficient", 0};
    Blocks block_{"treacle::viscous_block", 0};
    Array16 tiles_{"treacle::viscous_tiles", 0}; // see viscous_tiles.cpp
    Array8 rows_{"treacle::viscous_rows", 0}, fits_{"treacle::viscous_fits", 0};
    bool tiles_are_packed_ = false; // since prepare()
    ViscousInterface interface_;
};

} // namespace treacle::sph
