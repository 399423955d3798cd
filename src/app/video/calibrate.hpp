#pragma once
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <string>
#include <vector>

namespace treacle::app {

// Arguments of the command line; texts are read by calibrate_camera().
struct CalibrateRequest {
    // The lens: from pictures of a board, or from a camera file.
    std::vector<std::string> pictures; // files, folders
    std::string camera;                // FILE or FILE:NAME
    std::string board = "9x6";         // see video::read_board
    std::string square;                // side of a square, or distance of circles, with its unit
    int coefficients = 5;              // of the distortion: 0, 4, 5, 8
    int window = 0;                    // [pixels] see video::BoardSearch
    double outliers = 3;               // see video::CalibrationOptions::outlier_factor
    std::string name;                  // of the camera; default: that of the file, or main

    // The pose in the scene.
    std::string points;                       // table of points, see video::read_scene_points
    double point_noise = 1;                   // [pixels] of points that state none
    std::string pose_picture;                 // shows the board where it lies in the scene
    std::string board_in_scene;               // "origin with unit; x axis; y axis; thickness with unit"
    std::string scene;                        // file
    std::vector<std::string> overrides, data; // of the scene
    std::string contour;                      // mask of the first frame
    std::string contour_of;                   // see find_seen_solid
    std::string level, plumb;                 // see video::read_levels
    std::string frame, overlay;               // the scene is drawn over this frame into that PNG

    std::string out = "camera.yaml"; // file of the camera: .yaml, .json or .xml
};

// `treacle calibrate`: lens and pose of a camera. Writes the camera's file and beside it, from pictures of a board,
// NAME_coverage.png and NAME_pictures.csv. Collective; rank 0 works. Throws InputError.
ExitCode calibrate_camera(const Comm& comm, const CalibrateRequest& request);

} // namespace treacle::app
