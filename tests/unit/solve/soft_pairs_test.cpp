#include "solve/rows/soft_pairs.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace treacle::solve::soft_pairs_test {
namespace {

// Rows 0 and 1 are stiff and hardly resist v = (1, -1/2); row 2 is joined to row 1 by less than a pair is.
struct System {
    std::vector<Index> offsets{0, 2, 5, 7}, columns{0, 1, 0, 1, 2, 1, 2};
    std::vector<double> values{1, 2 - 1e-3, 2 - 1e-3, 4, 0.5, 0.5, 1};

    CsrBlocks blocks() {
        CsrBlocks out;
        out.diagonal_offsets = offsets.data();
        out.diagonal_columns = columns.data();
        out.diagonal_values = values.data();
        out.rows = out.global_rows = 3;
        return out;
    }
};

TEST(SoftPairs, solve_for_what_two_rows_hardly_resist) {
    System system;
    SoftPairs pairs;
    const std::vector<unsigned char> aside(3, 0);
    pairs.build(system.blocks(), aside);
    ASSERT_EQ(pairs.count(), 1u);
    // Of r = A v within the pair comes v.
    const std::vector<double> r{1 - 0.5 * (2 - 1e-3), (2 - 1e-3) - 0.5 * 4, 0.0};
    std::vector<double> z(3, 0.0);
    pairs.add(r, z);
    EXPECT_NEAR(z[0], 1, 1e-10); // round-off over 1 - c = 5e-4
    EXPECT_NEAR(z[1], -0.5, 1e-10);
    EXPECT_EQ(z[2], 0);
}

TEST(SoftPairs, leave_out_rows_that_are_aside) {
    System system;
    SoftPairs pairs;
    const std::vector<unsigned char> aside{0, 1, 0};
    pairs.build(system.blocks(), aside);
    EXPECT_EQ(pairs.count(), 0u);
}

} // namespace
} // namespace treacle::solve::soft_pairs_test
