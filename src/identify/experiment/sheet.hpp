#pragma once
#include "base/text/vec3.hpp"
#include "scene/shapes/shape.hpp"

#include <array>
#include <string>
#include <vector>

namespace treacle {
class Declaration;
}

namespace treacle::identify {

// Sense of a file's coordinate or component against the sheet's `up`; pictures count rows downward.
enum class Upward { up, down };

// Tests of measured vectors against their neighbours.
struct OutlierTests {
    double median = 2; // threshold of the normalised median test; 0: none
    double alpha = 0;  // [1/s2] of (E.3), change in time; 0: none
    double floor = 0;  // [m/s2] beside it, so that slow vectors stay

    // Keys of the block `outliers` of a sheet.
    void declare(Declaration& d);
};

// Motion of the ball in the run: by the scene's forces, or along the measured track.
enum class BallMotion { free, prescribed };

// The body whose motion drives the flow.
struct Ball {
    std::string body;  // of the scene; empty: its only one that moves
    std::string track; // CSV with time, x, y and plus_minus in the axes of the fields
    BallMotion motion = BallMotion::prescribed;

    // Keys of the block `ball` of a sheet.
    void declare(Declaration& d);
};

// Velocity fields in a sheet of light, as particle image velocimetry measures them, and where the sheet is in the scene.
struct Sheet {
    std::vector<std::string> files; // names or patterns, beside the study's file
    std::string times;              // CSV with a column time [s] in place of first and interval
    double first = 0, interval = 0; // [s] of the first field, and from one to the next
    double pixel = 0;               // [m] of fields in pixels
    double pair_interval = 0;       // [s] between the two pictures of a pair, of displacements in pixels
    Vec3 origin{0, 0, 0};           // [m] of the scene, where x and y of the fields are 0
    Vec3 right{1, 0, 0};            // direction in which x of the fields grows
    Vec3 up{0, 0, 1};               // the sheet's other direction
    Upward y = Upward::up;          // whether y of the fields grows up or down
    Upward v = Upward::up;          // likewise of their v
    double window = 0;              // [m] side of an interrogation window
    double noise = 0;               // [m/s] standard deviation of a component of a vector
    std::vector<scene::Shape> mask; // where vectors are left out
    OutlierTests outliers;
    Ball ball;
    std::string where;

    // Keys of the block `piv` of an experiment.
    void declare(Declaration& d);
    // The scene's point at x, y [m] of the fields, and that of a place right and up in the sheet.
    Vec3 point_of_file(double x, double height) const { return point(x, y == Upward::up ? height : -height); }
    Vec3 point(double along_right, double along_up) const;
    bool has_track() const { return !ball.track.empty(); }
};

} // namespace treacle::identify
