#include "grid/pressure/part_relief.hpp"

#include <Eigen/Dense>

#include <cmath>

namespace treacle::grid {

namespace {
// Fractions of all that a constant pressure pushes and turns with which a body must be pushed or turned on the whole to move.
// Pushes of a body with liquid all around add up to nothing, turns of one that the liquid slides along only nearly.
constexpr double least_push = 1e-6, least_turn = 0.03;
// Share of what it would be without joints that the work of a push must be, and of what it is by itself that must be left
// beside those of other parts: below it is round-off.
constexpr double least_work = 1e-9, least_independent = 1e-6;

double sum_sizes(std::span<const double> values) {
    double sum = 0;
    for (const double value : values) sum += std::fabs(value);
    return sum;
}

// `net` without what is nothing beside `gross`, both [6 a body].
std::vector<double> significant(std::span<const double> net, std::span<const double> gross) {
    std::vector<double> push(net.size(), 0.0);
    for (std::size_t at = 0; at < net.size(); at += 3) {
        const double least = (at % 6 == 0 ? least_push : least_turn) * sum_sizes(gross.subspan(at, 3));
        if (!(sum_sizes(net.subspan(at, 3)) > least)) continue;
        for (std::size_t k = at; k < at + 3; ++k) push[k] = net[k];
    }
    return push;
}

auto vector_of(const std::vector<double>& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}
} // namespace

void PartRelief::find(const rigid::ConstrainedInverseMass& mobility, std::size_t parts, std::span<const double> net,
    std::span<const double> gross) {
    const auto p = static_cast<Eigen::Index>(parts);
    const std::size_t width = parts > 0 ? net.size() / parts : 0;
    relieved_.assign(parts, 0);
    factor_.clear();
    Eigen::MatrixXd push(static_cast<Eigen::Index>(width), p), moved(static_cast<Eigen::Index>(width), p);
    std::vector<double> alone;
    for (std::size_t part = 0; part < parts; ++part) {
        const auto column = static_cast<Eigen::Index>(part);
        const auto u = significant(net.subspan(part * width, width), gross.subspan(part * width, width));
        push.col(column) = vector_of(u);
        moved.col(column) = vector_of(mobility.respond(u));
        alone.push_back(push.col(column).dot(vector_of(mobility.alone(u))));
    }
    // Pivots by the share of its work that a part has left beside those before it.
    const Eigen::VectorXd whole = push.cwiseProduct(moved).colwise().sum().transpose();
    Eigen::VectorXd left = whole;
    const auto find_pivot = [&] {
        Eigen::Index pivot = -1;
        double most = least_independent;
        for (Eigen::Index k = 0; k < p; ++k) {
            const auto part = static_cast<std::size_t>(k);
            if (relieved_[part] || !(whole(k) > least_work * alone[part]) || !(left(k) > most * whole(k))) continue;
            pivot = k;
            most = left(k) / whole(k);
        }
        return pivot;
    };
    for (auto pivot = find_pivot(); pivot >= 0; pivot = find_pivot()) {
        const auto columns = static_cast<Eigen::Index>(factor_.size()) / p;
        const Eigen::Map<const Eigen::MatrixXd> before(factor_.data(), p, columns);
        Eigen::VectorXd column = push.transpose() * moved.col(pivot) - before * before.row(pivot).transpose();
        column /= std::sqrt(left(pivot));
        left -= column.cwiseAbs2();
        factor_.insert(factor_.end(), column.data(), column.data() + p);
        relieved_[static_cast<std::size_t>(pivot)] = 1;
    }
}

std::vector<double> PartRelief::surplus(std::span<const double> sums, std::span<const double> sizes) const {
    const auto n = static_cast<Eigen::Index>(sums.size()), columns = static_cast<Eigen::Index>(factor_.size()) / n;
    const Eigen::Map<const Eigen::VectorXd> sum(sums.data(), n), size(sizes.data(), n);
    const Eigen::Map<const Eigen::MatrixXd> factor(factor_.data(), n, columns);
    Eigen::VectorXd left = sum;
    if (columns > 0) {
        const Eigen::MatrixXd by_size = size.cwiseInverse().asDiagonal() * factor;
        left -= factor * (factor.transpose() * by_size).ldlt().solve(by_size.transpose() * sum);
    }
    left.array() /= size.array();
    return {left.data(), left.data() + n};
}

} // namespace treacle::grid
