#pragma once
#include "kokkos/types.hpp"

// Sums that come out the same, bit for bit, whatever the number of threads, and on every run.
namespace treacle {

// Terms that one thread, or one team of a device's threads, adds up. The sums of these blocks are then added in order.
inline constexpr int sum_block = 2048;

// Sums of n blocks; grows, and is freed with Kokkos.
const Array<double>& block_sums(int n);

// A thread for each block; the pragma lets several lanes add at once.
template <class Term>
struct BlockSumLoop {
    int n;
    Term term;
    Array<double> sums; // [blocks] in the unit of the terms
    KOKKOS_INLINE_FUNCTION void operator()(int block) const {
        const int begin = block * sum_block, end = math::min(n, begin + sum_block);
        double sum = 0;
#pragma omp simd reduction(+ : sum)
        for (int i = begin; i < end; ++i) sum += term(i);
        sums(block) = sum;
    }
};

// A team for each block: neighbouring threads read neighbouring numbers.
template <class Term>
struct TeamSumLoop {
    int n;
    Term term;
    Array<double> sums; // [blocks] in the unit of the terms
    KOKKOS_INLINE_FUNCTION void operator()(const Kokkos::TeamPolicy<Execution>::member_type& team) const {
        const int begin = team.league_rank() * sum_block, end = math::min(n, begin + sum_block);
        double sum = 0;
        Kokkos::parallel_reduce(
            Kokkos::TeamThreadRange(team, begin, end), [&](int i, double& out) { out += term(i); }, sum);
        Kokkos::single(Kokkos::PerTeam(team), [&]() { sums(team.league_rank()) = sum; });
    }
};

// Adds the sums of the blocks up, into the first.
struct BlockTotal {
    int blocks;
    Array<double> sums; // [blocks] in the unit of the terms
    KOKKOS_INLINE_FUNCTION void operator()(int) const {
        double sum = 0;
        for (int k = 0; k < blocks; ++k) sum += sums(k);
        sums(0) = sum;
    }
};

// Sum over 0 <= i < n of term(i), which is called once for each i and may store as well.
template <class Term>
double ordered_sum(const char* label, int n, const Term& term) {
    if (n <= 0) return 0;
    const int blocks = (n + sum_block - 1) / sum_block;
    const auto sums = block_sums(blocks);
    if constexpr (Kokkos::SpaceAccessibility<Kokkos::HostSpace, Memory>::accessible) {
        Kokkos::parallel_for(label, blocks, BlockSumLoop<Term>{n, term, sums});
    } else {
        Kokkos::parallel_for(
            label, Kokkos::TeamPolicy<Execution>(blocks, Kokkos::AUTO), TeamSumLoop<Term>{n, term, sums});
    }
    Kokkos::parallel_for("treacle::block_total", 1, BlockTotal{blocks, sums});
    double total = 0;
    Kokkos::deep_copy(total, Kokkos::subview(sums, 0));
    return total;
}

} // namespace treacle
