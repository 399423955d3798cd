#include "mpi/row_halo.hpp"

#include "mpi/exchange.hpp"
#include "mpi/native.hpp"

#include <algorithm>
#include <cstring>

namespace treacle {

namespace {
constexpr int row_tag = 103;
static_assert(sizeof(MPI_Request) <= sizeof(std::intptr_t));
} // namespace

void RowHalo::connect(const Comm& comm, std::int64_t first_row, std::span<const int> columns) {
    comm_ = comm;
    to_.clear();
    from_.clear();
    rows_.clear();
    requests_.clear();
    columns_.assign(columns.begin(), columns.end());
    values_.resize(columns.size());
    if (comm.size() == 1) return;
    const auto firsts = comm.all_gather(first_row);
    std::vector<Message> wanted;
    for (std::size_t k = 0; k < columns.size();) {
        // Ranks without rows start where the next one does: the last of those that start here has the row.
        const auto next = std::upper_bound(firsts.begin(), firsts.end(), std::int64_t{columns[k]});
        const auto end = next == firsts.end()
                             ? columns.size()
                             : std::size_t(std::lower_bound(columns.begin(), columns.end(), *next) - columns.begin());
        const int owner = static_cast<int>(next - firsts.begin()) - 1;
        from_.push_back({owner, k, end - k});
        Message message{owner, std::vector<char>((end - k) * sizeof(int))};
        std::memcpy(message.bytes.data(), &columns[k], message.bytes.size());
        wanted.push_back(std::move(message));
        k = end;
    }
    for (const auto& message : exchange_sparse(comm, wanted)) {
        const std::size_t first = rows_.size(), size = message.bytes.size() / sizeof(int);
        to_.push_back({message.rank, first, size});
        rows_.resize(first + size);
        std::memcpy(&rows_[first], message.bytes.data(), message.bytes.size());
        for (std::size_t k = first; k < first + size; ++k) rows_[k] -= static_cast<int>(first_row);
    }
    outgoing_.resize(rows_.size());
    requests_.resize(to_.size() + from_.size());
}

void RowHalo::start(std::span<const double> rows) {
    if (requests_.empty()) return;
    const MPI_Comm mpi = native(comm_);
    auto* request = reinterpret_cast<MPI_Request*>(requests_.data());
    int count = 0;
    for (const auto& partner : from_) {
        MPI_Irecv(&values_[partner.first], static_cast<int>(partner.size), MPI_DOUBLE, partner.rank, row_tag, mpi,
            &request[count++]);
    }
    for (std::size_t k = 0; k < rows_.size(); ++k) outgoing_[k] = rows[static_cast<std::size_t>(rows_[k])];
    for (const auto& partner : to_) {
        MPI_Isend(&outgoing_[partner.first], static_cast<int>(partner.size), MPI_DOUBLE, partner.rank, row_tag, mpi,
            &request[count++]);
    }
}

std::span<const double> RowHalo::finish() {
    if (!requests_.empty()) {
        MPI_Waitall(
            static_cast<int>(requests_.size()), reinterpret_cast<MPI_Request*>(requests_.data()), MPI_STATUSES_IGNORE);
    }
    return values_;
}

std::size_t RowHalo::bytes() const {
    return 4 * (rows_.capacity() + columns_.capacity()) + 8 * (outgoing_.capacity() + values_.capacity());
}

} // namespace treacle
