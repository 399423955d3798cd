#include "solve/multigrid/chebyshev.hpp"

#include "solve/rows/vectors.hpp"

#include <algorithm>

namespace treacle::solve {

namespace {
// End of the interval as a fraction of the bound on the eigenvalues, and its start as one of its end. Up to 1.3 ends the
// polynomial is below 1: an eigenvalue at the bound leaves 0.39 of its error.
constexpr double end_fraction = 1 / 1.1, start_fraction = 0.3;
constexpr double centre = (1 + start_fraction) / 2,
                 half_width = (1 - start_fraction) / 2; // theta and delta, of the end

RowProduct rows_of(const Level::Block& block) { return {block.offsets, block.columns, block.values, nullptr}; }

// Sum of the moduli of a row's entries.
KOKKOS_INLINE_FUNCTION double moduli(const RowProduct& block, int row) {
    double sum = 0;
    for (Index k = block.offsets[row]; k < block.offsets[row + 1]; ++k) sum += math::fabs(block.values[k]);
    return sum;
}

// Largest sum of the moduli of a row of D^-1 A on this rank.
double largest_row(const Level& level) {
    const RowProduct own = rows_of(level.own()), other = rows_of(level.other());
    const double* const inverse = level.inverse_diagonal().data();
    double most = 0;
    Kokkos::parallel_reduce(
        "treacle::largest_row", level.rows,
        KOKKOS_LAMBDA(int i, double& out) { out = math::max(out, inverse[i] * (moduli(own, i) + moduli(other, i))); },
        Kokkos::Max<double>(most));
    return std::max(most, 0.0); // without rows it is the least number
}

// d = keep d + weight D^-1 (r - A z), z += d
void change(
    Level& level, double keep, double weight, std::span<const double> r, std::span<double> d, std::span<double> z) {
    const auto product = level.product(z);
    const double* const inverse = level.inverse_diagonal().data();
    const double* const right = r.data();
    double* const to = d.data();
    Kokkos::parallel_for(
        "treacle::chebyshev_change", level.rows, KOKKOS_LAMBDA(int i) {
            const double step = weight * inverse[i] * (right[i] - product(i));
            to[i] = keep > 0 ? keep * to[i] + step : step;
        });
    add(1.0, d, z);
}
} // namespace

void Chebyshev::set_up(const Comm& comm, const Level& level) {
    change_.resize(static_cast<std::size_t>(level.rows));
    bound_ = comm.max(largest_row(level));
    const double inverse_end = bound_ > 0 ? 1 / (end_fraction * bound_) : 0;
    constexpr double sigma = centre / half_width, rho = 1 / (2 * sigma - 1 / sigma); // rho_1; rho_0 = 1 / sigma
    first_ = inverse_end / centre;
    keep_ = rho / sigma;
    second_ = 2 * rho / half_width * inverse_end;
}

void Chebyshev::start(Level& level, std::span<const double> r, std::span<double> z) {
    scale(first_, level.inverse_diagonal(), r, change_);
    scale(first_, level.inverse_diagonal(), r, z);
    change(level, keep_, second_, r, change_, z);
}

void Chebyshev::improve(Level& level, std::span<const double> r, std::span<double> z) {
    change(level, 0, first_, r, change_, z);
    change(level, keep_, second_, r, change_, z);
}

} // namespace treacle::solve
