#pragma once
#include "search/problem/matrix.hpp"

#include <vector>

namespace treacle::search {

// A Gaussian process through scattered values: constant mean, Matern kernel of order 5/2 with a length for each coordinate, and
// noise (Rasmussen & Williams 2006, chapters 2 and 5). Exact, so for a few hundred points.
class GaussianProcess {
public:
    struct Prediction {
        double mean = 0;      // expected value of the function, in the unit of the values
        double deviation = 0; // of the function, without noise
    };

    // Lengths and noise of the largest likelihood (G1), that of the mean and the variance included in closed form; lengths
    // have a wide prior around 1, so that few points do not make them absurd. points: [m][n], m >= 2, in coordinates in which the
    // function changes over lengths of about one; values: [m].
    GaussianProcess(std::vector<std::vector<double>> points, std::vector<double> values);

    Prediction at(const std::vector<double>& x) const; // (G2)
    // Adds a value as if it had been measured, with the present lengths and noise.
    void believe(const std::vector<double>& x, double value);

    // [n] of the kernel, in the coordinates of the points
    const std::vector<double>& lengths() const { return lengths_; }
    double noise() const; // standard deviation
    // Values in the fit, added ones included [count].
    std::size_t size() const { return values_.size(); }

private:
    struct Factor {
        Matrix lower;              // of K, over the variance
        std::vector<double> ones;  // L^-1 1
        std::vector<double> rests; // L^-1 (values - mean)
        double mean = 0, variance = 0;
        double cost = 0; // -2 ln likelihood
    };
    std::optional<Factor> factor(const std::vector<double>& lengths, double noise_ratio) const;
    double kernel(const std::vector<double>& a, const std::vector<double>& b, const std::vector<double>& lengths) const;
    void choose_lengths();
    void choose_lengths_from(double start, double noise_ratio);

    std::vector<std::vector<double>> points_;
    std::vector<double> values_;
    std::vector<double> lengths_;
    double noise_ratio_ = 0; // variance of the noise over that of the function
    double best_cost_;
    Factor factor_;
    std::vector<double> weights_; // K^-1 (values - mean), over the variance
};

} // namespace treacle::search
