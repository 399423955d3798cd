#include "mpi/exchange.hpp"

#include "mpi/native.hpp"

#include <algorithm>

namespace treacle {

namespace {
constexpr int sparse_tag = 101;
constexpr int slice_tag = 102;
} // namespace

std::vector<Message> exchange_sparse(const Comm& comm, const std::vector<Message>& outgoing) {
    const MPI_Comm mpi = native(comm);
    std::vector<MPI_Request> requests(outgoing.size());
    for (std::size_t k = 0; k < outgoing.size(); ++k) {
        MPI_Issend(outgoing[k].bytes.data(), static_cast<int>(outgoing[k].bytes.size()), MPI_BYTE, outgoing[k].rank,
            sparse_tag, mpi, &requests[k]);
    }
    std::vector<Message> incoming;
    MPI_Request barrier = MPI_REQUEST_NULL;
    bool sent = false;
    for (int done = 0; !done;) {
        int there = 0;
        MPI_Status status;
        MPI_Iprobe(MPI_ANY_SOURCE, sparse_tag, mpi, &there, &status);
        if (there) {
            int size = 0;
            MPI_Get_count(&status, MPI_BYTE, &size);
            Message message{status.MPI_SOURCE, std::vector<char>(static_cast<std::size_t>(size))};
            MPI_Recv(message.bytes.data(), size, MPI_BYTE, message.rank, sparse_tag, mpi, MPI_STATUS_IGNORE);
            incoming.push_back(std::move(message));
        }
        if (!sent) {
            int all = 0;
            MPI_Testall(static_cast<int>(requests.size()), requests.data(), &all, MPI_STATUSES_IGNORE);
            if (all) {
                sent = true;
                MPI_Ibarrier(mpi, &barrier);
            }
        } else {
            MPI_Test(&barrier, &done, MPI_STATUS_IGNORE);
        }
    }
    // A rank that is done may already send for its next exchange: keep the two apart.
    MPI_Barrier(mpi);
    std::stable_sort(
        incoming.begin(), incoming.end(), [](const Message& a, const Message& b) { return a.rank < b.rank; });
    return incoming;
}

void exchange_slices(const Comm& comm, const SlicedBuffer& send, const SlicedBuffer& receive, int width) {
    const auto &outgoing = send.slices, &incoming = receive.slices;
    const MPI_Comm mpi = native(comm);
    // Without an MPI that reads device memory the buffers pass through the host; on a host build these are
    // the buffers themselves.
    auto host_send = Kokkos::create_mirror_view(send.buffer);
    auto host_receive = Kokkos::create_mirror_view(receive.buffer);
    Kokkos::deep_copy(host_send, send.buffer);
    std::vector<MPI_Request> requests;
    requests.reserve(outgoing.ranks.size() + incoming.ranks.size());
    const auto slice = [&](const ExchangePlan& slices, std::size_t k) {
        const std::int64_t first = slices.offsets[k] * width;
        return std::pair(first, static_cast<int>(slices.offsets[k + 1] * width - first));
    };
    for (std::size_t k = 0; k < incoming.ranks.size(); ++k) {
        const auto [first, size] = slice(incoming, k);
        MPI_Irecv(
            host_receive.data() + first, size, MPI_DOUBLE, incoming.ranks[k], slice_tag, mpi, &requests.emplace_back());
    }
    for (std::size_t k = 0; k < outgoing.ranks.size(); ++k) {
        const auto [first, size] = slice(outgoing, k);
        MPI_Isend(
            host_send.data() + first, size, MPI_DOUBLE, outgoing.ranks[k], slice_tag, mpi, &requests.emplace_back());
    }
    MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
    Kokkos::deep_copy(receive.buffer, host_receive);
}

} // namespace treacle
