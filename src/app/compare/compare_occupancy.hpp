#pragma once
#include "app/render/frame_set.hpp"
#include "identify/experiment/study_file.hpp"
#include "mpi/comm.hpp"

namespace treacle::app {

// Compares how often pixels are liquid in a finished run and in the masks of a film, over windows of time, and writes files as
// compare_with_film() does. Collective; each rank draws some of the frames.
void compare_occupancy(const Comm& comm, const identify::StudyFile& file, const identify::Experiment& experiment,
    const RunView& run, const std::filesystem::path& folder);

} // namespace treacle::app
