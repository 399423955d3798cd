#include "mpi/migration.hpp"

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
        std::visit([&](const auto& view) { pack_rows(view, rows, n, buffer, width, column); }, field.array);
        column += components(field);
    }
}

void unpack_state(const ParticleStore& store, int first, int n, const Array<double>& buffer) {
    const int width = state_width(store);
    int column = 0;
    for (const auto& field : store.fields()) {
        if (field.role != FieldRole::state) continue;
        std::visit([&](const auto& view) { unpack_rows(view, first, n, buffer, width, column); }, field.array);
        column += components(field);
    }
}

namespace {
struct Destinations {
    const Array<int>& rank;
    int first, last; // the rows looked at, half-open
};
enum class Chosen { staying, leaving };

// Writes the chosen rows to a list, in order; returns how many.
int select_rows(const Destinations& of, int self, Chosen which, const Array<int>& list) {
    const auto rank = of.rank;
    const int first = of.first;
    const bool staying = which == Chosen::staying;
    int count = 0;
    Kokkos::parallel_scan("treacle::select_rows", of.last - of.first, KOKKOS_LAMBDA(int k, int& sum, bool last) {
        const bool chosen = (rank(first + k) == self) == staying;
        if (last && chosen) list(sum) = first + k;
        sum += static_cast<int>(chosen);
    }, count);
    return count;
}

// Writes each row's rank; counts those that leave, and finds the block of cells of those that stay.
Migration::Outcome find_destinations(const ParticleStore& store, const Decomposition& decomposition,
                                     const Array<int>& destination) {
    Migration::Outcome out;
    if (store.owned() == 0) return out;
    const auto grid = decomposition.grid();
    const auto box = decomposition.box();
    const auto tree = decomposition.tree();
    const int self = decomposition.comm().rank();
    const auto x = store.position();
    auto& cells = out.cells;
    Kokkos::parallel_reduce(
        "treacle::find_destinations", store.owned(),
        KOKKOS_LAMBDA(int i, int& lx, int& ly, int& lz, int& hx, int& hy, int& hz, std::int64_t& left) {
            int c[3];
            grid.locate(x(i, 0), x(i, 1), x(i, 2), c);
            if (!box.contains(c)) {
                destination(i) = tree.owner(c);
                ++left;
                return;
            }
            destination(i) = self;
            lx = math::min(lx, c[0]);
            ly = math::min(ly, c[1]);
            lz = math::min(lz, c[2]);
            hx = math::max(hx, c[0] + 1);
            hy = math::max(hy, c[1] + 1);
            hz = math::max(hz, c[2] + 1);
        },
        Kokkos::Min<int>(cells.lo[0]), Kokkos::Min<int>(cells.lo[1]), Kokkos::Min<int>(cells.lo[2]),
        Kokkos::Max<int>(cells.hi[0]), Kokkos::Max<int>(cells.hi[1]), Kokkos::Max<int>(cells.hi[2]),
        Kokkos::Sum<std::int64_t>(out.left));
    return out;
}
} // namespace

Migration::Outcome Migration::to_owner(ParticleStore& store, const Decomposition& decomposition) {
    const Comm& comm = decomposition.comm();
    if (comm.size() == 1) return {0, occupied_cells(store, decomposition.grid())};
    const int n = store.owned();
    reserve(destination_, static_cast<std::size_t>(n));
    auto outcome = find_destinations(store, decomposition, destination_);
    const int leaving = static_cast<int>(outcome.left);
    const int width = state_width(store);

    std::vector<Message> outgoing;
    if (leaving > 0) {
        reserve(leave_, static_cast<std::size_t>(leaving));
        reserve(fill_, static_cast<std::size_t>(leaving));
        select_rows({destination_, 0, n}, comm.rank(), Chosen::leaving, leave_);
        // The migrants alone pass through the host, to be dealt out by receiver.
        const Array<double> packed("treacle::migrants", static_cast<std::size_t>(leaving) * width);
        pack_state(store, leave_, leaving, packed);
        const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), packed);
        const auto rows = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), leave_);
        const auto targets = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), destination_);
        std::vector<int> order(static_cast<std::size_t>(leaving));
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(),
                         [&](int a, int b) { return targets(rows(a)) < targets(rows(b)); });
        const std::size_t row_bytes = static_cast<std::size_t>(width) * sizeof(double);
        for (const int k : order) {
            const int target = targets(rows(k));
            if (outgoing.empty() || outgoing.back().rank != target) outgoing.push_back({target, {}});
            auto& bytes = outgoing.back().bytes;
            bytes.resize(bytes.size() + row_bytes);
            std::memcpy(bytes.data() + bytes.size() - row_bytes, host.data() + std::size_t(k) * width, row_bytes);
        }
        const int staying = n - leaving;
        const int moving = select_rows({destination_, staying, n}, comm.rank(), Chosen::staying, fill_);
        store.fill_holes(leave_, fill_, moving, staying); // the holes are the first of those that leave
    }

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
