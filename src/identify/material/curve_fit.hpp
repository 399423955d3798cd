#pragma once
#include "identify/material/flow_curve_band.hpp"

namespace treacle::identify {

// A law of Herschel and Bulkley (1926), eta = yield_stress / rate + consistency rate^(exponent - 1), fitted to a measured curve.
struct CurveFit {
    double consistency = 0;  // [Pa s] at 1/s
    double exponent = 1;     // n
    double yield_stress = 0; // [Pa]
    double rms = 0;          // root mean square of ln(law / measured) over the points
    double from = 0, to = 0; // [1/s] least and largest rate of the points
    std::size_t points = 0;  // that it is fitted to

    double at(double rate) const;                // [Pa s]
    bool is_close() const { return rms <= 0.1; } // whether a run with the law stands for the curve
};

// The law of least squares of the logarithms, n in (0, 1.5], over the points whose rates lie within [from, to] and a little outside
// (all points where fewer than four do); each counts by the part of the logarithm of the rates that it stands for. Of three
// points or two there is no yield stress.
CurveFit fit_flow_curve(const ViscositiesByRate& curve, double from, double to);
// Over all points.
CurveFit fit_flow_curve(const ViscositiesByRate& curve);

// "K 8.01 Pa s at 1/s, n 0.5, yield stress 4.98 Pa"
std::string describe(const CurveFit& fit);

} // namespace treacle::identify
