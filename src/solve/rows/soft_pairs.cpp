#include "solve/rows/soft_pairs.hpp"

#include <cmath>

namespace treacle::solve {

namespace {
constexpr double round_off = 1e-12; // of 1 - c, below which nothing holds the pair
}

void SoftPairs::build(const CsrBlocks& matrix, std::span<const unsigned char> aside) {
    pairs_.clear();
    const auto rows = static_cast<std::size_t>(matrix.rows);
    std::vector<double> diagonal(rows, 0.0);
    const auto each_entry = [&](std::size_t i, const auto& use) {
        for (Index k = matrix.diagonal_offsets[i]; k < matrix.diagonal_offsets[i + 1]; ++k) {
            use(static_cast<std::size_t>(matrix.diagonal_columns[k]), matrix.diagonal_values[k]);
        }
    };
    for (std::size_t i = 0; i < rows; ++i) {
        each_entry(i, [&](std::size_t j, double value) { diagonal[i] = i == j ? value : diagonal[i]; });
    }
    for (std::size_t i = 0; i < rows; ++i) {
        if (aside[i] != 0 || !(diagonal[i] > 0)) continue;
        each_entry(i, [&](std::size_t j, double value) {
            if (j <= i || aside[j] != 0 || !(diagonal[j] > 0)) return;
            const double cosine = std::fabs(value) / std::sqrt(diagonal[i] * diagonal[j]);
            if (!(cosine > least_cosine) || !(1 - cosine > round_off)) return;
            const double scale = 1 / std::sqrt(2 * (1 - cosine));
            pairs_.push_back({static_cast<Index>(i), static_cast<Index>(j), scale / std::sqrt(diagonal[i]),
                -std::copysign(scale / std::sqrt(diagonal[j]), value)});
        });
    }
}

void SoftPairs::add(std::span<const double> r, std::span<double> z) const {
    for (const auto& pair : pairs_) {
        const auto i = static_cast<std::size_t>(pair.first), j = static_cast<std::size_t>(pair.second);
        const double strength = pair.by_first * r[i] + pair.by_second * r[j];
        z[i] += pair.by_first * strength;
        z[j] += pair.by_second * strength;
    }
}

} // namespace treacle::solve
