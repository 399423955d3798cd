#pragma once
#include "identify/compare/smoothing_spline.hpp"
#include "identify/experiment/sheet.hpp"

#include <filesystem>

namespace treacle::identify {

// The measured path of a body's centre, smoothed by what is known of its error.
class BallTrack {
public:
    // A CSV with columns time, x, y and plus_minus, each with its unit in brackets, in the axes of the sheet's fields; pixels
    // take the sheet's. Throws InputError.
    BallTrack(const Sheet& sheet, const std::filesystem::path& path);

    Vec3 at(double time) const;                     // [m] in the scene, at a time of the track [s]
    double first() const { return x_.first(); }     // [s] of the track
    double last() const { return x_.last(); }       // [s] of the track
    double deviation() const { return deviation_; } // [m] the largest

private:
    struct Columns {
        std::vector<double> times, x, y, deviations;
    };
    static Columns read(const Sheet& sheet, const std::filesystem::path& path);
    BallTrack(const Sheet& sheet, const Columns& columns);

    Sheet sheet_;
    SmoothingSpline x_, y_;
    double deviation_ = 0;
};

} // namespace treacle::identify
