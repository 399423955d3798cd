#pragma once
#include "app/render/frame_set.hpp"
#include "identify/material/shear_rates.hpp"
#include "mpi/comm.hpp"

namespace treacle::app {

// Shear rates of the liquid of one run [1/s].
struct RunShearRates {
    identify::ShearRates all;                      // of all frames but the first
    std::vector<identify::FrameShearRates> frames; // of those that dissipate
};

// Shear rates sqrt(2 D:D) of a run's liquid over its frames but the first, from the velocities of some 2000 particles a frame and
// those around them, weighted by what they dissipate per volume. Collective; the same on all ranks. Empty for frames without
// velocities.
RunShearRates run_shear_rates(const Comm& comm, const RunView& run);

} // namespace treacle::app
