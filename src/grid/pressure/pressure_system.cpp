#include "grid/pressure/pressure_system.hpp"

#include "kokkos/scan.hpp"
#include "solve/rows/host_blocks.hpp"

#include <algorithm>

namespace treacle::grid {

namespace {
// The owned cells in blocks of 2 x 2 x 2, block after block; some of those at the rim lie outside.
struct BlockOrder {
    CellBox owned;
    int lo[3]{}, blocks[3]{};

    explicit BlockOrder(const CellBox& box) : owned(box) {
        for (int k = 0; k < 3; ++k) {
            lo[k] = half(box.lo[k]);
            blocks[k] = box.empty() ? 0 : half(box.hi[k] - 1) - lo[k] + 1;
        }
    }
    int count() const { return 8 * blocks[0] * blocks[1] * blocks[2]; }
    KOKKOS_INLINE_FUNCTION bool cell(int i, int c[3]) const {
        const int block = i / 8;
        c[0] = 2 * (lo[0] + block % blocks[0]) + (i & 1);
        c[1] = 2 * (lo[1] + block / blocks[0] % blocks[1]) + ((i >> 1) & 1);
        c[2] = 2 * (lo[2] + block / (blocks[0] * blocks[1])) + ((i >> 2) & 1);
        return owned.contains(c);
    }
    static int half(int c) { return c >= 0 ? c / 2 : -((1 - c) / 2); }
};

// Calls use(axis, face, neighbour, sign) for the open faces of a cell; sign +1 where the neighbour is above.
template <class Use>
KOKKOS_INLINE_FUNCTION void each_face(const PressureFaces& faces, std::size_t cell, const Use& use) {
    for (int a = 0; a < faces.dimensions; ++a) {
        const auto stride = static_cast<std::size_t>(faces.stride[a]);
        use(a, cell, cell - stride, -1.0);
        use(a, cell + stride, cell + stride, 1.0);
    }
}

struct NumberLoop {
    PressureFaces faces;
    BlockOrder order;
    Array<int> row_of, cell_of;
    int first;
    bool write;

    KOKKOS_INLINE_FUNCTION void operator()(int i, int& sum, bool last) const {
        int c[3];
        if (!order.cell(i, c)) return;
        const auto cell = static_cast<std::size_t>(faces.window.index(c[0], c[1], c[2]));
        bool unknown = false;
        if (faces.is_liquid(cell)) {
            each_face(faces, cell,
                [&](int a, std::size_t face, std::size_t, double) { unknown = unknown || faces.open(a, face) > 0; });
        }
        if (last && write) {
            row_of(cell) = unknown ? first + sum : -1;
            if (unknown) cell_of(sum) = static_cast<int>(cell);
        }
        sum += static_cast<int>(unknown);
    }
};

struct CountLoop {
    PressureFaces faces;
    Array<int> row_of, cell_of, own, other;
    int first, rows;

    KOKKOS_INLINE_FUNCTION void operator()(int r) const {
        int here = 1, there = 0; // the diagonal
        each_face(faces, static_cast<std::size_t>(cell_of(r)), [&](int a, std::size_t face, std::size_t next, double) {
            if (row_of(next) < 0 || !(faces.open(a, face) > 0)) return;
            const bool inside = row_of(next) >= first && row_of(next) < first + rows;
            here += static_cast<int>(inside);
            there += static_cast<int>(!inside);
        });
        own(r) = here;
        other(r) = there;
    }
};

// One row of a block while it is filled, its columns kept rising.
struct RisingRow {
    int* column;
    double* value;
    int count = 0;

    KOKKOS_INLINE_FUNCTION void add(int c, double v) {
        int k = count;
        while (k > 0 && column[k - 1] > c) {
            column[k] = column[k - 1];
            value[k] = value[k - 1];
            --k;
        }
        column[k] = c;
        value[k] = v;
        ++count;
    }
};

struct FillLoop {
    PressureFaces faces;
    Array<int> row_of, cell_of, halo_column;
    PressureSystem::Block own, other;
    Array<double> dirichlet_diagonal;
    int first, rows;

    KOKKOS_INLINE_FUNCTION void operator()(int r) const {
        RisingRow here{own.column.data() + own.offset(r), own.value.data() + own.offset(r)};
        RisingRow there{other.column.data() + other.offset(r), other.value.data() + other.offset(r)};
        const auto cell = static_cast<std::size_t>(cell_of(r));
        double diagonal = 0, surface = 0;
        each_face(faces, cell, [&](int a, std::size_t face, std::size_t next, double) {
            const double area = faces.open(a, face);
            if (!(area > 0)) return;
            if (!faces.is_liquid(next)) {
                surface += area / faces.theta(cell, next);
                return;
            }
            diagonal += area;
            const int column = row_of(next) - first;
            if (column >= 0 && column < rows) {
                here.add(column, -area);
            } else {
                there.add(halo_column(next), -area);
            }
        });
        here.add(r, diagonal + surface);
        dirichlet_diagonal(r) = surface;
    }
};

struct DivergenceLoop {
    PressureFaces faces;
    Array<int> cell_of;
    FaceField velocity;
    double scale;
    Array<double> out;

    KOKKOS_INLINE_FUNCTION void operator()(int r) const {
        const auto cell = static_cast<std::size_t>(cell_of(r));
        double flux = 0, surface = 0;
        each_face(faces, cell, [&](int a, std::size_t face, std::size_t next, double sign) {
            const double area = faces.open(a, face);
            if (!(area > 0)) return;
            flux += sign * area * velocity.axis[a](face);
            if (!faces.is_liquid(next)) {
                surface += area / faces.theta(cell, next) * faces.surface_pressure(cell, next);
            }
        });
        out(r) = surface - scale * flux;
    }
};

struct GradientLoop {
    PressureFaces faces;
    CellBox owned;
    Array<double> pressure;
    double scale;
    FaceField velocity;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        int c[3];
        owned.cell(i, c);
        const auto above = static_cast<std::size_t>(faces.window.index(c[0], c[1], c[2]));
        for (int a = 0; a < faces.dimensions; ++a) {
            if (!(faces.open(a, above) > 0)) continue;
            const auto below = above - static_cast<std::size_t>(faces.stride[a]);
            const bool wet = faces.is_liquid(above), wet_below = faces.is_liquid(below);
            if (!wet && !wet_below) continue;
            double rise = pressure(above) - pressure(below);
            if (!wet) rise = (faces.surface_pressure(below, above) - pressure(below)) / faces.theta(below, above);
            if (!wet_below) rise = (pressure(above) - faces.surface_pressure(above, below)) / faces.theta(above, below);
            velocity.axis[a](above) -= rise / scale;
        }
    }
};
} // namespace

void PressureSystem::number_rows(const Comm& comm, CellHalo& halo) {
    const auto window_size = static_cast<std::size_t>(faces_.window.size());
    reserve(row_of_, window_size);
    Kokkos::deep_copy(row_of_, -1);
    const BlockOrder order(owned_);
    NumberLoop loop{faces_, order, row_of_, cell_of_, 0, false};
    rows_ = 0;
    Kokkos::parallel_scan("treacle::count_pressure_rows", order.count(), loop, rows_);
    first_row_ = comm.exclusive_sum(static_cast<std::int64_t>(rows_));
    global_rows_ = comm.sum(static_cast<std::int64_t>(rows_));
    reserve(cell_of_, static_cast<std::size_t>(rows_));
    loop.cell_of = cell_of_;
    loop.first = static_cast<int>(first_row_);
    loop.write = true;
    Kokkos::parallel_scan("treacle::number_pressure_rows", order.count(), loop, rows_);
    halo.gather({row_of_});
}

// On the host, where the halo is: the one layer of cells around the owned ones.
void PressureSystem::connect_halo(const Comm& comm, const CellHalo& halo) {
    const auto& window = halo.window();
    const auto row = on_host(row_of_);
    const auto is_other = [&](int r) { return r >= 0 && (r < first_row_ || r >= first_row_ + rows_); };
    const auto each_neighbour = [&](const auto& use) {
        for (int a = 0; a < faces_.dimensions && !owned_.empty(); ++a) {
            for (const int at : {owned_.lo[a] - 1, owned_.hi[a]}) {
                CellBox side = owned_;
                side.lo[a] = at;
                side.hi[a] = at + 1;
                for (int i = 0; i < side.size(); ++i) {
                    int c[3];
                    side.cell(i, c);
                    const int index = window.index(c[0], c[1], c[2]);
                    if (is_other(row(static_cast<std::size_t>(index)))) use(index);
                }
            }
        }
    };
    columns_.clear();
    each_neighbour([&](int at) { columns_.push_back(row(static_cast<std::size_t>(at))); });
    std::sort(columns_.begin(), columns_.end());
    columns_.erase(std::unique(columns_.begin(), columns_.end()), columns_.end());
    halo_.connect(comm, first_row_, columns_);
    reserve(halo_column_, static_cast<std::size_t>(window.size()));
    auto halo_column = Kokkos::create_mirror_view(halo_column_);
    each_neighbour([&](int at) {
        const auto number = row(static_cast<std::size_t>(at));
        halo_column(static_cast<std::size_t>(at)) =
            static_cast<int>(std::lower_bound(columns_.begin(), columns_.end(), number) - columns_.begin());
    });
    Kokkos::deep_copy(halo_column_, halo_column);
}

void PressureSystem::count_entries() {
    const auto n = static_cast<std::size_t>(rows_);
    reserve(own_.offset, n + 1);
    reserve(other_.offset, n + 1);
    Kokkos::parallel_for("treacle::count_pressure_entries", rows_,
        CountLoop{faces_, row_of_, cell_of_, own_.offset, other_.offset, static_cast<int>(first_row_), rows_});
    for (auto* block : {&own_, &other_}) {
        const auto entries = static_cast<std::size_t>(counts_to_offsets(block->offset, rows_));
        reserve(block->column, entries);
        reserve(block->value, entries);
    }
}

void PressureSystem::fill() {
    reserve(dirichlet_diagonal_, static_cast<std::size_t>(rows_));
    Kokkos::parallel_for("treacle::fill_pressure_matrix", rows_,
        FillLoop{faces_, row_of_, cell_of_, halo_column_, own_, other_, dirichlet_diagonal_,
            static_cast<int>(first_row_), rows_});
}

void PressureSystem::assemble(const Comm& comm, CellHalo& halo, const PressureFaces& faces) {
    faces_ = faces;
    owned_ = halo.owned();
    number_rows(comm, halo);
    connect_halo(comm, halo);
    count_entries();
    fill();
}

PressureSystem::Host PressureSystem::to_host() const {
    return {{on_host(own_.offset), on_host(own_.column), on_host(own_.value)},
        {on_host(other_.offset), on_host(other_.column), on_host(other_.value)}, on_host(dirichlet_diagonal_)};
}

solve::CsrBlocks PressureSystem::blocks(const Host& host) {
    return solve::csr_blocks(host.own, host.other, halo_, {first_row_, rows_, global_rows_});
}

std::vector<int> PressureSystem::aggregates() const {
    std::vector<int> out(3 * static_cast<std::size_t>(rows_));
    const auto cells = on_host(cell_of_);
    for (std::size_t r = 0; r < static_cast<std::size_t>(rows_); ++r) {
        int c[3];
        faces_.window.cell(cells(r), c);
        for (std::size_t k = 0; k < 3; ++k) out[3 * r + k] = BlockOrder::half(c[k]);
    }
    return out;
}

void PressureSystem::to_cells(const Array<double>& solution, const Array<double>& cells) const {
    const auto cell_of = cell_of_;
    Kokkos::deep_copy(cells, 0.0);
    Kokkos::parallel_for(
        "treacle::pressure_to_cells", rows_, KOKKOS_LAMBDA(int r) { cells(cell_of(r)) = solution(r); });
}

std::size_t PressureSystem::bytes() const {
    std::size_t total = 4 * (row_of_.span() + cell_of_.span() + halo_column_.span() + columns_.capacity()) +
                        8 * dirichlet_diagonal_.span() + halo_.bytes();
    for (const auto* block : {&own_, &other_}) {
        total += 4 * (block->offset.span() + block->column.span()) + 8 * block->value.span();
    }
    return total;
}

void divergence(const PressureFaces& faces, const PressureSystem& system, const FaceField& velocity, double scale,
    const Array<double>& out) {
    Kokkos::parallel_for(
        "treacle::divergence", system.rows(), DivergenceLoop{faces, system.cell_of(), velocity, scale, out});
}

void subtract_gradient(const PressureFaces& faces, const CellBox& owned, const Array<double>& pressure, double scale,
    const FaceField& velocity) {
    Kokkos::parallel_for("treacle::pressure_gradient", static_cast<int>(owned.size()),
        GradientLoop{faces, owned, pressure, scale, velocity});
}

} // namespace treacle::grid
