#include "surface/field/tile_halo.hpp"

#include <cstdint>
#include <cstring>

namespace treacle::surface {

namespace {
// A block of this rank's tiles that a neighbour, or a periodic image of one, has around its own.
struct Region {
    int rank;
    CellBox mine;   // in my numbering
    CellBox theirs; // in the receiver's
};

std::vector<Region> find_regions(const Decomposition& decomposition) {
    std::vector<Region> out;
    const auto& grid = decomposition.grid();
    const auto& boxes = decomposition.boxes();
    const CellBox mine = decomposition.box();
    if (mine.empty()) return out;
    int images[3];
    for (int k = 0; k < 3; ++k) images[k] = grid.periodic(k) ? 1 : 0;
    for (int rank = 0; rank < static_cast<int>(boxes.size()); ++rank) {
        const CellBox& box = boxes[static_cast<std::size_t>(rank)];
        if (box.empty()) continue;
        for (int z = -images[2]; z <= images[2]; ++z) {
            for (int y = -images[1]; y <= images[1]; ++y) {
                for (int x = -images[0]; x <= images[0]; ++x) {
                    if (rank == decomposition.comm().rank() && x == 0 && y == 0 && z == 0) continue;
                    const int image[3] = {x, y, z};
                    CellBox needed = grown(box, 1, grid.dimensions);
                    for (int k = 0; k < 3; ++k) {
                        needed.lo[k] -= image[k] * grid.count[k];
                        needed.hi[k] -= image[k] * grid.count[k];
                    }
                    Region region{rank, intersect(mine, needed), {}};
                    if (region.mine.empty()) continue;
                    region.theirs = region.mine;
                    for (int k = 0; k < 3; ++k) {
                        region.theirs.lo[k] += image[k] * grid.count[k];
                        region.theirs.hi[k] += image[k] * grid.count[k];
                    }
                    out.push_back(region);
                }
            }
        }
    }
    return out;
}

template <class Visit>
void for_each_tile(const CellBox& box, const Visit& visit) {
    for (int z = box.lo[2]; z < box.hi[2]; ++z) {
        for (int y = box.lo[1]; y < box.hi[1]; ++y) {
            for (int x = box.lo[0]; x < box.hi[0]; ++x) visit(x, y, z);
        }
    }
}
} // namespace

int TileHalo::connect(const Decomposition& decomposition, const CellBox& window, std::vector<int>& codes) {
    comm_ = decomposition.comm();
    const auto code = [&](int x, int y, int z) -> int& {
        return codes[static_cast<std::size_t>(window.index(x, y, z))];
    };
    const auto regions = find_regions(decomposition);
    std::vector<Message> messages;
    for (const auto& region : regions) {
        Message message{region.rank, std::vector<char>(sizeof(CellBox))};
        std::memcpy(message.bytes.data(), &region.theirs, sizeof(CellBox));
        for_each_tile(region.mine, [&](int x, int y, int z) {
            const int c = code(x, y, z);
            message.bytes.push_back(static_cast<char>(c >= 0 ? 0 : c));
        });
        messages.push_back(std::move(message));
    }
    const auto arrived = exchange_sparse(comm_, messages);
    std::vector<CellBox> blocks;
    for (const auto& message : arrived) {
        std::memcpy(&blocks.emplace_back(), message.bytes.data(), sizeof(CellBox));
        std::size_t k = sizeof(CellBox);
        for_each_tile(
            blocks.back(), [&](int x, int y, int z) { code(x, y, z) = static_cast<std::int8_t>(message.bytes[k++]); });
    }
    int slots = 0;
    for (int& c : codes) {
        if (c >= 0) c = slots++;
    }
    std::vector<int> sent, received;
    outgoing_ = {};
    incoming_ = {};
    const auto list = [&](const CellBox& box, std::vector<int>& slots_of, ExchangePlan& slices, int rank) {
        const auto before = slots_of.size();
        for_each_tile(box, [&](int x, int y, int z) {
            if (code(x, y, z) >= 0) slots_of.push_back(code(x, y, z));
        });
        if (slots_of.size() == before) return;
        slices.ranks.push_back(rank);
        slices.offsets.push_back(static_cast<std::int64_t>(slots_of.size()));
    };
    for (const auto& region : regions) list(region.mine, sent, outgoing_, region.rank);
    for (std::size_t k = 0; k < arrived.size(); ++k) list(blocks[k], received, incoming_, arrived[k].rank);
    assign(sent_, sent);
    assign(received_, received);
    return slots;
}

void TileHalo::gather(const NodeField& field) {
    const int nodes = field.nodes();
    const auto value = field.value;
    const std::int64_t out = outgoing_.rows() * nodes, in = incoming_.rows() * nodes;
    reserve(send_, static_cast<std::size_t>(out));
    reserve(receive_, static_cast<std::size_t>(in));
    const auto send = send_, receive = receive_;
    const auto sent = sent_, received = received_;
    Kokkos::parallel_for(
        "treacle::pack_tiles", out,
        KOKKOS_LAMBDA(std::int64_t k) { send(k) = value(std::int64_t(sent(k / nodes)) * nodes + k % nodes); });
    exchange_slices(comm_, {outgoing_, send_}, {incoming_, receive_}, nodes);
    Kokkos::parallel_for(
        "treacle::unpack_tiles", in,
        KOKKOS_LAMBDA(std::int64_t k) { value(std::int64_t(received(k / nodes)) * nodes + k % nodes) = receive(k); });
}

} // namespace treacle::surface
