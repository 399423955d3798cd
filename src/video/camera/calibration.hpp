#pragma once
#include "scene/camera/camera_model.hpp"
#include "video/camera/board.hpp"

#include <string>
#include <vector>

namespace treacle::video {

// Intrinsic parameters by their place in covariances: fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6.
inline constexpr std::size_t intrinsic_count = 12;
const std::array<std::string, intrinsic_count>& intrinsic_names();

// Covariance of the intrinsic parameters: [pixels] for fx fy cx cy, the coefficients are dimensionless.
struct IntrinsicCovariance {
    // [intrinsic_count][intrinsic_count], row by row; zero for parameters that were not fitted.
    std::vector<double> values = std::vector<double>(intrinsic_count * intrinsic_count, 0.0);

    // Covariance of parameters i and j, by their index in intrinsic_names(); the caller keeps both halves equal.
    double& at(std::size_t i, std::size_t j) { return values[i * intrinsic_count + j]; }
    double at(std::size_t i, std::size_t j) const { return values[i * intrinsic_count + j]; }
    double deviation(std::size_t i) const; // standard deviation of parameter i, in its unit; 0 where it was not fitted
};

// Use of a picture in the calibration; only `used` ones enter the last fit.
enum class PictureState { used, outlier, unreadable, no_board, blurred };

// One picture of the board and what became of it.
struct BoardPicture {
    std::string name;
    PictureState state = PictureState::no_board;
    std::string reason;        // of what is not used
    int width = 0, height = 0; // [pixels]
    BoardView view;
    scene::CameraPose pose;      // board to camera; of pictures that are used or outliers
    double rms = 0, largest = 0; // [pixels] distances between points and their projections
};

// Model of the lens, and the rule for outliers.
struct CalibrationOptions {
    int coefficients = 5; // of the distortion: 0, 4 (k1 k2 p1 p2), 5 (and k3) or 8 (and k4 k5 k6)
    double outlier_factor =
        3; // a picture whose rms exceeds the median by this factor and `outlier_floor` is an outlier
    double outlier_floor = 0.25; // [pixels]
};

// A lens with its covariance, and the pictures that both come from.
struct Calibration {
    Board board;
    CalibrationOptions options;
    scene::Lens lens; // width and height of the pictures, focal lengths and centre [pixels]; coefficients [-]
    IntrinsicCovariance covariance;
    double rms = 0;                     // [pixels] of all points of the pictures used
    std::vector<BoardPicture> pictures; // all that were given, in their order, used or not
    std::vector<std::string> warnings;  // sentences for the user: a large error, poor coverage, few pictures

    std::size_t count(PictureState state) const; // pictures in this state
};

// Intrinsic parameters from the points of a flat board in several pictures (Zhang 2000, as cv::calibrateCamera), the
// pictures with outlying errors left out one at a time, worst first, each followed by a new fit.
//
// Covariance: delete-one-picture jackknife by one Newton step from the optimum, so that errors which the points of a
// picture share (focus, a board that is not flat, movement) count; never less than the covariance of independent
// errors, by which OpenCV's standard deviations go.
//
// Points of circles are moved from the middles of their images to the images of their middles (circle_bias.hpp).
//
// InputError when fewer than `least_pictures` can be used, or when the pictures differ in size.
inline constexpr std::size_t least_pictures = 4;
Calibration calibrate(const Board& board, const CalibrationOptions& options, std::vector<BoardPicture> pictures);

// Number of the 8 x 8 equal parts of the picture that hold a point, and of those at its four corners.
struct Coverage {
    static constexpr int parts = 8;
    std::array<std::array<int, parts>, parts> points{}; // [row][column]
    double covered() const;                             // fraction of the parts
    int corners() const; // of the four quarters of the rim: outermost 2 x 2 parts with a point
};
Coverage coverage_of(const Calibration& calibration);

// Largest standard deviation [pixels] with which rays over the picture are known, from the covariance, the best turn of
// the camera taken out.
double ray_deviation(const Calibration& calibration);

} // namespace treacle::video
