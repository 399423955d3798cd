#pragma once
#include "sph/solids/bodies.hpp"
#include "sph/viscosity/operator/viscous_scene.hpp"

#include <span>

namespace treacle::sph {

// Dynamic bodies as unknowns beside the particles of the viscous system. Their velocities are V* + L q, with
// the columns L of m M^-1 = L L^T, m being a particle's mass and M^-1 the bodies' response to impulses with
// their joints and locked degrees of freedom: what cannot move has no column. (V - V*) M (V - V*) / 2m is q.q
// / 2, so that
//   q - L^T (dt/m) F(u, V* + L q) = 0
// are rows of the same symmetric positive definite system as those of the particles. Every rank has all of q
// and does the same arithmetic on it.
class ViscousBodies {
public:
    // For the poses of the bodies. Without dynamic ones, or with `coupling: weak`, there is no
    // unknown.
    void prepare(const Bodies& bodies, const ViscousScene& scene);

    // Columns of L, the same on every rank.
    std::size_t unknowns() const { return columns_.size(); }
    bool any() const { return !columns_.empty(); }

    // L q for the loops over pairs, or the bodies' own motion and L q; valid until the next call.
    const Array<double>& trial(std::span<const double> q);
    const Array<double>& moved(const Bodies& bodies, std::span<const double> q);
    // L^T F of loads of all solids.
    std::vector<double> project(std::span<const double> loads) const;

    // The stiffness by which particles resist the bodies' motion, as far as it precondition: `stiffness` has 36 numbers a
    // solid.
    void factorise(std::span<const double> stiffness);
    std::vector<double> precondition(std::span<const double> r) const;

    std::size_t bytes() const { // of this rank [bytes]
        return sizeof(double) *
               (motion_.span() + factor_.capacity() + (columns_.empty() ? 0 : columns_.size() * columns_[0].size()));
    }

private:
    std::size_t first_ = 0, count_ = 0;        // first body among the solids, solids
    std::vector<std::vector<double>> columns_; // of L, 6 numbers a body
    std::vector<double> factor_;               // Cholesky, lower, row by row
    Array<double> motion_{"treacle::trial_motion", 0};
};

} // namespace treacle::sph
