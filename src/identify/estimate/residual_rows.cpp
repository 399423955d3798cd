#include "identify/estimate/residual_rows.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

Layout layout_of(const EvaluatedRun& run, const std::vector<EvaluatedRun>& others,
    const std::vector<std::vector<EvaluatedRun>>& finer) {
    Layout out;
    out.experiments = run.experiments.size();
    for (std::size_t e = 0; e < run.experiments.size(); ++e) {
        const double usual = usual_noise(run.experiments[e].kind);
        for (std::size_t s = 0; s < run.experiments[e].segments.size(); ++s) {
            const auto finite = [&](const EvaluatedRun& one) {
                return std::isfinite(one.experiments[e].segments[s].displacement);
            };
            const auto all_finite = [&](const std::vector<EvaluatedRun>& runs) {
                return std::ranges::all_of(runs, finite);
            };
            if (run.experiments[e].segments[s].points > 0 && finite(run) && all_finite(others) &&
                std::ranges::all_of(finer, all_finite))
                out.rows.push_back({e, s, usual});
        }
    }
    return out;
}

Matrix view_matrix(const EvaluatedRun& run, const Layout& layout) {
    Matrix out = Matrix::Zero(Eigen::Index(layout.rows.size()), Eigen::Index(run.experiments.size() * view_count));
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const auto& row = layout.rows[i];
        for (int k = 0; k < view_count; ++k)
            out(Eigen::Index(i), Eigen::Index(row.experiment) * view_count + k) =
                at(run, row).by_view[std::size_t(k)] / row.usual;
    }
    return out;
}

Vector displacements(const EvaluatedRun& run, const Layout& layout) {
    Vector out(Eigen::Index(layout.rows.size()));
    for (std::size_t i = 0; i < layout.rows.size(); ++i)
        out[Eigen::Index(i)] = at(run, layout.rows[i]).displacement / layout.rows[i].usual;
    return out;
}

Vector sizes(const EvaluatedRun& run, const Layout& layout) {
    Vector out(Eigen::Index(layout.rows.size()));
    std::vector<double> sum(layout.experiments), count(layout.experiments);
    for (std::size_t i = 0; i < layout.rows.size(); ++i) {
        const auto e = layout.rows[i].experiment;
        out[Eigen::Index(i)] = at(run, layout.rows[i]).points;
        sum[e] += out[Eigen::Index(i)];
        count[e] += 1;
    }
    for (std::size_t i = 0; i < layout.rows.size(); ++i)
        out[Eigen::Index(i)] *= count[layout.rows[i].experiment] / sum[layout.rows[i].experiment];
    return out;
}

Matrix prior_matrix(const std::vector<ViewInformation>& priors, Eigen::Index before) {
    const auto n = before + Eigen::Index(priors.size()) * view_count;
    Matrix out = Matrix::Zero(n, n);
    for (std::size_t e = 0; e < priors.size(); ++e) {
        const auto first = before + Eigen::Index(e) * view_count;
        out.block(first, first, view_count, view_count) = priors[e];
    }
    return out;
}

} // namespace treacle::identify
