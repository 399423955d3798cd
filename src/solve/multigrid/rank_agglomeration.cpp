#include "mpi/exchange.hpp"
#include "solve/multigrid/coarsen.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace treacle::solve {

namespace {
constexpr int gathered_ranks = 8;

template <class T>
void put(std::vector<char>& bytes, const std::vector<T>& values) {
    const std::uint64_t count = values.size();
    const std::size_t old = bytes.size();
    bytes.resize(old + sizeof count + count * sizeof(T));
    std::memcpy(&bytes[old], &count, sizeof count);
    if (count > 0) std::memcpy(&bytes[old + sizeof count], values.data(), count * sizeof(T));
}

// Appends, and returns how many.
template <class T>
std::size_t get(const std::vector<char>& bytes, std::size_t& at, std::vector<T>& values) {
    std::uint64_t count = 0;
    std::memcpy(&count, &bytes[at], sizeof count);
    at += sizeof count;
    const std::size_t old = values.size();
    values.resize(old + count);
    if (count > 0) std::memcpy(&values[old], &bytes[at], count * sizeof(T));
    at += count * sizeof(T);
    return count;
}

void append(CoarseRows& made, CellSet& dropped, const std::vector<char>& bytes) {
    std::size_t at = 0;
    std::vector<Index> offsets;
    const std::size_t count = get(bytes, at, offsets);
    const Index base = made.matrix.offsets.back();
    for (std::size_t k = 1; k < count; ++k) made.matrix.offsets.push_back(base + offsets[k]);
    get(bytes, at, made.matrix.columns);
    get(bytes, at, made.matrix.values);
    get(bytes, at, made.keys);
    get(bytes, at, made.walls);
    get(bytes, at, made.centres);
    get(bytes, at, dropped);
}
} // namespace

int RankAgglomeration::wider(const Comm& comm, int stride, std::int64_t rows, std::int64_t rows_wanted) {
    const auto holders = [&] { return (comm.size() + stride - 1) / stride; };
    while (holders() > 1 && rows < rows_wanted * holders()) stride *= gathered_ranks;
    return stride;
}

void RankAgglomeration::move(const Comm& comm, int stride, Index first_made, CoarseRows& made, CellSet& dropped) {
    moved_ = stride > 1;
    if (!moved_) return;
    const int leader = comm.rank() - comm.rank() % stride;
    leads_ = leader == comm.rank();
    first_made_ = first_made;
    made_rows_ = made.rows();
    std::vector<Message> outgoing;
    if (!leads_) {
        auto& bytes = outgoing.emplace_back(Message{leader, {}}).bytes;
        put(bytes, made.matrix.offsets);
        put(bytes, made.matrix.columns);
        put(bytes, made.matrix.values);
        put(bytes, made.keys);
        put(bytes, made.walls);
        put(bytes, made.centres);
        put(bytes, dropped);
        made.clear();
        dropped.clear();
    }
    for (const auto& message : exchange_sparse(comm, outgoing)) append(made, dropped, message.bytes);
    sort_unique(dropped);
}

void RankAgglomeration::connect(const Comm& comm, const Level& level) {
    if (!moved_) return;
    const auto list = [&](Index first, Index last) {
        numbers_.resize(static_cast<std::size_t>(std::max(0, last - first)));
        std::iota(numbers_.begin(), numbers_.end(), first);
        return std::span<const Index>(numbers_);
    };
    const Index end = first_made_ + made_rows_;
    down_.connect(comm, first_made_, leads_ ? list(end, first_made_ + level.rows) : list(0, 0));
    up_.connect(comm, level.first_row, leads_ ? list(0, 0) : list(first_made_, end));
}

void RankAgglomeration::down(std::span<const double> made, std::span<double> level) {
    const auto others = down_.gather(made);
    if (!leads_) return;
    std::copy(made.begin(), made.end(), level.begin());
    std::copy(others.begin(), others.end(), level.begin() + static_cast<std::ptrdiff_t>(made.size()));
}

void RankAgglomeration::up(std::span<const double> level, std::span<double> made) {
    const auto mine = up_.gather(level);
    const auto from = leads_ ? level.first(made.size()) : mine;
    std::copy(from.begin(), from.end(), made.begin());
}

} // namespace treacle::solve
