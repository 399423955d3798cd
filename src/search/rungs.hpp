#pragma once
#include <span>
#include <string>

namespace treacle::search {

// A figure, such as the logarithm of a viscosity that was found, at one resolution.
struct Rung {
    double spacing = 0; // any unit
    double value = 0;
};

// The figure at spacing zero, and what is known of its error.
struct Extrapolation {
    double value = 0;
    double correction = 0; // value - the finest rung's
    double deviation = 0;  // standard deviation of the value
    double order = 0;      // in spacing; 0 where none was observed
    std::string text;      // how it was found, a sentence for the report
};

// (R1) value(h) = value + a h^p by least squares over three rungs or more, p between 0.5 and 2.1. The deviation is half the
// bound of Eca & Hoekstra 2014, (R2) 1.25 |correction| + deviation of the fit + its miss of the finest rung, with what the noise of
// the rungs does to the value. Where no such order is observed, or the rungs differ by no more than their noise, the
// value is the finest rung's and the deviation the largest difference of all, or, if that is larger, from what (R3) first and
// second order together come to. It is never below the noise.
// noise: standard deviation of a rung's value, as of other seeds and shifts by half a cell; 0: unknown.
// Throws InputError for fewer than two rungs, two of one spacing, or a spacing that is not positive.
Extrapolation extrapolate(std::span<const Rung> rungs, double noise);

} // namespace treacle::search
