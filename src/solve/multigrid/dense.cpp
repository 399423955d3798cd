#include "solve/multigrid/dense.hpp"

#include "base/text/contract.hpp"

namespace treacle::solve {

namespace {
// Fraction of the row's own diagonal that round-off leaves of a pivot that is zero.
constexpr double least_pivot = 1e-12;
} // namespace

void DenseFactor::factor(const Level& level) { factor(level, {}, {}, 0); }

void DenseFactor::factor(
    const Level& level, std::span<const double> columns, std::span<const double> block, std::size_t m) {
    const auto rows = static_cast<std::size_t>(level.rows);
    n_ = rows + m;
    lower_.assign(n_ * n_, 0.0);
    inverse_.assign(n_, 0.0);
    for (std::size_t k = 0; k < m; ++k) {
        for (std::size_t i = 0; i < rows; ++i) lower_[(rows + k) * n_ + i] = columns[k * rows + i];
        for (std::size_t l = 0; l < m; ++l) lower_[(rows + k) * n_ + rows + l] = block[k * m + l];
    }
    const auto& own = level.own();
    for (std::size_t i = 0; i < rows; ++i) {
        for (Index k = own.offsets[i]; k < own.offsets[i + 1]; ++k) {
            lower_[i * n_ + static_cast<std::size_t>(own.columns[k])] = own.values[k];
        }
    }
    // Row by row: m_ij = l_ij d_j first, then l_ij.
    for (std::size_t i = 0; i < n_; ++i) {
        double* const row = &lower_[i * n_];
        const double given = row[i];
        for (std::size_t j = 0; j < i; ++j) {
            const double* const above = &lower_[j * n_];
            double sum = row[j];
            for (std::size_t k = 0; k < j; ++k) sum -= row[k] * above[k];
            row[j] = sum;
        }
        double pivot = given;
        for (std::size_t j = 0; j < i; ++j) {
            const double factor = row[j] * inverse_[j];
            pivot -= row[j] * factor;
            row[j] = factor;
        }
        inverse_[i] = pivot > least_pivot * given ? 1 / pivot : 0.0;
    }
}

void DenseFactor::solve(std::span<const double> r, std::span<double> z) const {
    TREACLE_EXPECT(r.size() >= n_ && z.size() >= n_);
    for (std::size_t i = 0; i < n_; ++i) {
        double sum = r[i];
        for (std::size_t k = 0; k < i; ++k) sum -= lower_[i * n_ + k] * z[k];
        z[i] = sum;
    }
    for (std::size_t i = 0; i < n_; ++i) z[i] *= inverse_[i];
    for (std::size_t i = n_; i-- > 0;) {
        for (std::size_t k = 0; k < i; ++k) z[k] -= lower_[i * n_ + k] * z[i];
    }
}

} // namespace treacle::solve
