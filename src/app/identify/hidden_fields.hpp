#pragma once
#include "base/text/log.hpp"
#include "identify/answer/identification.hpp"
#include "identify/report/report_pictures.hpp"

#include <functional>

namespace treacle::app {

// Pressure and speed of the liquid at the trial that is most alike, which no film shows: four frames of each scene,
// drawn as the surface in its camera's picture, into `folder`. A run that has not kept its frames is done again. Names
// are those in the folder, with a caption each. What fails is logged, and left out. For a process without MPI.
std::vector<identify::ReportPicture> draw_hidden_fields(const std::filesystem::path& folder,
    const identify::StudyFile& file, const identify::Identification& found,
    const std::function<std::filesystem::path(std::int64_t)>& folder_of, Log& log);

} // namespace treacle::app
