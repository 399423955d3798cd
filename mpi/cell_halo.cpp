#include "mpi/cell_halo.hpp"

#include "mpi/pack.hpp"

#include <vector>

namespace treacle {

namespace {
CellBox shifted(CellBox box, const int by[3], int sign) {
    for (int k = 0; k < 3; ++k) {
        box.lo[k] += sign * by[k];
        box.hi[k] += sign * by[k];
    }
    return box;
}

// One slice more: the indices of a block of cells in the window.
void add_slice(const CellBox& cells, const CellBox& window, int rank, ExchangePlan& slices, std::vector<int>& indices) {
    for (int z = cells.lo[2]; z < cells.hi[2]; ++z) {
        for (int y = cells.lo[1]; y < cells.hi[1]; ++y) {
            for (int x = cells.lo[0]; x < cells.hi[0]; ++x) indices.push_back(window.index(x, y, z));
        }
    }
    slices.ranks.push_back(rank);
    slices.offsets.push_back(static_cast<std::int64_t>(indices.size()));
}
} // namespace

void CellHalo::connect(const Decomposition& decomposition, const CellBox& active, int layers) {
    comm_ = decomposition.comm();
    active_ = active;
    layers_ = layers;
    const auto& grid = decomposition.grid();
    owned_ = intersect(decomposition.box(), active);
    if (owned_.empty()) owned_ = CellBox{};
    window_ = owned_.empty() ? CellBox{} : grown(owned_, layers, grid.dimensions);
    outgoing_ = incoming_ = {};
    std::vector<int> sent, received;
    int images[3];
    for (int k = 0; k < 3; ++k) images[k] = grid.periodic(k) ? (layers + grid.count[k] - 1) / grid.count[k] : 0;
    // Both sides of a pair of ranks go through the images in the same order, so that their messages pair up.
    for (int rank = 0; rank < comm_.size() && !owned_.empty(); ++rank) {
        const CellBox theirs = intersect(decomposition.boxes()[static_cast<std::size_t>(rank)], active);
        if (theirs.empty()) continue;
        for (int sz = -images[2]; sz <= images[2]; ++sz) {
            for (int sy = -images[1]; sy <= images[1]; ++sy) {
                for (int sx = -images[0]; sx <= images[0]; ++sx) {
                    if (rank == comm_.rank() && sx == 0 && sy == 0 && sz == 0) continue;
                    const int shift[3] = {sx * grid.count[0], sy * grid.count[1], sz * grid.count[2]};
                    const CellBox needed = intersect(window_, shifted(theirs, shift, 1));
                    if (!needed.empty()) add_slice(needed, window_, rank, incoming_, received);
                    const CellBox wanted =
                        intersect(owned_, shifted(grown(theirs, layers, grid.dimensions), shift, -1));
                    if (!wanted.empty()) add_slice(wanted, window_, rank, outgoing_, sent);
                }
            }
        }
    }
    assign(sent_, sent);
    assign(received_, received);
}

namespace {
template <class View>
void unpack_cells(const View& field, const Array<int>& indices, int n, const BufferColumns& from) {
    Kokkos::parallel_for(
        "treacle::unpack_cells", n, KOKKOS_LAMBDA(int k) { unpack_row(field, indices(k), from.row(k)); });
}

// Rows [first, last) of the message onto their owners; within one slice each owner appears once.
void add_cells(const Array<double>& field, const Array<int>& indices, std::int64_t first, std::int64_t last,
    const BufferColumns& from) {
    Kokkos::parallel_for(
        "treacle::add_cells", static_cast<int>(last - first),
        KOKKOS_LAMBDA(int k) { field(indices(first + k)) += *from.row(first + k); });
}

// Parts that both directions share: the message of a list of fields, from their places to the other side's.
struct Passage {
    const Comm& comm;
    const ExchangePlan& outgoing;
    const Array<int>& from;
    Array<double>& send;
    const ExchangePlan& incoming;
    Array<double>& receive;
};

template <class Fields>
void carry(const Passage& passage, const Fields& fields) {
    const int width = static_cast<int>(fields.size());
    const int n_send = static_cast<int>(passage.outgoing.rows());
    reserve(passage.send, static_cast<std::size_t>(passage.outgoing.rows() * width));
    reserve(passage.receive, static_cast<std::size_t>(passage.incoming.rows() * width));
    int column = 0;
    for (const auto& field : fields) pack_rows(field, passage.from, n_send, {passage.send, width, column++});
    exchange_slices(passage.comm, {passage.outgoing, passage.send}, {passage.incoming, passage.receive}, width);
}
} // namespace

template <class Fields>
void CellHalo::bring(const Fields& fields) {
    if (outgoing_.ranks.empty() && incoming_.ranks.empty()) return;
    carry({comm_, outgoing_, sent_, send_, incoming_, receive_}, fields);
    int column = 0;
    for (const auto& field : fields) {
        unpack_cells(field, received_, static_cast<int>(incoming_.rows()),
            {receive_, static_cast<int>(fields.size()), column++});
    }
}

void CellHalo::gather(std::initializer_list<Array<double>> values) { bring(values); }
void CellHalo::gather(std::initializer_list<Array<int>> values) { bring(values); }

namespace {
void pack_blocks(const Array<double>& field, const Array<int>& indices, int n, const Array<double>& buffer, int width) {
    Kokkos::parallel_for(
        "treacle::pack_blocks", n, KOKKOS_LAMBDA(int k) {
            const std::int64_t from = std::int64_t(indices(k)) * width, to = std::int64_t(k) * width;
            for (int c = 0; c < width; ++c) buffer(to + c) = field(from + c);
        });
}
void unpack_blocks(
    const Array<double>& field, const Array<int>& indices, int n, const Array<double>& buffer, int width) {
    Kokkos::parallel_for(
        "treacle::unpack_blocks", n, KOKKOS_LAMBDA(int k) {
            const std::int64_t to = std::int64_t(indices(k)) * width, from = std::int64_t(k) * width;
            for (int c = 0; c < width; ++c) field(to + c) = buffer(from + c);
        });
}
} // namespace

void CellHalo::gather_blocks(const Array<double>& values, int width) {
    if (outgoing_.ranks.empty() && incoming_.ranks.empty()) return;
    reserve(send_, static_cast<std::size_t>(outgoing_.rows() * width));
    reserve(receive_, static_cast<std::size_t>(incoming_.rows() * width));
    pack_blocks(values, sent_, static_cast<int>(outgoing_.rows()), send_, width);
    exchange_slices(comm_, {outgoing_, send_}, {incoming_, receive_}, width);
    unpack_blocks(values, received_, static_cast<int>(incoming_.rows()), receive_, width);
}

void CellHalo::scatter(std::initializer_list<Array<double>> values) {
    if (outgoing_.ranks.empty() && incoming_.ranks.empty()) return;
    carry({comm_, incoming_, received_, receive_, outgoing_, send_}, values);
    const int width = static_cast<int>(values.size());
    for (std::size_t k = 0; k + 1 < outgoing_.offsets.size(); ++k) {
        int column = 0;
        for (const auto& field : values) {
            add_cells(field, sent_, outgoing_.offsets[k], outgoing_.offsets[k + 1], {send_, width, column++});
        }
    }
}

} // namespace treacle
