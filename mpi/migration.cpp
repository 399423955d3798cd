#include "mpi/migration.hpp"

#include "kokkos/bounds.hpp"
#include "mpi/pack.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace treacle {

int state_width(const ParticleStore& store) {
    int width = 0;
    for (const auto& field : store.fields()) {
        if (field.role == FieldRole::state) width += components(field);
    }
    return width;
}

void pack_state(const ParticleStore& store, const Array<int>& rows, int n, const Array<double>& buffer) {
    const int width = state_width(store);
    int column = 0;
    for (const auto& field : store.fields()) {
        if (field.role != FieldRole::state) continue;
        std::visit([&](const auto& view) { pack_rows(view, rows, n, {buffer, width, column}); }, field.array);
        column += components(field);
    }
}

void unpack_state(const ParticleStore& store, int first, int n, const Array<double>& buffer) {
    const int width = state_width(store);
    int column = 0;
    for (const auto& field : store.fields()) {
        if (field.role != FieldRole::state) continue;
        std::visit([&](const auto& view) { unpack_rows(view, first, n, {buffer, width, column}); }, field.array);
        column += components(field);
    }
}

namespace {
// Inside of a box of cells by more than round-off; positions nearer to its sides are looked up.
struct Inside {
    double lo[3], hi[3];

    Inside(const CellGrid& grid, const CellBox& box) {
        constexpr double margin = 1e-6; // cells
        for (int k = 0; k < 3; ++k) {
            lo[k] = grid.origin[k] + (box.lo[k] + margin) / grid.inverse_width[k];
            hi[k] = grid.origin[k] + (box.hi[k] - margin) / grid.inverse_width[k];
        }
    }
    KOKKOS_INLINE_FUNCTION bool surely(double x, double y, double z) const {
        return x > lo[0] && x < hi[0] && y > lo[1] && y < hi[1] && z > lo[2] && z < hi[2];
    }
};

// Lists the rows that leave, in any order, and finds the block of cells of those that stay.
Migration::Outcome find_leaving(
    const ParticleStore& store, const Decomposition& decomposition, const Array<int>& leave, const Array<int>& listed) {
    const auto grid = decomposition.grid();
    const auto box = decomposition.box();
    const Inside inside(grid, box);
    const auto x = store.position();
    Kokkos::deep_copy(listed, 0);
    int left = 0;
    const auto bounds = reduce_bounds(
        "treacle::find_leaving", 0, store.owned(), left, KOKKOS_LAMBDA(int i, Bounds& around, int& count) {
            bool stays = inside.surely(x(i, 0), x(i, 1), x(i, 2));
            if (!stays) {
                int c[3];
                grid.locate(x(i, 0), x(i, 1), x(i, 2), c);
                stays = box.contains(c);
            }
            if (stays) {
                around.include(x(i, 0), x(i, 1), x(i, 2));
            } else {
                ++count;
                leave(Kokkos::atomic_fetch_add(&listed(0), 1)) = i;
            }
        });
    return {left, bounds.cells(grid)};
}

void find_owners(const ParticleStore& store, const Decomposition& decomposition, const Array<int>& rows, int n,
    const Array<int>& owner) {
    const auto grid = decomposition.grid();
    const auto tree = decomposition.tree();
    const auto x = store.position();
    Kokkos::parallel_for(
        "treacle::find_owners", n, KOKKOS_LAMBDA(int k) {
            int c[3];
            grid.locate(x(rows(k), 0), x(rows(k), 1), x(rows(k), 2), c);
            owner(k) = tree.owner(c);
        });
}

template <class View>
auto first_of(const View& list, int n) {
    return Kokkos::subview(list, std::pair(0, n));
}
} // namespace

// Packs the rows that leave, by receiver, and closes the gaps. The migrants alone pass through the host.
std::vector<Message> Migration::take_out(ParticleStore& store, const Decomposition& decomposition, int leaving) {
    const int width = state_width(store);
    const int staying = store.owned() - leaving;
    for (auto* list : {&owner_, &fill_}) reserve(*list, static_cast<std::size_t>(leaving));
    reserve(packed_, static_cast<std::size_t>(leaving) * static_cast<std::size_t>(width));

    const auto rows = on_host(first_of(leave_, leaving));
    std::sort(rows.data(), rows.data() + leaving);
    Kokkos::deep_copy(first_of(leave_, leaving), rows);
    find_owners(store, decomposition, leave_, leaving, owner_);
    pack_state(store, leave_, leaving, packed_);
    const auto owners = on_host(first_of(owner_, leaving));
    const auto packed = on_host(first_of(packed_, leaving * width));

    std::vector<int> order(static_cast<std::size_t>(leaving));
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return owners(a) < owners(b); });
    const std::size_t row_bytes = static_cast<std::size_t>(width) * sizeof(double);
    std::vector<Message> outgoing;
    for (const int k : order) {
        if (outgoing.empty() || outgoing.back().rank != owners(k)) outgoing.push_back({owners(k), {}});
        auto& bytes = outgoing.back().bytes;
        bytes.resize(bytes.size() + row_bytes);
        std::memcpy(bytes.data() + bytes.size() - row_bytes, packed.data() + std::size_t(k) * width, row_bytes);
    }

    // The holes are the first of those that leave; the last rows that stay fill them.
    const auto fillers = first_of(fill_, leaving);
    const auto fill = Kokkos::create_mirror_view(Kokkos::HostSpace(), fillers);
    int moving = 0;
    const int* gone = std::lower_bound(rows.data(), rows.data() + leaving, staying);
    for (int row = staying; row < store.owned(); ++row) {
        if (gone != rows.data() + leaving && *gone == row) {
            ++gone;
        } else {
            fill(moving++) = row;
        }
    }
    Kokkos::deep_copy(fillers, fill);
    store.fill_holes(leave_, fill_, moving, staying);
    return outgoing;
}

Migration::Outcome Migration::to_owner(ParticleStore& store, const Decomposition& decomposition) {
    const Comm& comm = decomposition.comm();
    if (comm.size() == 1) return {0, occupied_cells(store, decomposition.grid())};
    reserve(leave_, static_cast<std::size_t>(store.owned()));
    auto outcome = find_leaving(store, decomposition, leave_, listed_);
    const int width = state_width(store);
    std::vector<Message> outgoing;
    if (outcome.left > 0) outgoing = take_out(store, decomposition, static_cast<int>(outcome.left));

    const auto incoming = exchange_sparse(comm, outgoing);
    std::size_t arriving_bytes = 0;
    for (const auto& message : incoming) arriving_bytes += message.bytes.size();
    if (arriving_bytes > 0) {
        const Array<double> arrived("treacle::arrivals", arriving_bytes / sizeof(double));
        auto host = Kokkos::create_mirror_view(arrived);
        char* at = reinterpret_cast<char*>(host.data());
        for (const auto& message : incoming) {
            std::memcpy(at, message.bytes.data(), message.bytes.size());
            at += message.bytes.size();
        }
        Kokkos::deep_copy(arrived, host);
        const int first = store.owned();
        const int count = static_cast<int>(arriving_bytes / sizeof(double)) / width;
        store.resize_owned(first + count);
        unpack_state(store, first, count, arrived);
        outcome.cells = join(outcome.cells, occupied_cells(store, decomposition.grid(), first));
    }
    return outcome;
}

} // namespace treacle
