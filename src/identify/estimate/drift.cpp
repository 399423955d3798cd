#include "identify/estimate/drift.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace treacle::identify {

namespace {
constexpr int window_count = 4;

// Window of each frame of the experiment: about a quarter of the information of all on the parameter, and two frames at
// least.
std::map<int, int> windows_of(
    std::size_t experiment, const EvaluatedRun& run, const Layout& layout, const Vector& telling) {
    std::map<int, double> told; // by frame
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        if (layout.rows[i].experiment == experiment) told[at(run, layout.rows[i]).frame] += telling[Eigen::Index(i)];
    }
    if (int(told.size()) < 2 * window_count) return {};
    double all = 0;
    for (const auto& [frame, one] : told) all += one;
    std::map<int, int> out;
    int window = 0, frames = 0, left = int(told.size());
    double sum = 0;
    for (const auto& [frame, one] : told) {
        const bool enough = sum + 0.5 * one > all * (window + 1) / window_count && frames >= 2;
        const bool must = left <= 2 * (window_count - 1 - window);
        if (window + 1 < window_count && frames >= 2 && (enough || must)) {
            ++window;
            frames = 0;
        }
        out[frame] = window;
        sum += one;
        ++frames;
        --left;
    }
    return out;
}
} // namespace

Drift drift_of(std::size_t experiment, const WholeFit& all) {
    const auto& [run, layout, whole, gradient, view, information, blocks] = all;
    const auto window_by_frame = windows_of(experiment, run, layout, whole.weights.cwiseProduct(gradient.cwiseAbs2()));
    if (window_by_frame.empty()) return {};
    std::vector<Eigen::Index> rows;
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        if (layout.rows[i].experiment == experiment) rows.push_back(Eigen::Index(i));
    }
    const auto first_view = Eigen::Index(experiment) * view_count;
    Matrix g = Matrix::Zero(Eigen::Index(rows.size()), window_count + view_count);
    Fit part;
    part.weights = whole.weights(rows);
    Vector r = whole.left(rows);
    std::map<std::pair<int, int>, int> numbers;
    std::vector<int> own_blocks;
    Drift out;
    out.windows.resize(window_count, {1e300, -1e300, 0, 0});
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto& segment = at(run, layout.rows[std::size_t(rows[i])]);
        const int window = window_by_frame.at(segment.frame);
        g(Eigen::Index(i), window) = gradient[rows[i]];
        g.row(Eigen::Index(i)).tail(view_count) = view.row(rows[i]).segment(first_view, view_count);
        own_blocks.push_back(
            numbers.try_emplace({blocks[std::size_t(rows[i])], window}, int(numbers.size())).first->second);
        auto& times = out.windows[std::size_t(window)];
        times.from = std::min(times.from, segment.time);
        times.to = std::max(times.to, segment.time);
    }
    Matrix priors = Matrix::Zero(g.cols(), g.cols());
    priors.bottomRightCorner(view_count, view_count) =
        information.block(first_view, first_view, view_count, view_count);
    // The view begins from the fit's: its distance from what is stated pulls it back.
    const Vector away = whole.x.tail(view.cols()).segment(first_view, view_count);
    const Matrix weighted = part.weights.asDiagonal() * g;
    part.inverse = (g.transpose() * weighted + priors).ldlt().solve(Matrix::Identity(g.cols(), g.cols()));
    Vector slope = weighted.transpose() * r;
    slope.tail(view_count) += priors.bottomRightCorner(view_count, view_count) * away;
    part.x = -part.inverse * slope;
    part.left = r + g * part.x;
    const Matrix changes = block_changes({part, g, own_blocks}, priors);
    const Matrix by_priors = part.inverse.topRows(window_count);
    const Matrix covariance = changes.leftCols(window_count).transpose() * changes.leftCols(window_count) +
                              by_priors * priors * by_priors.transpose();
    // Straight line by least squares over the windows' numbers.
    Vector line(window_count);
    for (int k = 0; k < window_count; ++k) line[k] = k - 0.5 * (window_count - 1);
    line *= (window_count - 1) / line.squaredNorm();
    for (int k = 0; k < window_count; ++k) {
        out.windows[std::size_t(k)].change = part.x[k];
        out.windows[std::size_t(k)].deviation = std::sqrt(covariance(k, k));
    }
    out.change = line.dot(part.x.head(window_count));
    out.deviation = std::sqrt(line.dot(covariance * line));
    return out;
}

} // namespace treacle::identify
