#include "mpi/row_halo.hpp"

#include <gtest/gtest.h>

namespace treacle::row_halo_test {

TEST(RowHalo, brings_the_values_of_any_rows_also_past_ranks_without_rows) {
    const auto comm = Comm::world();
    for (const int skipped : {-1, 0, 1}) {
        const int rows = comm.rank() == skipped ? 0 : 3 + comm.rank();
        const auto first = comm.exclusive_sum(std::int64_t{rows});
        const auto all = comm.sum(std::int64_t{rows});
        std::vector<int> columns;
        for (int c = 0; c < all; ++c) {
            if ((c < first || c >= first + rows) && c % 2 == 0) columns.push_back(c);
        }
        std::vector<double> values;
        for (int i = 0; i < rows; ++i) values.push_back(10.0 * double(first + i));
        RowHalo halo;
        halo.connect(comm, first, columns);
        const auto found = halo.gather(values);
        ASSERT_EQ(found.size(), columns.size());
        for (std::size_t k = 0; k < columns.size(); ++k) EXPECT_EQ(found[k], 10.0 * columns[k]);
        // Again with other partners.
        halo.connect(comm, first, {});
        EXPECT_TRUE(halo.gather(values).empty());
    }
}

} // namespace treacle::row_halo_test
