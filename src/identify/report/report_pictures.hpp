#pragma once
#include "identify/experiment/study_file.hpp"
#include "video/mask/mask.hpp"
#include "video/picture/image.hpp"

#include <filesystem>

namespace treacle::identify {

// Two masks of one size: grey where both have liquid, blue where only the film has, red where only the run.
video::Image draw_differences(const video::Mask& film, const video::Mask& run);

// Pictures of masks side by side, as the film and the run show them, of up to six frames of each experiment: grey where both
// have liquid, blue where only the film has, red where only the run. NAME_000012.png in `folder`; returns their names with a
// caption each. `run` holds masks_NAME/ of each experiment. Throws InputError and SimulationError.
struct ReportPicture {
    std::string file, caption;
};
std::vector<ReportPicture> write_pictures(const std::filesystem::path& folder, const StudyFile& file,
    const Experiment& experiment, const std::filesystem::path& run);

} // namespace treacle::identify
