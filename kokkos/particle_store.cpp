#include "kokkos/particle_store.hpp"

#include "kokkos/bounds.hpp"

#include <utility>

namespace treacle {

namespace {
template <class View>
void gather_rows(const View& from, const View& to, const Array<int>& order, int n) {
    if constexpr (View::rank == 1) {
        Kokkos::parallel_for(
            "treacle::permute", n, KOKKOS_LAMBDA(int k) { to(k) = from(order(k)); });
    } else {
        Kokkos::parallel_for(
            "treacle::permute", n, KOKKOS_LAMBDA(int k) {
                const int i = order(k);
                for (int c = 0; c < 3; ++c) to(k, c) = from(i, c);
            });
    }
}
} // namespace

ParticleStore::ParticleStore()
    : scratch_{Array<double>("treacle::scratch", 0), Array3("treacle::scratch3", 0),
          Array<std::int64_t>("treacle::scratch_id", 0), Array<int>("treacle::scratch_int", 0)} {
    add<Array3>("position", "m", FieldRole::state);
    add<Array<std::int64_t>>("id", "", FieldRole::state, true);
}

void ParticleStore::resize_owned(int owned) {
    for (auto& field : fields_) {
        const bool keep = field.role == FieldRole::state;
        std::visit(
            [&](auto& view) {
                const auto n = static_cast<std::size_t>(owned);
                if (keep) {
                    reserve_keep(view, n, static_cast<std::size_t>(math::min(owned, owned_)));
                } else {
                    reserve(view, n);
                }
            },
            field.array);
    }
    owned_ = owned;
    ghosts_ = 0;
}

void ParticleStore::resize_ghosts(int ghosts) {
    for (auto& field : fields_) {
        std::visit(
            [&](auto& view) {
                reserve_keep(view, static_cast<std::size_t>(owned_ + ghosts), static_cast<std::size_t>(owned_));
            },
            field.array);
    }
    ghosts_ = ghosts;
}

void ParticleStore::permute(const Array<int>& order, int n) {
    for (auto& field : fields_) {
        if (field.role != FieldRole::state) continue;
        auto& scratch = scratch_[field.array.index()];
        std::visit(
            [&](auto& view) {
                using View = std::decay_t<decltype(view)>;
                auto& to = std::get<View>(scratch);
                reserve(to, static_cast<std::size_t>(n));
                gather_rows(view, to, order, n);
                std::swap(view, to);
            },
            field.array);
    }
    owned_ = n;
    ghosts_ = 0;
}

namespace {
template <class View>
void copy_rows(const View& view, const Array<int>& from, const Array<int>& to, int n) {
    if constexpr (View::rank == 1) {
        Kokkos::parallel_for(
            "treacle::fill_holes", n, KOKKOS_LAMBDA(int k) { view(to(k)) = view(from(k)); });
    } else {
        Kokkos::parallel_for(
            "treacle::fill_holes", n, KOKKOS_LAMBDA(int k) {
                for (int c = 0; c < 3; ++c) view(to(k), c) = view(from(k), c);
            });
    }
}
} // namespace

void ParticleStore::fill_holes(const Array<int>& holes, const Array<int>& from, int n, int owned) {
    for (auto& field : fields_) {
        if (field.role != FieldRole::state) continue;
        std::visit([&](auto& view) { copy_rows(view, from, holes, n); }, field.array);
    }
    owned_ = owned;
    ghosts_ = 0;
}

std::size_t ParticleStore::bytes() const {
    std::size_t total = 0;
    const auto count = [&](const auto& view) { total += view.span() * sizeof(*view.data()); };
    for (const auto& field : fields_) std::visit(count, field.array);
    for (const auto& scratch : scratch_) std::visit(count, scratch);
    return total;
}

int components(const Field& field) { return std::holds_alternative<Array3>(field.array) ? 3 : 1; }

CellBox occupied_cells(const ParticleStore& store, const CellGrid& grid, int first) {
    const auto x = store.position();
    int none = 0;
    return reduce_bounds(
        "treacle::occupied_cells", first, store.owned(), none,
        KOKKOS_LAMBDA(int i, Bounds& around, int&) { around.include(x(i, 0), x(i, 1), x(i, 2)); })
        .cells(grid);
}

namespace {
// Orders the particles of each cell by id: the order of every neighbour sum is then the same on any number
// of ranks. Insertion sort: a cell holds some ten particles, nearly in order.
void order_within_cells(const Array<int>& order, const Array<std::int64_t>& id, const CellList& cells, int n_cells) {
    const auto begin = cells.begin, end = cells.end;
    Kokkos::parallel_for(
        "treacle::order_within_cells", n_cells, KOKKOS_LAMBDA(int c) {
            for (int k = begin(c) + 1; k < end(c); ++k) {
                const int moved = order(k);
                const auto key = id(moved);
                int slot = k;
                for (; slot > begin(c) && id(order(slot - 1)) > key; --slot) order(slot) = order(slot - 1);
                order(slot) = moved;
            }
        });
}
} // namespace

void CellSort::sort(ParticleStore& store, const CellGrid& grid, const CellBox& owned_cells, CellList& cells) {
    auto& window = cells.window;
    window = owned_cells;
    for (int k = 0; k < 3; ++k) {
        window.lo[k] -= grid.halo_width(k);
        window.hi[k] += grid.halo_width(k);
    }
    const int n = store.owned();
    const int n_cells = owned_cells.empty() ? 0 : static_cast<int>(window.size());
    if (n_cells == 0) window = CellBox{};
    reserve(cells.begin, static_cast<std::size_t>(n_cells));
    reserve(cells.end, static_cast<std::size_t>(n_cells));
    reserve(cell_, static_cast<std::size_t>(n));
    reserve(slot_, static_cast<std::size_t>(n));
    reserve(order_, static_cast<std::size_t>(n));

    const auto begin = cells.begin, end = cells.end, cell = cell_, slot = slot_, order = order_;
    const auto box = window;
    const auto x = store.position();
    Kokkos::parallel_for(
        "treacle::clear_cells", n_cells, KOKKOS_LAMBDA(int c) { end(c) = 0; });
    Kokkos::parallel_for(
        "treacle::count_cells", n, KOKKOS_LAMBDA(int i) {
            int c[3];
            grid.locate(x(i, 0), x(i, 1), x(i, 2), c);
            cell(i) = box.index(c[0], c[1], c[2]);
            slot(i) = Kokkos::atomic_fetch_add(&end(cell(i)), 1);
        });
    Kokkos::parallel_scan(
        "treacle::scan_cells", n_cells, KOKKOS_LAMBDA(int c, int& sum, bool last) {
            const int count = end(c);
            if (last) {
                begin(c) = sum;
                end(c) = sum + count;
            }
            sum += count;
        });
    Kokkos::parallel_for(
        "treacle::order_particles", n, KOKKOS_LAMBDA(int i) { order(begin(cell(i)) + slot(i)) = i; });
    order_within_cells(order_, store.id(), cells, n_cells);
    store.permute(order_, n);
}

} // namespace treacle
