#pragma once
#include "mpi/comm.hpp"

#include <span>
#include <vector>

namespace treacle {

// Values of other ranks' rows, for the rows of a distributed matrix: each rank owns a contiguous range of the global
// numbers, in rank order. In host memory. Buffers are kept from one connection to the next.
class RowHalo {
public:
    // Collective. columns: global numbers, rising, of the rows of other ranks that this one needs.
    void connect(const Comm& comm, std::int64_t first_row, std::span<const int> columns);
    std::span<const int> columns() const { return columns_; }

    // Sends off what others need of this rank's own rows; finish() returns the values of the columns, valid until the
    // next start(). Ranks without a partner return at once.
    void start(std::span<const double> rows);
    std::span<const double> finish();
    std::span<const double> gather(std::span<const double> rows) {
        start(rows);
        return finish();
    }

    // Memory of columns and buffers [B].
    std::size_t bytes() const;

private:
    struct Partner {
        int rank;
        std::size_t first, size; // of the slice of rows_ or values_
    };
    Comm comm_ = Comm::self();
    std::vector<Partner> to_, from_;
    std::vector<int> columns_; // global numbers
    std::vector<int> rows_;    // local numbers of what goes out
    std::vector<double> outgoing_, values_;
    std::vector<std::intptr_t> requests_;
};

} // namespace treacle
