#include "mpi/halo.hpp"

#include "mpi/pack.hpp"

#include <cstring>
#include <numeric>

namespace treacle {

void Halo::connect(const Decomposition& decomposition) {
    comm_ = decomposition.comm();
    neighbours_.clear();
    const auto& grid = decomposition.grid();
    const auto& boxes = decomposition.boxes();
    const CellBox mine = decomposition.box();
    int images[3];
    for (int k = 0; k < 3; ++k) images[k] = grid.periodic(k) ? 1 : 0;
    for (int rank = 0; rank < static_cast<int>(boxes.size()); ++rank) {
        if (mine.empty() || boxes[static_cast<std::size_t>(rank)].empty()) continue;
        for (int sz = -images[2]; sz <= images[2]; ++sz) {
            for (int sy = -images[1]; sy <= images[1]; ++sy) {
                for (int sx = -images[0]; sx <= images[0]; ++sx) {
                    if (rank == comm_.rank() && sx == 0 && sy == 0 && sz == 0) continue;
                    const int image[3] = {sx, sy, sz};
                    Neighbour neighbour{rank, {}, {}, {}};
                    CellBox needed = boxes[static_cast<std::size_t>(rank)];
                    for (int k = 0; k < 3; ++k) {
                        neighbour.shift[k] = image[k] * grid.count[k];
                        neighbour.offset[k] = image[k] * grid.period[k];
                        needed.lo[k] -= neighbour.shift[k] + grid.halo_width(k);
                        needed.hi[k] += grid.halo_width(k) - neighbour.shift[k];
                    }
                    neighbour.region = intersect(mine, needed);
                    if (!neighbour.region.empty()) neighbours_.push_back(neighbour);
                }
            }
        }
    }
}

namespace {
// Header that a rank sends its neighbour for one region: the cells, in the receiver's numbering, and the particles of
// each; the particles follow later in this order.
struct RegionHeader {
    CellBox cells;
    double offset[3];
};
} // namespace

void Halo::select_sent_rows(const ParticleStore& store, const CellList& cells, std::vector<Message>& messages) {
    outgoing_ = {};
    // The counts of border cells pass through the host: they are the message that announces the ghosts.
    const auto begin = on_host(cells.begin);
    const auto end = on_host(cells.end);
    auto& rows = chosen_;
    rows.clear();
    for (const auto& neighbour : neighbours_) {
        const CellBox region = intersect(neighbour.region, cells.window);
        if (store.owned() == 0 || region.empty()) continue;
        RegionHeader header{region, {neighbour.offset[0], neighbour.offset[1], neighbour.offset[2]}};
        for (int k = 0; k < 3; ++k) {
            header.cells.lo[k] += neighbour.shift[k];
            header.cells.hi[k] += neighbour.shift[k];
        }
        std::vector<int> counts;
        counts.reserve(static_cast<std::size_t>(region.size()));
        const std::size_t before = rows.size();
        for (int z = region.lo[2]; z < region.hi[2]; ++z) {
            for (int y = region.lo[1]; y < region.hi[1]; ++y) {
                for (int x = region.lo[0]; x < region.hi[0]; ++x) {
                    const int c = cells.window.index(x, y, z);
                    const auto first = rows.size();
                    counts.push_back(end(c) - begin(c));
                    rows.resize(first + static_cast<std::size_t>(counts.back()));
                    std::iota(rows.begin() + static_cast<std::ptrdiff_t>(first), rows.end(), begin(c));
                }
            }
        }
        if (rows.size() == before) continue;
        Message message{neighbour.rank, std::vector<char>(sizeof header + counts.size() * sizeof(int))};
        std::memcpy(message.bytes.data(), &header, sizeof header);
        std::memcpy(message.bytes.data() + sizeof header, counts.data(), counts.size() * sizeof(int));
        messages.push_back(std::move(message));
        outgoing_.ranks.push_back(neighbour.rank);
        outgoing_.offsets.push_back(static_cast<std::int64_t>(rows.size()));
    }
    assign(rows_, rows);
}

void Halo::enter_ghost_cells(const std::vector<Message>& messages, CellList& cells, ParticleStore& store) {
    incoming_ = {};
    incoming_offset_.clear();
    auto begin = on_host(cells.begin);
    auto end = on_host(cells.end);
    int row = store.owned();
    for (const auto& message : messages) {
        RegionHeader header;
        std::memcpy(&header, message.bytes.data(), sizeof header);
        std::vector<int> counts(static_cast<std::size_t>(header.cells.size()));
        std::memcpy(counts.data(), message.bytes.data() + sizeof header, counts.size() * sizeof(int));
        std::size_t k = 0;
        for (int z = header.cells.lo[2]; z < header.cells.hi[2]; ++z) {
            for (int y = header.cells.lo[1]; y < header.cells.hi[1]; ++y) {
                for (int x = header.cells.lo[0]; x < header.cells.hi[0]; ++x, ++k) {
                    const int c[3] = {x, y, z};
                    // Cells outside of the window are out of reach of the particles of this rank.
                    if (cells.window.contains(c)) {
                        begin(cells.window.index(x, y, z)) = row;
                        end(cells.window.index(x, y, z)) = row + counts[k];
                    }
                    row += counts[k];
                }
            }
        }
        incoming_.ranks.push_back(message.rank);
        incoming_.offsets.push_back(row - store.owned());
        incoming_offset_.push_back({header.offset[0], header.offset[1], header.offset[2]});
    }
    Kokkos::deep_copy(cells.begin, begin);
    Kokkos::deep_copy(cells.end, end);
    store.resize_ghosts(row - store.owned());
}

void Halo::rebuild(ParticleStore& store, CellList& cells) {
    if (neighbours_.empty() && comm_.size() == 1) {
        outgoing_ = {};
        incoming_ = {};
        store.resize_ghosts(0);
        return;
    }
    std::vector<Message> messages;
    select_sent_rows(store, cells, messages);
    enter_ghost_cells(exchange_sparse(comm_, messages), cells, store);
    gather(store, {0, 1});
    shift_images(store);
}

namespace {
struct Offset {
    double along[3]; // [m]
    bool is_none() const { return along[0] == 0 && along[1] == 0 && along[2] == 0; }
};

void shift_rows(const Array3& x, int first, int n, const Offset& by) {
    Kokkos::parallel_for(
        "treacle::shift_images", n, KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) x(first + i, k) += by.along[k];
        });
}
} // namespace

void Halo::shift_images(const ParticleStore& store) {
    const auto x = store.position();
    for (std::size_t k = 0; k < incoming_offset_.size(); ++k) {
        const Offset by{incoming_offset_[k][0], incoming_offset_[k][1], incoming_offset_[k][2]};
        if (by.is_none()) continue;
        const int first = store.owned() + static_cast<int>(incoming_.offsets[k]);
        const int n = static_cast<int>(incoming_.offsets[k + 1] - incoming_.offsets[k]);
        shift_rows(x, first, n, by);
    }
}

namespace {
int width_of(const ParticleStore& store, std::initializer_list<int> fields) {
    int width = 0;
    for (const int field : fields) width += components(store.fields()[static_cast<std::size_t>(field)]);
    return width;
}
} // namespace

void Halo::gather(const ParticleStore& store, std::initializer_list<int> fields) {
    if (outgoing_.ranks.empty() && incoming_.ranks.empty()) return;
    const int width = width_of(store, fields);
    const int n_send = static_cast<int>(outgoing_.rows()), n_receive = static_cast<int>(incoming_.rows());
    reserve(send_, static_cast<std::size_t>(n_send) * width);
    reserve(receive_, static_cast<std::size_t>(n_receive) * width);
    int column = 0;
    for (const int field : fields) {
        const auto& info = store.fields()[static_cast<std::size_t>(field)];
        std::visit([&](const auto& view) { pack_rows(view, rows_, n_send, {send_, width, column}); }, info.array);
        column += components(info);
    }
    exchange_slices(comm_, {outgoing_, send_}, {incoming_, receive_}, width);
    column = 0;
    for (const int field : fields) {
        const auto& info = store.fields()[static_cast<std::size_t>(field)];
        std::visit(
            [&](const auto& view) {
                unpack_rows(view, store.owned(), n_receive, {receive_, width, column});
            },
            info.array);
        column += components(info);
    }
}

namespace {
// Rows [first, last) of the message onto their owners; within one slice each owner appears once.
template <class View>
void add_rows(
    const View& field, const Array<int>& rows, std::int64_t first, std::int64_t last, const BufferColumns& from) {
    const int n = static_cast<int>(last - first);
    Kokkos::parallel_for(
        "treacle::add_rows", n, KOKKOS_LAMBDA(int k) { add_row(field, rows(first + k), from.row(first + k)); });
}

template <class View>
void pack_ghosts(const View& field, int first, int n, const BufferColumns& to) {
    Kokkos::parallel_for(
        "treacle::pack_ghosts", n, KOKKOS_LAMBDA(int k) { pack_row(field, first + k, to.row(k)); });
}

template <class Work>
void visit_doubles(const Field& field, const Work& work) {
    if (const auto* one = std::get_if<Array<double>>(&field.array)) {
        work(*one);
    } else {
        work(std::get<Array3>(field.array));
    }
}
} // namespace

void Halo::scatter(const ParticleStore& store, std::initializer_list<int> fields) {
    if (outgoing_.ranks.empty() && incoming_.ranks.empty()) return;
    const int width = width_of(store, fields);
    const int n_ghosts = static_cast<int>(incoming_.rows());
    reserve(receive_, static_cast<std::size_t>(n_ghosts) * width);
    reserve(send_, static_cast<std::size_t>(outgoing_.rows()) * width);
    int column = 0;
    for (const int field : fields) {
        const auto& info = store.fields()[static_cast<std::size_t>(field)];
        visit_doubles(info, [&](const auto& view) {
            pack_ghosts(view, store.owned(), n_ghosts, {receive_, width, column});
        });
        column += components(info);
    }
    exchange_slices(comm_, {incoming_, receive_}, {outgoing_, send_}, width);
    for (std::size_t k = 0; k + 1 < outgoing_.offsets.size(); ++k) {
        column = 0;
        for (const int field : fields) {
            const auto& info = store.fields()[static_cast<std::size_t>(field)];
            visit_doubles(info, [&](const auto& view) {
                add_rows(view, rows_, outgoing_.offsets[k], outgoing_.offsets[k + 1], {send_, width, column});
            });
            column += components(info);
        }
    }
}

} // namespace treacle
