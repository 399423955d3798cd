#include "video/pose/contour_noise.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::video {

namespace {

constexpr double white = 0.1;                          // part of the variance without correlation
constexpr std::size_t most_equations = 240;            // more are thinned out
constexpr double edge_turn = 0.2;                      // of the normal, within an edge
constexpr double edge_length = 400;                    // [pixels]
constexpr double lengths[] = {3, 6, 12, 22, 40, 70};   // L [pixels]
constexpr double edge_fractions[] = {0.15, 0.35, 0.6}; // g
// [pixels] shared error of an edge that residuals do not show, as the fit takes it up: steps of pixels make 0.29 along rows
// and columns and none along slanted edges.
constexpr double edge_error = 0.15;
enum class Kernel { exponential, gaussian };

double edge_correlation(const OutlineEquation& a, const OutlineEquation& b) {
    const double d = std::hypot(a.pixel[0] - b.pixel[0], a.pixel[1] - b.pixel[1]) / edge_length;
    const double turn = std::hypot(a.normal[0] - b.normal[0], a.normal[1] - b.normal[1]) / edge_turn;
    return std::exp(-turn * turn - d * d);
}

struct NoiseModel {
    double length, edge_fraction;
    Kernel kernel;

    double correlation(const OutlineEquation& a, const OutlineEquation& b) const {
        const double d = std::hypot(a.pixel[0] - b.pixel[0], a.pixel[1] - b.pixel[1]), u = d / length;
        const double along = kernel == Kernel::gaussian ? std::exp(-u * u) : std::exp(-u);
        return (1 - white) * ((1 - edge_fraction) * along + edge_fraction * edge_correlation(a, b));
    }
};

std::vector<OutlineEquation> thinned(const std::vector<OutlineEquation>& all) {
    const std::size_t stride = (all.size() + most_equations - 1) / most_equations;
    std::vector<OutlineEquation> out;
    for (std::size_t i = 0; i < all.size(); i += std::max<std::size_t>(stride, 1)) out.push_back(all[i]);
    return out;
}

cv::Mat correlations(const std::vector<OutlineEquation>& equations, const NoiseModel& model) {
    const int n = int(equations.size());
    cv::Mat out(n, n, CV_64F);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j)
            out.at<double>(i, j) = out.at<double>(j, i) =
                i == j ? 1 : model.correlation(equations[std::size_t(i)], equations[std::size_t(j)]);
    return out;
}

// Lower triangle L of L L^T = m, in place; the logarithm of the determinant of m.
double factorise(cv::Mat& m) {
    const int n = m.rows;
    double logarithm = 0;
    for (int j = 0; j < n; ++j) {
        double* row_j = m.ptr<double>(j);
        double sum = row_j[j];
        for (int k = 0; k < j; ++k) sum -= row_j[k] * row_j[k];
        const double pivot = std::sqrt(std::max(sum, 1e-12));
        row_j[j] = pivot;
        logarithm += 2 * std::log(pivot);
        for (int i = j + 1; i < n; ++i) {
            double* row_i = m.ptr<double>(i);
            double value = row_i[j];
            for (int k = 0; k < j; ++k) value -= row_i[k] * row_j[k];
            row_i[j] = value / pivot;
        }
    }
    return logarithm;
}

// L^-1 b, column by column.
cv::Mat solve_lower(const cv::Mat& lower, cv::Mat b) {
    for (int i = 0; i < lower.rows; ++i) {
        const double* row = lower.ptr<double>(i);
        double* out = b.ptr<double>(i);
        for (int k = 0; k < i; ++k) {
            const double* above = b.ptr<double>(k);
            for (int c = 0; c < b.cols; ++c) out[c] -= row[k] * above[c];
        }
        for (int c = 0; c < b.cols; ++c) out[c] /= row[i];
    }
    return b;
}

struct Candidate {
    double likelihood = 0, variance = 0, length = 0, pieces = 0;
    NoiseModel model{};
    PoseVector change;
    PoseMatrix covariance;
};

Candidate judge(const std::vector<OutlineEquation>& equations, const NoiseModel& model, const PoseMatrix& prior,
    const PoseVector& mean) {
    const int n = int(equations.size()), p = 6;
    cv::Mat lower = correlations(equations, model);
    const double spread = cv::sum(lower)[0]; // n^2 / spread: independent pieces for a mean
    const double determinant = factorise(lower);
    cv::Mat right(n, p + 1, CV_64F); // J and -d
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < p; ++k) right.at<double>(i, k) = equations[std::size_t(i)].row(k);
        right.at<double>(i, p) = -equations[std::size_t(i)].displacement;
    }
    const cv::Mat whitened = solve_lower(lower, right);
    const cv::Mat normal = whitened.t() * whitened; // [7][7]
    PoseMatrix information;
    cv::Matx<double, 6, 1> gradient;
    for (int i = 0; i < p; ++i) {
        gradient(i) = normal.at<double>(i, p);
        for (int j = 0; j < p; ++j) information(i, j) = normal.at<double>(i, j);
    }
    const PoseMatrix inverted = inverse(information);
    const double squares = normal.at<double>(p, p) - (gradient.t() * inverted * gradient)(0);
    Candidate out;
    out.length = model.length;
    out.model = model;
    out.variance = std::max(squares / (n - p), 1e-4);
    // Scaled by the diagonal, so that the determinant does not overflow: the scale is the same for all candidates.
    double scaled = 0;
    PoseMatrix unit;
    for (int i = 0; i < p; ++i)
        for (int j = 0; j < p; ++j) unit(i, j) = information(i, j) / std::sqrt(information(i, i) * information(j, j));
    for (int i = 0; i < p; ++i) scaled += std::log(information(i, i));
    out.likelihood = -0.5 * ((n - p) * std::log(out.variance) + determinant + scaled +
                                std::log(std::max(cv::determinant(unit), 1e-300)));
    out.pieces = double(n) * n / spread;
    out.covariance = inverse((1 / out.variance) * information + prior);
    const cv::Matx<double, 6, 1> pull = prior * mean;
    const cv::Matx<double, 6, 1> change = out.covariance * ((1 / out.variance) * gradient + pull);
    out.change = PoseVector(change.val);
    return out;
}

// Covariance of the estimate by errors that the points of an edge share, A E A^T with the estimate A d.
PoseMatrix error_of_edges(const std::vector<OutlineEquation>& equations, const Candidate& candidate) {
    const int n = int(equations.size());
    cv::Mat lower = correlations(equations, candidate.model), rows(n, 6, CV_64F), shared(n, n, CV_64F);
    factorise(lower);
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < 6; ++k) rows.at<double>(i, k) = equations[std::size_t(i)].row(k);
        for (int j = 0; j < n; ++j)
            shared.at<double>(i, j) =
                edge_error * edge_error * edge_correlation(equations[std::size_t(i)], equations[std::size_t(j)]);
    }
    // L^-1 J and L^-1 E L^-T.
    const cv::Mat whitened = solve_lower(lower, rows);
    const cv::Mat half = solve_lower(lower, shared), both = solve_lower(lower, cv::Mat(half.t()));
    const cv::Mat middle = whitened.t() * both * whitened;
    const PoseMatrix gain = (1 / candidate.variance) * candidate.covariance;
    return gain * PoseMatrix(middle.ptr<double>()) * gain.t();
}

} // namespace

OutlineFit fit_outline(const std::vector<OutlineEquation>& all, const PoseMatrix& prior, const PoseVector& mean) {
    const auto equations = thinned(all);
    std::vector<Candidate> candidates;
    for (const double length : lengths)
        for (const double edge_fraction : edge_fractions)
            for (const auto kernel : {Kernel::exponential, Kernel::gaussian})
                candidates.push_back(judge(equations, {length, edge_fraction, kernel}, prior, mean));
    const double best = std::ranges::max(candidates, {}, &Candidate::likelihood).likelihood;
    OutlineFit out;
    double total = 0;
    out.covariance = PoseMatrix::zeros();
    const auto weight = [&](const Candidate& c) { return std::exp(c.likelihood - best); };
    for (const auto& c : candidates) {
        total += weight(c);
        out.change += weight(c) * c.change;
        out.deviation += weight(c) * std::sqrt(c.variance);
        out.correlation += weight(c) * c.length;
        out.pieces += weight(c) * c.pieces;
    }
    out.change *= 1 / total;
    out.deviation /= total;
    out.correlation /= total;
    out.pieces /= total;
    for (const auto& c : candidates) {
        const cv::Matx<double, 6, 1> apart = c.change - out.change;
        out.covariance += (weight(c) / total) * (c.covariance + apart * apart.t());
    }
    // The variance is known from few pieces: that of Student's t.
    const double freedom = std::max(out.pieces - 6, 4.0);
    out.covariance *= freedom / (freedom - 2);
    const auto& top = *std::ranges::max_element(candidates, {}, &Candidate::likelihood);
    out.covariance += error_of_edges(equations, top);
    return out;
}

} // namespace treacle::video
