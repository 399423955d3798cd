#pragma once
#include "identify/report_pictures.hpp"

#include <optional>

namespace treacle::identify {

// The film of an experiment with the contours of film and run, by files in the report's folder.
struct ReportFilm {
    std::string overlay; // NAME_contours.mp4: all compared frames at their times
    std::string rows;    // NAME_rows.png: up to six frames side by side; film, run, both contours, differences below each other
    bool has_film = false; // else the masks stand in its place
};

// Video that a folder of masks was made from, by `treacle silhouettes` or `treacle film`; empty where it is no more there.
std::filesystem::path film_of(const std::filesystem::path& masks);

// `run` holds masks_NAME/. Nothing where the run did not keep its masks. Throws InputError and SimulationError.
std::optional<ReportFilm> write_film(const std::filesystem::path& folder, const StudyFile& file, const Experiment& experiment, const std::filesystem::path& run);

} // namespace treacle::identify
