#pragma once
#include "sph/viscosity/operator/viscous_scene.hpp"

namespace treacle::sph {

// The support of the kernel in the viscous sums [m]: that of all others, but for the corrected form, whose gradients are
// exact for linear velocities with fewer neighbours as well (src/sph/theory.md, Implicit viscosity).
double viscous_support(const SphOptions& options, double spacing);

// Those of a step's pairs that are within the support of the viscous sums, in the same order.
class NearPairs {
public:
    // The scene with these pairs and this support, which refers to this object until the next call; the scene as it is where all
    // sums have one support. Local.
    ViscousScene among(const ViscousScene& scene);

    std::size_t bytes() const; // of this rank [bytes]

private:
    Neighbourhood near_;
    Constants constants_;
    Array<std::uint8_t> masks_{"treacle::near_masks", 0};
};

} // namespace treacle::sph
