#pragma once
#include "kokkos/types.hpp"
#include "mpi/comm.hpp"

#include <span>
#include <vector>

namespace treacle {

// One message of a sparse exchange: bytes to or from a rank.
struct Message {
    int rank = 0;
    std::vector<char> bytes;
};

// Collective: delivers messages that their receivers have not posted (non-blocking consensus: the cost grows
// with the messages and the logarithm of the ranks). Returns what arrived, ordered by sender; several messages
// of one sender keep their order.
std::vector<Message> exchange_sparse(const Comm& comm, const std::vector<Message>& outgoing);

// Known partners, known sizes: swaps slices of two buffers of doubles in device memory. Slice k goes to or
// comes from ranks[k]; offsets has one entry more than ranks, in rows of `width` doubles. Messages between two
// ranks pair up in order.
struct ExchangePlan {
    std::vector<int> ranks;
    std::vector<std::int64_t> offsets{0};
    std::int64_t rows() const { return offsets.back(); }
};
struct SlicedBuffer {
    const ExchangePlan& slices;
    const Array<double>& buffer; // [rows][width]
};
void exchange_slices(const Comm& comm, const SlicedBuffer& send, const SlicedBuffer& receive, int width);

} // namespace treacle
