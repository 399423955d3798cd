#include "identify/estimate/directions.hpp"

#include "identify/experiment/digits.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

namespace {
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

Vector within(Vector point, const std::vector<search::Axis>& axes) {
    for (std::size_t k = 0; k < axes.size(); ++k)
        point[Eigen::Index(k)] = std::clamp(point[Eigen::Index(k)], axes[k].lower, axes[k].upper);
    return point;
}

// Covariance of numerical noise, as a multiple of the fit's: a few runs span few directions, and what moves the answer by noise moves it where
// the film holds it least.
Matrix noise_as_of_fit(const Matrix& covariance, const Matrix& noise) {
    if (noise.rows() == 1) return noise;
    return covariance.ldlt().solve(noise).trace() / double(noise.rows()) * covariance;
}

} // namespace

std::vector<search::Point> points_to_span(
    const Vector& answer, const std::vector<Vector>& points, const std::vector<search::Axis>& axes) {
    constexpr double at_answer = 0.02, step = 0.15, far = 0.5; // of the logarithm of a viscosity
    const auto p = answer.size();
    std::vector<search::Point> out;
    const auto add = [&](const Vector& point) { out.emplace_back(point.data(), point.data() + p); };
    const Vector middle = within(answer, axes);
    if (std::ranges::none_of(
            points, [&](const Vector& one) { return (one - middle).cwiseAbs().maxCoeff() < at_answer; }))
        add(middle);
    Matrix told = Matrix::Zero(p, p);
    for (const auto& one : points) {
        const Vector way = one - middle;
        if (way.norm() < far) told += way * way.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Matrix> principal(told);
    for (Eigen::Index k = 0; k < p && principal.eigenvalues()[k] < 0.25 * step * step; ++k) {
        Vector way = step * principal.eigenvectors().col(k);
        if (way.sum() < 0) way = -way; // a direction has no sign
        const Vector there = within(middle + way, axes), back = within(middle - way, axes);
        add((there - middle).norm() >= (back - middle).norm() ? there : back);
    }
    return out;
}

ResolvedAnswer extrapolate_answers(
    const std::vector<ResolutionAnswer>& answers, const Matrix& covariance, const Matrix& noise, int freedom) {
    const auto p = answers.front().value.size();
    const Matrix turn = p == 1 ? Matrix(Matrix::Identity(1, 1))
                               : Matrix(Eigen::SelfAdjointEigenSolver<Matrix>(covariance).eigenvectors());
    const Matrix spread = noise_as_of_fit(covariance, noise);
    ResolvedAnswer out;
    Vector value(p), resolution(p), scatter(p);
    for (Eigen::Index k = 0; k < p; ++k) {
        const Vector way = turn.col(k);
        std::vector<search::Rung> rungs;
        rungs.reserve(answers.size());
        for (const auto& answer : answers) rungs.push_back({answer.spacing, way.dot(answer.value), answer.runs});
        out.axes.push_back(
            search::extrapolate(rungs, {std::sqrt(way.dot(spread * way)), int(p) * std::max(1, freedom)}));
        const auto& one = out.axes.back();
        value[k] = one.value;
        scatter[k] = one.noise * one.noise;
        resolution[k] = one.deviation * one.deviation - scatter[k];
    }
    out.value = turn * value;
    out.resolution = turn * resolution.asDiagonal() * turn.transpose();
    out.noise = turn * scatter.asDiagonal() * turn.transpose();
    return out;
}

std::vector<std::string> trades(const std::vector<std::string>& names, const Matrix& covariance) {
    constexpr double strong =
        0.9; // correlation: the interval of each is more than twice what it would be with the other known
    std::vector<std::string> out;
    for (std::size_t a = 0; a < names.size(); ++a) {
        for (std::size_t b = a + 1; b < names.size(); ++b) {
            const auto i = Eigen::Index(a), j = Eigen::Index(b);
            const double correlation = covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j));
            if (!(std::abs(correlation) > strong)) continue;
            out.push_back(names[a] + " trades with " + names[b] + ": " +
                          (correlation > 0 ? "both rise together" : "one rises as the other falls") +
                          ", and were one known, the interval of the other would be " +
                          digits(std::sqrt(1 - correlation * correlation), 2) +
                          " times as wide. Take them as a region, or the flow curve");
        }
    }
    return out;
}

} // namespace treacle::identify
