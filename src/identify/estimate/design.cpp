#include "identify/estimate/design.hpp"

#include "base/text/error.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

namespace {
using Matrix = Eigen::MatrixXd;
} // namespace

Matrix information_of_runs(const RunResiduals& base, const std::vector<RunResiduals>& moved,
    const std::vector<double>& steps, const ViewInformation& prior, double variance) {
    const auto p = Eigen::Index(moved.size());
    const double usual = usual_noise(base.kind);
    Matrix whole = Matrix::Zero(p + view_count, p + view_count);
    whole.bottomRightCorner(view_count, view_count) = prior;
    double points = 0;
    std::size_t rows = 0;
    const auto told = [&](std::size_t s) {
        const auto has = [&](const RunResiduals& run) {
            return s < run.segments.size() && run.segments[s].points > 0 && std::isfinite(run.segments[s].displacement);
        };
        return has(base) && std::ranges::all_of(moved, has);
    };
    for (std::size_t s = 0; s < base.segments.size(); ++s) {
        if (told(s)) points += base.segments[s].points, ++rows;
    }
    if (rows == 0)
        throw InputError({"next", "has nothing to compare", "the liquid is outside the camera's picture, or leaves it",
            "look at the masks of its runs"});
    for (std::size_t s = 0; s < base.segments.size(); ++s) {
        if (!told(s)) continue;
        Eigen::VectorXd row(p + view_count);
        for (Eigen::Index k = 0; k < p; ++k)
            row[k] = (moved[std::size_t(k)].segments[s].displacement - base.segments[s].displacement) /
                     steps[std::size_t(k)];
        for (int k = 0; k < view_count; ++k) row[p + k] = base.segments[s].by_view[std::size_t(k)];
        row /= usual;
        whole += base.segments[s].points * double(rows) / points / variance * row * row.transpose();
    }
    const Matrix across = whole.topRightCorner(p, view_count);
    return whole.topLeftCorner(p, p) -
           across * whole.bottomRightCorner(view_count, view_count).ldlt().solve(Matrix(across.transpose()));
}

double segment_variance(const Estimate& estimate, const std::vector<ExperimentKind>& kinds) {
    double sum = 0;
    for (std::size_t e = 0; e < kinds.size(); ++e)
        sum += estimate.dilution[e] * std::pow(estimate.noise[e] / usual_noise(kinds[e]), 2);
    return sum / double(kinds.size());
}

Matrix covariance_after(const Matrix& covariance, const Matrix& information) {
    // (C^-1 + I)^-1 = (1 + C I)^-1 C, which needs no inverse of a covariance that may be singular.
    const Matrix out = (Matrix::Identity(covariance.rows(), covariance.cols()) + covariance * information)
                           .partialPivLu()
                           .solve(covariance);
    return 0.5 * (out + out.transpose());
}

double band_half_width(const Matrix& covariance, const Matrix& slopes) {
    constexpr double ninety = 1.6449;
    double sum = 0;
    for (Eigen::Index i = 0; i < slopes.rows(); ++i)
        sum += std::max(0.0, double(slopes.row(i) * covariance * slopes.row(i).transpose()));
    return ninety * std::sqrt(sum / double(slopes.rows()));
}

} // namespace treacle::identify
