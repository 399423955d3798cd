#pragma once
#include <span>
#include <string>

namespace treacle::search {

// A figure, such as the logarithm of a viscosity that was found, at one resolution.
struct Rung {
    double spacing = 0; // any unit
    double value = 0;   // figure at this spacing, a logarithm
    int runs = 1;       // that the value is of: its noise is less by their square root
};

// The figure at spacing zero, and what is known of its error.
struct Extrapolation {
    double value = 0;      // figure at spacing zero
    double correction = 0; // value - the finest rung's
    double deviation = 0;  // standard deviation of the value
    double noise = 0;      // standard deviation of the finest rung's value, part of the deviation
    double order = 0;      // in spacing, mean of what the rungs allow
    std::string text;      // the uncertainty of the order, a sentence for the report
};

// Noise of the values of rungs.
struct RungNoise {
    // Standard deviation of a value of one run at the coarsest spacing, as of other seeds and shifts by parts of a cell;
    // 0: none.
    double deviation = 0;
    int freedom = 4; // degrees of freedom that it was measured with
};

// (RX1) value(h) = value + a (h / coarsest)^p (1 + 0.1 e) + n (h / coarsest)^1.5, with e of unit variance and the noise
// n: each cell of a contour errs by a part of its width, and L / h of them, one after the other in 2D, by h (h /
// L)^1/2 together; in 3D by less. The value and its variance are means over p of 0.5 to 2 (1.1 +- 0.3 without the
// rungs), over sizes of a from 0.3 % to 100 % and over what the noise may be by its degrees of freedom, each with the
// probability that the rungs give it (Bayesian average of models; the value itself has an even prior). Values are
// logarithms, so that a is relative. Throws InputError for fewer than two rungs, two of one spacing, or a spacing that
// is not positive.
Extrapolation extrapolate(std::span<const Rung> rungs, const RungNoise& noise);

} // namespace treacle::search
