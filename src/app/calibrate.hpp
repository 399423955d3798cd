#pragma once
#include "base/error.hpp"
#include "mpi/comm.hpp"

#include <string>
#include <vector>

namespace treacle::app {

// What the command line gives; texts are read by calibrate_camera().
struct CalibrateRequest {
    std::vector<std::string> pictures; // of the board: files, folders
    std::string board = "9x6";         // see video::read_board
    std::string square;                // side of a square, or distance of circles, with its unit
    int coefficients = 5;              // of the distortion: 0, 4, 5, 8
    int window = 0;                    // [pixels] see video::BoardSearch
    double outliers = 3;               // see video::CalibrationOptions::outlier_factor
    std::string camera_name = "main";
    std::string out = "camera.yaml";
};

// `treacle calibrate`: the lens of a camera from pictures of a board. Writes the camera's file and beside it
// NAME_coverage.png and NAME_pictures.csv. Collective; rank 0 works. Throws InputError.
ExitCode calibrate_camera(const Comm& comm, const CalibrateRequest& request);

} // namespace treacle::app
