#include "mpi/shared_node_sum.hpp"

#include "kokkos/cells.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace treacle {

namespace {
// The smallest box around all places.
CellBox box_of(std::span<const std::int64_t> keys) {
    CellBox box;
    for (const auto key : keys) {
        CellBox one;
        LatticeKey::unpack(key, one.lo);
        for (int k = 0; k < 3; ++k) one.hi[k] = one.lo[k] + 1;
        box = join(box, one);
    }
    return box;
}

// Those of all ranks.
std::vector<CellBox> gather_boxes(const Comm& comm, const CellBox& box) {
    const std::array<std::int64_t, 6> own{box.lo[0], box.lo[1], box.lo[2], box.hi[0], box.hi[1], box.hi[2]};
    const auto all = comm.all_gather(std::span<const std::int64_t>(own));
    std::vector<CellBox> boxes(all.size() / own.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
        auto& to = boxes[k / 6];
        (k % 6 < 3 ? to.lo[k % 3] : to.hi[k % 3]) = static_cast<int>(all[k]);
    }
    return boxes;
}

bool contains_key(const CellBox& box, std::int64_t key) {
    int node[3];
    LatticeKey::unpack(key, node);
    return box.contains(node);
}

// A key and its row.
using Row = std::pair<std::int64_t, int>;

// Keys, rising, that each rank whose box this one's meets may share.
std::vector<Message> offers(const Comm& comm, const std::vector<Row>& rows, const std::vector<CellBox>& boxes) {
    std::vector<Message> out;
    const auto& own = boxes[static_cast<std::size_t>(comm.rank())];
    for (int rank = 0; rank < comm.size(); ++rank) {
        const auto& other = boxes[static_cast<std::size_t>(rank)];
        if (rank == comm.rank() || intersect(own, other).empty()) continue;
        std::vector<std::int64_t> keys;
        for (const auto& [key, row] : rows) {
            if (contains_key(other, key)) keys.push_back(key);
        }
        if (keys.empty()) continue;
        Message message{rank, std::vector<char>(keys.size() * sizeof(std::int64_t))};
        std::memcpy(message.bytes.data(), keys.data(), message.bytes.size());
        out.push_back(std::move(message));
    }
    return out;
}

void pack(const Array<float>& values, const Array<int>& rows, std::int64_t n, int width, const Array<double>& send) {
    Kokkos::parallel_for(
        "treacle::pack_shared", n, KOKKOS_LAMBDA(std::int64_t k) {
            for (int c = 0; c < width; ++c) send(k * width + c) = values(std::int64_t(rows(k)) * width + c);
        });
}

// Rows that other ranks have too; entries of a row in the order of its ranks, -1: this rank's own.
struct Copies {
    Array<int> row, offset, entry;
    int count;
};

void sum_copies(const Copies& copies, const Array<double>& receive, int width, const Array<float>& values) {
    Kokkos::parallel_for(
        "treacle::sum_shared", copies.count, KOKKOS_LAMBDA(int k) {
            const std::int64_t row = std::int64_t(copies.row(k)) * width;
            for (int c = 0; c < width; ++c) {
                double sum = 0;
                for (int e = copies.offset(k); e < copies.offset(k + 1); ++e) {
                    const int entry = copies.entry(e);
                    sum += entry < 0 ? values(row + c) : receive(std::int64_t(entry) * width + c);
                }
                values(row + c) = static_cast<float>(sum);
            }
        });
}
} // namespace

void SharedNodeSum::connect(const Comm& comm, std::span<const std::int64_t> keys) {
    comm_ = comm;
    slices_ = {};
    std::vector<float> first(keys.size(), 1.0f);
    if (comm.size() == 1) {
        assign(first_, first);
        return;
    }
    const auto boxes = gather_boxes(comm, box_of(keys));
    std::vector<Row> rows;
    for (std::size_t k = 0; k < keys.size(); ++k) rows.emplace_back(keys[k], static_cast<int>(k));
    std::sort(rows.begin(), rows.end());
    std::vector<int> exchanged;
    struct Copy {
        int row, rank, entry;
    };
    std::vector<Copy> copies;
    for (const auto& message : exchange_sparse(comm, offers(comm, rows, boxes))) {
        std::vector<std::int64_t> offered(message.bytes.size() / sizeof(std::int64_t));
        std::memcpy(offered.data(), message.bytes.data(), message.bytes.size());
        const std::size_t before = exchanged.size();
        auto own = rows.begin();
        for (const auto key : offered) { // both rise
            while (own != rows.end() && own->first < key) ++own;
            if (own == rows.end() || own->first != key) continue;
            copies.push_back({own->second, message.rank, static_cast<int>(exchanged.size())});
            exchanged.push_back(own->second);
            if (message.rank < comm.rank()) first[static_cast<std::size_t>(own->second)] = 0;
        }
        if (exchanged.size() == before) continue;
        slices_.ranks.push_back(message.rank);
        slices_.offsets.push_back(static_cast<std::int64_t>(exchanged.size()));
    }
    assign(first_, first);
    std::vector<int> copied(exchanged);
    std::sort(copied.begin(), copied.end());
    copied.erase(std::unique(copied.begin(), copied.end()), copied.end());
    for (const int row : copied) copies.push_back({row, comm.rank(), -1});
    std::sort(copies.begin(), copies.end(),
        [](const Copy& a, const Copy& b) { return a.row != b.row ? a.row < b.row : a.rank < b.rank; });
    std::vector<int> offsets, entries;
    for (std::size_t k = 0; k < copies.size(); ++k) {
        if (k == 0 || copies[k].row != copies[k - 1].row) offsets.push_back(static_cast<int>(k));
        entries.push_back(copies[k].entry);
    }
    offsets.push_back(static_cast<int>(copies.size()));
    assign(rows_, exchanged);
    assign(copied_, copied);
    assign(offsets_, offsets);
    assign(entries_, entries);
    copies_ = static_cast<int>(copied.size());
}

void SharedNodeSum::add(const Array<float>& values, int width) {
    if (slices_.ranks.empty()) return;
    reserve(send_, static_cast<std::size_t>(slices_.rows() * width));
    reserve(receive_, static_cast<std::size_t>(slices_.rows() * width));
    pack(values, rows_, slices_.rows(), width, send_);
    exchange_slices(comm_, {slices_, send_}, {slices_, receive_}, width);
    sum_copies({copied_, offsets_, entries_, copies_}, receive_, width, values);
}

std::size_t SharedNodeSum::bytes() const {
    return 4 * (rows_.span() + copied_.span() + offsets_.span() + entries_.span() + first_.span()) +
           8 * (send_.span() + receive_.span());
}

} // namespace treacle
