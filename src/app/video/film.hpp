#pragma once
#include "app/input/folder_under_way.hpp"
#include "base/text/error.hpp"
#include "mpi/comm.hpp"
#include "video/clip/clip_writer.hpp"
#include "video/film/film_look.hpp"
#include "video/film/film_raster.hpp"

#include <filesystem>
#include <string>

namespace treacle::app {

// Arguments of `treacle film`.
struct FilmRequest {
    std::filesystem::path run;                        // folder of a run
    std::string camera;                               // see find_camera
    std::vector<std::string> see_through;             // names of bodies
    std::filesystem::path out;                        // folder; default: film in the run's folder
    ExistingFolder existing = ExistingFolder::refuse; // treatment of `out` when it holds something
    video::ClipCodec codec = video::ClipCodec::h264;  // the clip's name follows: film.mp4, or film.mkv for ffv1
    double quality = 16;                              // of H.264
    double rate = 30;                                 // frames a second of true time [1/s]
    double jitter = 0;                                // random part of each interval, relative: a variable rate
    std::string
        time_map; // the file's stamps over true times, see video::TimeMap; frames lie at a steady rate of stamps then
    double lead = 1;              // of the empty scene before the run starts [s]
    double still = 0;             // of the liquid at rest in its first frame [s]
    double first = -1, last = -1; // of the run's times that are filmed [s]; -1: from its start, to its end
    double phase = 0;             // of the frames against the run's start, in intervals: 0 to 1
    int turned = 0;               // clockwise, by the display matrix [deg]
    video::FilmLook look;         // width and height are set to those of the camera
    video::FilmShot shot;         // exposure, samples and colour of the liquid
};

// `treacle film`: film.mp4 (.mkv), mask_000000.png and on (0 background, 255 liquid), film.csv with the times, film.json, all or
// nothing. Collective; each rank draws some of the frames, rank 0 writes. Throws InputError, SimulationError.
ExitCode film_run(const Comm& comm, const FilmRequest& request);

} // namespace treacle::app
