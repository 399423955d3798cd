#include "identify/estimate/residual_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace treacle::identify {

namespace {
constexpr double correlated = 0.2; // autocorrelation below which frames count as independent

// Number of each frame among those of its experiment.
std::map<std::size_t, std::map<int, int>> frame_order(const EvaluatedRun& run, const Layout& layout) {
    std::map<std::size_t, std::map<int, int>> order;
    for (const auto& row : layout.rows) order[row.experiment].emplace(at(run, row).frame, 0);
    for (auto& [experiment, frames] : order) {
        int k = 0;
        for (auto& [frame, number] : frames) number = k++;
    }
    return order;
}

// Windows of time are averages, independent of each other but whole: what a turn does it does all around.
bool is_averaged(const EvaluatedRun& run, const Layout::Row& row) {
    return run.experiments[row.experiment].kind == ExperimentKind::occupancy;
}
} // namespace

int correlation_frames(
    const EvaluatedRun& run, const Layout& layout, const Vector& left, const std::vector<int>& sector) {
    std::map<std::pair<std::size_t, int>, std::map<int, std::pair<double, int>>>
        series; // by experiment and sector: sums by frame
    auto order = frame_order(run, layout);
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const auto& row = layout.rows[i];
        if (is_averaged(run, row)) continue;
        auto& entry = series[{row.experiment, sector[i]}][order[row.experiment][at(run, row).frame]];
        entry.first += left[Eigen::Index(i)];
        ++entry.second;
    }
    for (int lag = 1; lag < 200; ++lag) {
        double product = 0, square = 0;
        for (const auto& [key, sums] : series) {
            for (const auto& [position, sum] : sums) {
                const auto other = sums.find(position + lag);
                if (other == sums.end()) continue;
                const double a = sum.first / sum.second, b = other->second.first / other->second.second;
                product += a * b;
                square += 0.5 * (a * a + b * b);
            }
        }
        if (!(square > 0) || product < correlated * square) return lag;
    }
    return 200;
}

namespace {

// Number of the sixth of a turn, from 0 to 5, that a direction lies in.
int sector_of(double x, double y) {
    const double angle = std::atan2(y, x);
    return std::min(5, int((angle + 3.14159265358979) / 1.04719755119660));
}

} // namespace

std::vector<int> sectors(const EvaluatedRun& run, const Layout& layout) {
    std::map<std::pair<std::size_t, int>, std::array<double, 3>> sums;
    for (const auto& row : layout.rows) {
        const auto& s = at(run, row);
        auto& sum = sums[{row.experiment, s.frame}];
        sum[0] += s.x;
        sum[1] += s.y;
        sum[2] += 1;
    }
    std::vector<int> out;
    for (const auto& row : layout.rows) {
        const auto& s = at(run, row);
        const auto& sum = sums[{row.experiment, s.frame}];
        out.push_back(is_averaged(run, row) ? 0 : sector_of(s.x - sum[0] / sum[2], s.y - sum[1] / sum[2]));
    }
    return out;
}
std::vector<int> blocks_of(
    const EvaluatedRun& run, const Layout& layout, const std::vector<int>& sector, int frames_each) {
    auto order = frame_order(run, layout);
    std::map<std::tuple<std::size_t, int, int>, int> numbers;
    std::vector<int> out;
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const auto& row = layout.rows[i];
        const int part = order[row.experiment][at(run, row).frame] / (is_averaged(run, row) ? 1 : frames_each);
        out.push_back(numbers.try_emplace({row.experiment, part, sector[i]}, int(numbers.size())).first->second);
    }
    return out;
}

Matrix block_changes(const BlockedFit& blocked, const Matrix& information) {
    const auto& [fit, g, block_of] = blocked;
    const int count = *std::ranges::max_element(block_of) + 1;
    const auto n = g.cols();
    std::vector<Matrix> blocks(std::size_t(count), Matrix::Zero(n, n));
    Matrix scores = Matrix::Zero(count, n);
    for (Eigen::Index i = 0; i < g.rows(); ++i) {
        const auto b = std::size_t(block_of[std::size_t(i)]);
        blocks[b] += fit.weights[i] * g.row(i).transpose() * g.row(i);
        scores.row(Eigen::Index(b)) += fit.weights[i] * fit.left[i] * g.row(i);
    }
    Matrix whole = information;
    for (const auto& block : blocks) whole += block;
    Matrix out(count, n);
    for (int b = 0; b < count; ++b)
        out.row(b) = (whole - blocks[std::size_t(b)]).ldlt().solve(scores.row(b).transpose()).transpose();
    return out * (count > 1 ? std::sqrt(double(count - 1) / double(count)) : 1.0);
}

namespace {

// Largest ratio in row e, at least 1; columns without a variance do not count.
double largest_ratio(const Matrix& by_blocks, const Matrix& independent, Eigen::Index e) {
    double largest = 1;
    for (Eigen::Index k = 0; k < independent.cols(); ++k) {
        if (independent(e, k) > 0) largest = std::max(largest, by_blocks(e, k) / independent(e, k));
    }
    return largest;
}

} // namespace

std::vector<double> inflation(const BlockedFit& blocked, const Matrix& changes, const Layout& layout, Eigen::Index p) {
    const auto& [fit, g, blocks] = blocked;
    const Matrix weighted = fit.weights.cwiseProduct(fit.left).asDiagonal() * g;
    const Matrix moves = weighted * fit.inverse.leftCols(p);
    Matrix independent = Matrix::Zero(Eigen::Index(layout.experiments), p), by_blocks = independent;
    std::vector<bool> counted(std::size_t(changes.rows()));
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const auto e = Eigen::Index(layout.rows[i].experiment);
        independent.row(e) += moves.row(Eigen::Index(i)).cwiseAbs2();
        const auto block = std::size_t(blocks[i]);
        if (!counted[block]) by_blocks.row(e) += changes.row(Eigen::Index(block)).head(p).cwiseAbs2();
        counted[block] = true;
    }
    std::vector<double> out(layout.experiments, 1);
    for (std::size_t e = 0; e < layout.experiments; ++e)
        out[e] = largest_ratio(by_blocks, independent, Eigen::Index(e));
    return out;
}

} // namespace treacle::identify
