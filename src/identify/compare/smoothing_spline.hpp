#pragma once
#include <span>
#include <vector>

namespace treacle::identify {

// The smoothest curve through measured values: the natural cubic spline with the least integral of its squared second derivative
// whose weighted squares, sum ((y - f) / deviation)^2, are as many as values (Reinsch 1967). Deviations of 0: through the values.
// Times grow; two at least. Throws std::invalid_argument otherwise.
class SmoothingSpline {
public:
    SmoothingSpline(std::span<const double> times, std::span<const double> values, std::span<const double> deviations);

    double at(double time) const;    // beyond the ends it goes on straight
    double slope(double time) const; // unit of the values per unit of the times
    // Ends of the data, in the unit of the times.
    double first() const { return times_.front(); }
    double last() const { return times_.back(); }

private:
    std::size_t interval_of(double time) const;

    std::vector<double> times_, values_, bends_; // second derivatives at the times
};

} // namespace treacle::identify
