#include "sph/pressure_system.hpp"

#include "sph/laplacian.hpp"

namespace treacle::sph {

void PressureSystem::number_rows(const Comm& comm, LiquidParticles& liquid, Halo& halo) {
    const auto role = liquid.role(), row = liquid.row();
    const int n = liquid.store.owned();
    const auto count_rows = [&](int first) {
        int rows = 0;
        Kokkos::parallel_scan("treacle::number_rows", n, KOKKOS_LAMBDA(int i, int& sum, bool last) {
            const bool unknown = role(i) == Role::poisson;
            if (last) row(i) = unknown ? first + sum : -1;
            sum += static_cast<int>(unknown);
        }, rows);
        return rows;
    };
    rows_ = count_rows(0);
    first_row_ = comm.exclusive_sum(static_cast<std::int64_t>(rows_));
    global_rows_ = comm.sum(static_cast<std::int64_t>(rows_));
    if (first_row_ > 0) count_rows(static_cast<int>(first_row_));
    halo.gather(liquid.store, {liquid.row_field()});
}

namespace {
struct CountLoop {
    Array<std::int64_t> offset;
    Array<int> index, row, own, other;
    int first, rows;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        if (row(i) < 0) return;
        int here = 1, there = 0; // the diagonal
        for (std::int64_t k = offset(i); k < offset(i + 1); ++k) {
            const int column = row(index(k)) - first;
            const bool inside = column >= 0 && column < rows;
            here += static_cast<int>(inside);
            there += static_cast<int>(!inside && row(index(k)) >= 0);
        }
        own(row(i) - first) = here;
        other(row(i) - first) = there;
    }
};

std::int64_t counts_to_offsets(const Array<int>& offset, int rows) {
    std::int64_t total = 0;
    Kokkos::parallel_scan("treacle::scan_rows", rows + 1, KOKKOS_LAMBDA(int r, std::int64_t& sum, bool last) {
        const int count = r < rows ? offset(r) : 0;
        if (last) offset(r) = static_cast<int>(sum);
        sum += count;
    }, total);
    return total;
}

// Writes one row entry by entry and keeps its columns rising. Neighbours come in the order of their rows
// except at borders, so that an entry hardly ever moves.
struct RowWriter {
    int* column;
    double* value;
    int size = 0;

    KOKKOS_INLINE_FUNCTION void add(int c, double v) {
        int k = size++;
        for (; k > 0 && column[k - 1] > c; --k) {
            column[k] = column[k - 1];
            value[k] = value[k - 1];
        }
        column[k] = c;
        value[k] = v;
    }
};

// Entries of a row are computed this many at a time, in vector registers, and then put in their places.
constexpr int batch = 32;

template <class Kernel>
struct FillLoop {
    LaplacianWeight<Kernel> laplacian;
    Pairs pairs;
    PressureSystem::Block own, other;
    Array<int> row;
    Array<double> diagonal, source, pressure, right_hand_side, solution;
    int first, rows;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        if (row(i) < 0) return;
        const int r = row(i) - first;
        RowWriter here{own.column.data() + own.offset(r), own.value.data() + own.offset(r)};
        RowWriter there{other.column.data() + other.offset(r), other.value.data() + other.offset(r)};
        const double volume = laplacian.volume(i);
        const auto around = pairs.row(i);
        bool diagonal_written = false;
        double weight[batch];
        for (int start = 0; start < around.count; start += batch) {
            const int size = math::min(batch, around.count - start);
            for (int k = 0; k < size; ++k) {
                const int j = around.index[start + k];
                const double r2 = around.separation(j).r2;
                weight[k] = laplacian.weight(volume + laplacian.volume(j), r2, math::sqrt(r2));
            }
            for (int k = 0; k < size; ++k) {
                const int global = row(around.index[start + k]);
                if (global < 0) continue;
                const int c = global - first;
                if (c >= 0 && c < rows) {
                    if (!diagonal_written && c > r) {
                        here.add(r, diagonal(i));
                        diagonal_written = true;
                    }
                    here.add(c, -weight[k]);
                } else {
                    there.add(global, -weight[k]);
                }
            }
        }
        if (!diagonal_written) here.add(r, diagonal(i));
        right_hand_side(r) = source(i);
        solution(r) = pressure(i);
    }
};
} // namespace

void PressureSystem::count_entries(const LiquidParticles& liquid, const Neighbourhood& neighbours) {
    const auto n_rows = static_cast<std::size_t>(rows_);
    reserve(own_.offset, n_rows + 1);
    reserve(other_.offset, n_rows + 1);
    Kokkos::parallel_for("treacle::count_entries", liquid.store.owned(),
                         CountLoop{neighbours.liquid.offset, neighbours.liquid.index, liquid.row(), own_.offset,
                                   other_.offset, static_cast<int>(first_row_), rows_});
    own_entries_ = counts_to_offsets(own_.offset, rows_);
    other_entries_ = counts_to_offsets(other_.offset, rows_);
}

void PressureSystem::assemble(const SphOptions& options, const Constants& constants, const Comm& comm,
                              LiquidParticles& liquid, const Neighbourhood& neighbours, Halo& halo) {
    number_rows(comm, liquid, halo);
    count_entries(liquid, neighbours);
    for (const auto& [block, entries] : {std::pair(&own_, own_entries_), std::pair(&other_, other_entries_)}) {
        reserve(block->column, static_cast<std::size_t>(entries));
        reserve(block->value, static_cast<std::size_t>(entries));
    }
    reserve(right_hand_side_, static_cast<std::size_t>(rows_));
    reserve(solution_, static_cast<std::size_t>(rows_));
    with_kernel(options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        Kokkos::parallel_for(
            "treacle::fill_matrix", liquid.store.owned(),
            FillLoop<Kernel>{laplacian_weight(kernel, constants, liquid),
                             pairs(neighbours.liquid, liquid.store, liquid.store), own_, other_, liquid.row(),
                             liquid.diagonal(), liquid.source(), liquid.pressure(), right_hand_side_, solution_,
                             static_cast<int>(first_row_), rows_});
    });
}

PressureSystem::HostSystem PressureSystem::to_host() const {
    const auto mirror = [](const auto& view) { return Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), view); };
    return {{mirror(own_.offset), mirror(own_.column), mirror(own_.value)},
            {mirror(other_.offset), mirror(other_.column), mirror(other_.value)},
            mirror(right_hand_side_),
            mirror(solution_)};
}

void PressureSystem::take_solution(const HostSystem& host) const { Kokkos::deep_copy(solution_, host.solution); }

void PressureSystem::store_pressure(LiquidParticles& liquid) const {
    const auto row = liquid.row(), role = liquid.role();
    const auto p = liquid.pressure(), source = liquid.source(), wall = liquid.wall_term(), x = solution_;
    const int first = static_cast<int>(first_row_);
    Kokkos::parallel_for("treacle::store_pressure", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
        if (role(i) == Role::poisson) {
            p(i) = math::max(0.0, x(row(i) - first));
        } else {
            p(i) = role(i) == Role::separated ? source(i) / wall(i) : 0.0;
        }
    });
}

std::size_t PressureSystem::bytes() const {
    std::size_t total = 8 * (right_hand_side_.span() + solution_.span());
    for (const auto* block : {&own_, &other_}) {
        total += 4 * (block->offset.span() + block->column.span()) + 8 * block->value.span();
    }
    return total;
}

} // namespace treacle::sph
