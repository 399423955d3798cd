#pragma once
#include "identify/report/report_pictures.hpp"

namespace treacle::identify {

// The film of an experiment with the contours of film and run, by files in the report's folder.
struct ReportFilm {
    std::string overlay; // NAME_contours.mp4: all compared frames at their times
    std::string
        rows; // NAME_rows.png: up to six frames side by side, below each other with their labels film, run, both contours, differences; with a
              // run at a measured curve film, both runs, and the differences of each two of these
    bool has_film = false; // else the masks stand in its place
};

// Video that a folder of masks was made from, by `treacle silhouettes` or `treacle film`; empty where it is no more there.
std::filesystem::path film_of(const std::filesystem::path& masks);

// Folders of the masks of runs.
struct FilmRuns {
    std::filesystem::path answer;
    std::filesystem::path at_curve; // empty: none
};

// Throws InputError and SimulationError.
ReportFilm write_film(
    const std::filesystem::path& folder, const StudyFile& file, const Experiment& experiment, const FilmRuns& runs);

} // namespace treacle::identify
