#pragma once
#include "identify/experiment/experiment.hpp"

#include <filesystem>
#include <functional>

namespace treacle::identify {

// A measured velocity in the sheet.
struct SheetVector {
    double x = 0, y = 0; // [m] right and up from the sheet's origin
    double u = 0, v = 0; // [m/s] likewise
};

// One field of vectors after the tests.
struct ObservedField {
    int number = 0;                   // among all fields of the experiment, from 0
    double time = 0;                  // [s] of the scene
    std::vector<SheetVector> vectors; // those that are kept, in the order of the file
};

// Counts of the vectors of the fields that are compared.
struct SheetCounts {
    std::size_t vectors = 0;  // that the files hold
    std::size_t missing = 0;  // not measured, or marked by the program that wrote them
    std::size_t outliers = 0; // that fail a test
    std::size_t masked = 0;
    std::size_t touching = 0; // whose window touches the measured ball
    std::size_t kept() const { return vectors - missing - outliers - masked - touching; }
};

// Measured fields of an experiment.
struct ObservedSheet {
    std::vector<ObservedField> fields; // between `from` and `to`, in the order of their numbers
    SheetCounts counts;                // over these fields
};

// Names of files are taken from the study's folder.
using Beside = std::function<std::filesystem::path(const std::string&)>;
// True when a window around a point of the scene touches a body at a time of the scene.
using Touches = std::function<bool(const Vec3& point, double time)>;

// The fields of an experiment between `from` and `to`, every so many of them, in the sheet's axes and SI. Throws InputError for
// files that are missing or lack units, and where none is left.
ObservedSheet observe_sheet(const Experiment& experiment, const Beside& beside, const Touches& touches = {});

} // namespace treacle::identify
