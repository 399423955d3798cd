#include "mpi/shared_rows.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace treacle {

namespace {
using Box = std::array<std::int64_t, 6>; // the lowest and the highest place

Box box_of(std::span<const std::int64_t> keys) {
    constexpr std::int64_t far = std::numeric_limits<int>::max();
    Box box{far, far, far, -far, -far, -far};
    for (const auto key : keys) {
        int place[3];
        LatticeKey::unpack(key, place);
        for (std::size_t k = 0; k < 3; ++k) {
            box[k] = std::min<std::int64_t>(box[k], place[k]);
            box[k + 3] = std::max<std::int64_t>(box[k + 3], place[k]);
        }
    }
    return box;
}

bool holds(const std::int64_t* box, std::int64_t key) {
    int place[3];
    LatticeKey::unpack(key, place);
    for (int k = 0; k < 3; ++k) {
        if (place[k] < box[k] || place[k] > box[k + 3]) return false;
    }
    return true;
}

bool meet(const std::int64_t* a, const std::int64_t* b) {
    for (int k = 0; k < 3; ++k) {
        if (a[k] > b[k + 3] || b[k] > a[k + 3]) return false;
    }
    return true;
}

// A key and its row.
using Row = std::pair<std::int64_t, int>;

// What each rank whose box this one's meets may share: keys, rising.
std::vector<Message> offers(const Comm& comm, const std::vector<Row>& rows, const std::vector<std::int64_t>& boxes) {
    std::vector<Message> out;
    const std::int64_t* own = &boxes[6 * static_cast<std::size_t>(comm.rank())];
    for (int rank = 0; rank < comm.size(); ++rank) {
        const std::int64_t* other = &boxes[6 * static_cast<std::size_t>(rank)];
        if (rank == comm.rank() || rows.empty() || !meet(own, other)) continue;
        std::vector<std::int64_t> keys;
        for (const auto& [key, row] : rows) {
            if (holds(other, key)) keys.push_back(key);
        }
        if (keys.empty()) continue;
        Message message{rank, std::vector<char>(keys.size() * sizeof(std::int64_t))};
        std::memcpy(message.bytes.data(), keys.data(), message.bytes.size());
        out.push_back(std::move(message));
    }
    return out;
}

void pack(const Array<float>& values, const Array<int>& rows, std::int64_t n, int width, const Array<double>& send) {
    Kokkos::parallel_for("treacle::pack_shared", n, KOKKOS_LAMBDA(std::int64_t k) {
        for (int c = 0; c < width; ++c) send(k * width + c) = values(std::int64_t(rows(k)) * width + c);
    });
}

void sum_copies(const Array<int>& copied, const Array<int>& offsets, const Array<int>& entries, const Array<double>& receive,
                int n, int width, const Array<float>& values) {
    Kokkos::parallel_for("treacle::sum_shared", n, KOKKOS_LAMBDA(int k) {
        const std::int64_t row = std::int64_t(copied(k)) * width;
        for (int c = 0; c < width; ++c) {
            double sum = 0;
            for (int e = offsets(k); e < offsets(k + 1); ++e) {
                sum += entries(e) < 0 ? values(row + c) : receive(std::int64_t(entries(e)) * width + c);
            }
            values(row + c) = static_cast<float>(sum);
        }
    });
}
} // namespace

void SharedRows::connect(const Comm& comm, std::span<const std::int64_t> keys) {
    comm_ = comm;
    slices_ = {};
    reserve(first_, keys.size());
    Kokkos::deep_copy(first_, 1.0f);
    if (comm.size() == 1) return;
    const Box box = box_of(keys);
    const auto boxes = comm.all_gather(std::span<const std::int64_t>(box));
    std::vector<Row> rows;
    for (std::size_t k = 0; k < keys.size(); ++k) rows.emplace_back(keys[k], static_cast<int>(k));
    std::sort(rows.begin(), rows.end());
    std::vector<int> exchanged;
    struct Copy {
        int row, rank, entry;
    };
    std::vector<Copy> copies;
    auto first = Kokkos::create_mirror_view(first_);
    Kokkos::deep_copy(first, 1.0f);
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
            if (message.rank < comm.rank()) first(static_cast<std::size_t>(own->second)) = 0;
        }
        if (exchanged.size() == before) continue;
        slices_.ranks.push_back(message.rank);
        slices_.offsets.push_back(static_cast<std::int64_t>(exchanged.size()));
    }
    Kokkos::deep_copy(first_, first);
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
    bring(rows_, exchanged);
    bring(copied_, copied);
    bring(offsets_, offsets);
    bring(entries_, entries);
    copies_ = static_cast<int>(copied.size());
}

void SharedRows::add(const Array<float>& values, int width) {
    if (slices_.ranks.empty()) return;
    reserve(send_, static_cast<std::size_t>(slices_.rows() * width));
    reserve(receive_, static_cast<std::size_t>(slices_.rows() * width));
    pack(values, rows_, slices_.rows(), width, send_);
    exchange_slices(comm_, slices_, send_, slices_, receive_, width);
    sum_copies(copied_, offsets_, entries_, receive_, copies_, width, values);
}

std::size_t SharedRows::bytes() const {
    return 4 * (rows_.span() + copied_.span() + offsets_.span() + entries_.span() + first_.span()) +
           8 * (send_.span() + receive_.span());
}

} // namespace treacle
