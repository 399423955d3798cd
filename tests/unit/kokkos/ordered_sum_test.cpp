#include "kokkos/ordered_sum.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace treacle::ordered_sum_test {

struct Inverse {
    KOKKOS_INLINE_FUNCTION double operator()(int i) const { return 1.0 / (i + 1); }
};
struct Doubling {
    Array<double> numbers;
    KOKKOS_INLINE_FUNCTION double operator()(int i) const {
        numbers(i) *= 2;
        return numbers(i);
    }
};

TEST(OrderedSum, IsThatOfAllTermsWhateverTheirNumber) {
    EXPECT_EQ(ordered_sum("test", 0, Inverse{}), 0);
    for (const int n : {1, 7, sum_block - 1, sum_block, sum_block + 1, 5 * sum_block + 3}) {
        long double sum = 0;
        for (int i = 0; i < n; ++i) sum += 1.0L / (i + 1);
        EXPECT_NEAR(ordered_sum("test", n, Inverse{}), double(sum), 1e-14 * double(sum)) << n;
    }
}

// Whatever the order of the threads: only the build with threads can fail here.
TEST(OrderedSum, RepeatsBitForBit) {
    const int n = 100 * sum_block + 17;
    const double first = ordered_sum("test", n, Inverse{});
    for (int k = 0; k < 20; ++k) EXPECT_EQ(ordered_sum("test", n, Inverse{}), first);
}

TEST(OrderedSum, CallsTheTermOnceForEachIndex) {
    const int n = 3 * sum_block + 5;
    Array<double> numbers("treacle::test", n);
    Kokkos::deep_copy(numbers, 0.5);
    EXPECT_EQ(ordered_sum("test", n, Doubling{numbers}), n);
    EXPECT_EQ(ordered_sum("test", n, Doubling{numbers}), 2.0 * n);
}

// What devices take: teams of threads.
TEST(OrderedSum, OfTeamsIsThatOfThreads) {
    const int n = 9 * sum_block + 100, blocks = 10;
    const auto sums = block_sums(blocks);
    Kokkos::parallel_for(
        "test", Kokkos::TeamPolicy<Execution>(blocks, Kokkos::AUTO), TeamSumLoop<Inverse>{n, Inverse{}, sums});
    Kokkos::parallel_for("test", 1, BlockTotal{blocks, sums});
    double sum = 0;
    Kokkos::deep_copy(sum, Kokkos::subview(sums, 0));
    EXPECT_NEAR(sum, ordered_sum("test", n, Inverse{}), 1e-14 * sum);
}

} // namespace treacle::ordered_sum_test
