#include "identify/estimate/robust_fit.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

namespace {
constexpr double least_noise = 0.1; // of the usual one
constexpr int most_rounds = 20;     // of reweighting

double huber_weight(double residual, double scale, double bend) {
    return std::abs(residual) <= bend * scale ? 1 : bend * scale / std::abs(residual);
}

// The value below which half of the weights lie.
double weighted_median(std::vector<std::pair<double, double>> values) { // value, weight
    std::ranges::sort(values);
    double half = 0;
    for (const auto& [value, weight] : values) half += 0.5 * weight;
    for (const auto& [value, weight] : values) {
        half -= weight;
        if (half <= 0) return value;
    }
    return 0;
}

// Noise of each experiment, by the segments that depend on the parameters: those that do not move, along walls for
// example, have no part in the noise. pooled: the same for all, in units of what is usual of each.
std::vector<double> robust_scales(const Vector& residuals, const Layout& layout, const Vector& telling, bool pooled) {
    std::vector<std::vector<std::pair<double, double>>> sizes(pooled ? 1 : layout.experiments);
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        sizes[pooled ? 0 : layout.rows[i].experiment].emplace_back(
            std::abs(residuals[Eigen::Index(i)]), telling[Eigen::Index(i)]);
    }
    std::vector<double> out;
    out.reserve(sizes.size());
    for (auto& one : sizes) out.push_back(std::max(least_noise, 1.4826 * weighted_median(std::move(one))));
    if (pooled) out.resize(layout.experiments, out.front());
    return out;
}
} // namespace

Fit fit(const LinearModel& model, const Layout& layout, const FitOptions& options) {
    const auto& [r, g, size, information] = model;
    Fit out;
    out.x = Vector::Zero(g.cols());
    out.weights = size;
    out.noise.assign(layout.experiments, 1);
    for (int round = 0; round < most_rounds; ++round) {
        out.left = r + g * out.x;
        if (!options.usual_noise)
            out.noise = robust_scales(
                out.left, layout, g.leftCols(options.parameters).rowwise().norm(), options.parameters > 1);
        // Residuals that the view explains are no noise: a first fit that takes it for noise would leave the view where it is, and so the noise.
        if (round == 0)
            std::ranges::transform(out.noise, out.noise.begin(), [](double noise) { return std::min(noise, 1.0); });
        for (Eigen::Index i = 0; i < r.size(); ++i) {
            const auto e = layout.rows[std::size_t(i)].experiment;
            const double dilution = options.dilution.empty() ? 1 : options.dilution[e];
            out.weights[i] = size[i] * huber_weight(out.left[i], out.noise[e], options.bend) /
                             (out.noise[e] * out.noise[e] * dilution);
        }
        const Matrix weighted = out.weights.asDiagonal() * g;
        out.inverse = (g.transpose() * weighted + information).ldlt().solve(Matrix::Identity(g.cols(), g.cols()));
        Vector slope = weighted.transpose() * r;
        if (options.pull.size() > 0) slope += options.pull;
        const Vector next = -out.inverse * slope;
        const double change = (next - out.x).norm();
        out.x = next;
        if (change <= 1e-10 * (1e-10 + out.x.norm())) break;
    }
    out.left = r + g * out.x;
    return out;
}

} // namespace treacle::identify
