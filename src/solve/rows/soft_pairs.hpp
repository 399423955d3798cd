#pragma once
#include "solve/rows/matrix.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace treacle::solve {

// Two rows that resist each by itself and hardly together: with v = (1/sqrt(a_ii), -+1/sqrt(a_jj)), v^T A v = 2 (1 - c) for
// the cosine c = |a_ij|/sqrt(a_ii a_jj). Sweeps leave v; in
//     z += sum over pairs of v (v^T r)/(v^T A v)
// a preconditioner of a symmetric definite matrix has it. Pairs are of this rank's own rows.
class SoftPairs {
public:
    // Local. `aside` [rows]: 1 for rows that are left out.
    void build(const CsrBlocks& matrix, std::span<const unsigned char> aside);
    void add(std::span<const double> r, std::span<double> z) const;

    // Pairs of this rank and their memory [bytes].
    std::size_t count() const { return pairs_.size(); }
    std::size_t bytes() const { return pairs_.capacity() * sizeof(Pair); }

    static constexpr double least_cosine = 0.9; // with less sweeps do

private:
    struct Pair {
        Index first, second;
        double by_first, by_second; // v / sqrt(v^T A v)
    };
    std::vector<Pair> pairs_;
};

} // namespace treacle::solve
