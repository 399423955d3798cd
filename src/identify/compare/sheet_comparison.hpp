#pragma once
#include "identify/compare/residual_file.hpp"
#include "identify/compare/sheet_observation.hpp"
#include "identify/compare/velocity_sampler.hpp"

namespace treacle::identify {

// Liquid of one frame of a run, for a sheet of PIV.
struct SheetFlow {
    double time = 0;                                                 // [s]
    std::function<std::optional<LocalVelocity>(const Vec3&)> liquid; // nothing outside of the liquid
    std::function<std::optional<Vec3>(const Vec3&)>
        solid; // velocity of the solid that holds the point [m/s]; nothing outside
};

// Mean over an interrogation window, in the sheet's axes.
struct WindowVelocity {
    bool seen = false;                               // most of the window is liquid or solid
    bool touches = false;                            // some of it is solid
    std::array<double, 2> velocity{};                // [m/s] right, up
    std::array<std::array<double, 2>, 2> gradient{}; // [1/s] of the one and the other, by right and up
};
// By nine points of Gauss in the window. In a solid the liquid goes on with the solid's velocity (no slip).
WindowVelocity window_velocity(const Sheet& sheet, double x, double y, const SheetFlow& flow);

// Measured and simulated velocities side by side, of a field, for pictures.
struct ComparedVector {
    int field = 0;
    SheetVector measured;
    double u = 0, v = 0; // [m/s] simulated; not a number where there is no liquid
};

// Difference of one field and the run.
struct SheetComparison {
    std::vector<SegmentResidual> segments; // two a vector: right, up
    FrameSquares squares;                  // over the vectors that are compared
    std::vector<ComparedVector> vectors;   // all of the field, compared or not
};

// Compares a field with the flow between two frames, linear in time. Residuals are simulated less measured velocities over the
// sheet's noise. Windows that touch a solid of the run are not compared, but have a value.
SheetComparison compare_field(
    const Sheet& sheet, const ObservedField& field, const SheetFlow& before, const SheetFlow& after);

// fields_NAME.csv.
void write_vectors(
    const std::filesystem::path& folder, const std::string& experiment, const std::vector<ComparedVector>& vectors);
std::vector<ComparedVector> read_vectors(const std::filesystem::path& folder, const std::string& experiment);

} // namespace treacle::identify
