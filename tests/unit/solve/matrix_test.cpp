#include "fixture.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <stdexcept>

namespace treacle::solve::matrix_test {

class MatrixOnRanks : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(owners, MatrixOnRanks, testing::Values(1, 2, 1 << 20));

TEST_P(MatrixOnRanks, product_equals_a_plain_loop_with_and_without_empty_ranks) {
    const auto comm = Comm::world();
    auto system = poisson(comm, 9, Border::dirichlet, GetParam());
    const auto expected = system.product(noise);
    const Matrix matrix(comm, system.blocks());
    std::vector<double> y(expected.size());
    matrix.multiply(system.values(noise), y);
    // 7 terms of size <= 6, summed in another order: a few units of round-off of 12.
    for (std::size_t i = 0; i < y.size(); ++i) EXPECT_NEAR(y[i], expected[i], 12e-15 / 2);
    EXPECT_EQ(comm.sum(matrix.entries()), 7 * 729 - 6 * 81);
}

TEST(Matrix, borrows_the_callers_values) {
    const auto comm = Comm::world();
    auto system = poisson(comm, 4, Border::dirichlet);
    Matrix matrix(comm, system.blocks());
    const std::vector<double> ones(system.diagonal_offsets.size() - 1, 1.0);
    std::vector<double> before(ones.size()), after(ones.size());
    matrix.multiply(ones, before);
    if (!ones.empty()) system.diagonal_values[0] += 5;
    for (double& value : system.off_values) value *= 2;
    matrix.values_changed();
    matrix.multiply(ones, after);
    for (std::size_t i = 0; i < ones.size(); ++i) {
        const double more = (i == 0 ? 5.0 : 0.0) - (system.off_offsets[i + 1] - system.off_offsets[i]);
        EXPECT_DOUBLE_EQ(after[i], before[i] + more);
    }
}

TEST(Matrix, can_be_made_anew_each_step_with_another_size) {
    const auto comm = Comm::world();
    for (const Index n : {5, 3, 6, 1}) {
        auto system = poisson(comm, n, Border::dirichlet);
        const Matrix matrix(comm, system.blocks());
        const auto expected = system.product(noise);
        std::vector<double> y(expected.size());
        matrix.multiply(system.values(noise), y);
        EXPECT_LT(distance(comm, y, expected), 1e-12);
    }
}

TEST(Matrix, may_have_no_rows_at_all_and_no_arrays) {
    const auto comm = Comm::world();
    const Matrix matrix(comm, CsrBlocks{});
    std::vector<double> nothing;
    matrix.multiply(nothing, nothing);
    EXPECT_EQ(matrix.entries(), 0);
}

class Pattern : public testing::Test {
protected:
    // Rows 2 and 3 of 6 as one rank of several would hold them.
    std::vector<Index> diagonal_offsets{0, 2, 4}, diagonal_columns{0, 1, 0, 1};
    std::vector<Index> off_offsets{0, 2, 3}, off_columns{0, 2, 1};
    RowHalo halo;
    void have_halo(std::vector<Index> columns) { halo.connect(Comm::self(), 2, columns); }
    void SetUp() override { have_halo({0, 4, 5}); }
    CsrBlocks blocks() {
        CsrBlocks out;
        out.diagonal_offsets = diagonal_offsets.data();
        out.diagonal_columns = diagonal_columns.data();
        out.off_offsets = off_offsets.data();
        out.off_columns = off_columns.data();
        out.halo = &halo;
        out.first_row = 2;
        out.rows = 2;
        out.global_rows = 6;
        return out;
    }
};

TEST_F(Pattern, in_order_passes) { EXPECT_NO_THROW(check_pattern(blocks())); }
TEST_F(Pattern, unsorted_diagonal_part_is_refused) {
    std::swap(diagonal_columns[0], diagonal_columns[1]);
    EXPECT_THROW(check_pattern(blocks()), std::logic_error);
}
TEST_F(Pattern, unsorted_off_diagonal_part_is_refused) {
    std::swap(off_columns[0], off_columns[1]);
    EXPECT_THROW(check_pattern(blocks()), std::logic_error);
}
TEST_F(Pattern, column_beyond_the_local_block_is_refused) {
    diagonal_columns[3] = 2;
    EXPECT_THROW(check_pattern(blocks()), std::logic_error);
}
TEST_F(Pattern, column_beyond_the_halo_is_refused) {
    off_columns[1] = 3;
    EXPECT_THROW(check_pattern(blocks()), std::logic_error);
}
TEST_F(Pattern, column_beyond_the_matrix_is_refused) {
    have_halo({0, 4, 6});
    EXPECT_THROW(check_pattern(blocks()), std::logic_error);
}
TEST_F(Pattern, local_column_in_the_off_diagonal_part_is_refused) {
    have_halo({0, 3, 5});
    EXPECT_THROW(check_pattern(blocks()), std::logic_error);
}
TEST_F(Pattern, unsorted_halo_is_refused) {
    have_halo({0, 5, 4});
    EXPECT_THROW(check_pattern(blocks()), std::logic_error);
}
TEST_F(Pattern, missing_diagonal_entry_is_refused) {
    diagonal_offsets = {0, 1, 2};
    diagonal_columns = {1, 1};
    EXPECT_THROW(check_pattern(blocks()), std::logic_error);
}
TEST_F(Pattern, falling_offsets_are_refused) {
    diagonal_offsets = {0, 4, 2};
    EXPECT_THROW(check_pattern(blocks()), std::logic_error);
}

} // namespace treacle::solve::matrix_test
