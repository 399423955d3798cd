#pragma once
#include "base/text/error.hpp"
#include "identify/experiment/sheet.hpp"
#include "mpi/comm.hpp"

#include <filesystem>

namespace treacle::app {

// Arguments of `treacle piv`.
struct PivRequest {
    std::filesystem::path run;    // folder of a run
    std::filesystem::path out;    // a folder
    identify::Sheet sheet;        // origin, right, up, window
    double width = 0, height = 0; // [m] of the grid of vectors, from the origin right and up
    double step = 0;              // [m] between vectors
    double first = 0, last = 0;   // [s]; last 0: the run's end
    double interval = 0;          // [s] between fields
    double noise = 0;             // standard deviation of a component over the largest speed
    double outliers = 0;          // share of the vectors that point anywhere
    double track_noise = 0;       // [m] of a body's path
    std::string track;            // the body whose path is written
    int seed = 1;                 // of noise and outliers; equal seeds give equal files
};

// `treacle piv`: the velocity fields that particle image velocimetry would measure in a sheet through a run: means over
// interrogation windows, with noise that overlapping windows share, outliers, and no vectors where a window touches a body.
// field_0000.csv, times.csv and track.csv. Collective; the root writes. Throws InputError, SimulationError.
ExitCode make_piv_fields(const Comm& comm, const PivRequest& request);

} // namespace treacle::app
