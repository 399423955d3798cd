#include "sph/pressure/pressure_system.hpp"

#include "kokkos/scan.hpp"
#include "solve/rows/host_blocks.hpp"
#include "sph/pressure/laplacian.hpp"
#include "sph/pressure/row_writer.hpp"

#include <algorithm>

namespace treacle::sph {

void PressureSystem::number_rows(const SphOptions& options, const Comm& comm, LiquidParticles& liquid, Halo& halo) {
    const auto role = liquid.role(), row = liquid.row();
    const auto diagonal = liquid.diagonal(), wall = liquid.wall_term();
    const bool bounded = options.pressure.dirichlet == DirichletRule::complementarity;
    const int n = liquid.store.owned();
    const auto count_rows = [&](int first) {
        int rows = 0;
        Kokkos::parallel_scan(
            "treacle::number_rows", n,
            KOKKOS_LAMBDA(int i, int& sum, bool last) {
                const bool unknown =
                    role(i) == Role::poisson || (bounded && role(i) == Role::dirichlet && diagonal(i) > wall(i));
                if (last) row(i) = unknown ? first + sum : -1;
                sum += static_cast<int>(unknown);
            },
            rows);
        return rows;
    };
    rows_ = count_rows(0);
    first_row_ = comm.exclusive_sum(static_cast<std::int64_t>(rows_));
    global_rows_ = comm.sum(static_cast<std::int64_t>(rows_));
    if (first_row_ > 0) count_rows(static_cast<int>(first_row_));
    halo.gather(liquid.store, {liquid.row_field()});
}

// On the host, where the halo is: four bytes for each ghost.
void PressureSystem::connect_halo(const Comm& comm, std::initializer_list<RowsOf> particles) {
    auto& columns = halo_columns_;
    columns.clear();
    for (const auto& of : particles) {
        const auto ghosts = std::pair(of.store.owned(), of.store.total());
        const auto row = on_host(Kokkos::subview(of.row, ghosts));
        for (std::size_t g = 0; g < row.extent(0); ++g) {
            const int r = row(g);
            if (r >= 0 && (r < first_row_ || r >= first_row_ + rows_)) columns.push_back(r);
        }
    }
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    column_map_.size = static_cast<int>(columns.size());
    assign(column_map_.column, columns);
    halo_.connect(comm, first_row_, columns);
}

void PressureSystem::map_ghosts(const LiquidParticles& liquid) {
    reserve(ghost_column_, static_cast<std::size_t>(liquid.store.ghosts()));
    const auto row = liquid.row(), ghost_column = ghost_column_;
    const auto column_map = column_map_;
    const int owned = liquid.store.owned();
    Kokkos::parallel_for(
        "treacle::map_ghosts", liquid.store.ghosts(),
        KOKKOS_LAMBDA(int g) { ghost_column(g) = column_map(row(owned + g)); });
}

namespace {
struct CountLoop {
    Array<std::int64_t> offset;
    Array<int> index, row, own, other;
    int first, rows;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        if (row(i) < 0) return;
        int here = 1, unknowns = 0; // the diagonal
        const int count = static_cast<int>(offset(i + 1) - offset(i));
        const int* around = index.data() + offset(i);
        for (int k = 0; k < count; k += lanes) {
            const SimdInt column = gather_ints(row.data(), load_ints(around + k));
            const unsigned unknown = first_bits(count - k) & ~bits_below(column, 0);
            here += count_bits(unknown & bits_below(column, first + rows) & ~bits_below(column, first));
            unknowns += count_bits(unknown);
        }
        own(row(i) - first) = here;
        other(row(i) - first) = unknowns + 1 - here;
    }
};

template <class Kernel, class Liquids>
struct FillLoop {
    LaplacianWeight<Kernel> laplacian;
    Liquids liquids;
    Pairs pairs;
    Array4 packed_position;
    PressureSystem::Block own, other;
    Array<int> row, ghost_column;
    Array<double> diagonal, source, pressure, right_hand_side, solution;
    int first, rows, owned;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        if (row(i) < 0) return;
        const int r = row(i) - first;
        RowWriter here{own.column.data() + own.offset(r), own.value.data() + own.offset(r)};
        RowWriter there{other.column.data() + other.offset(r), other.value.data() + other.offset(r)};
        const double volume = laplacian.volume(i);
        const Row around = pairs.row(i, packed_position);
        const auto partners = liquids.partners(i);
        bool diagonal_written = false, rising = true;
        for (int k = 0; k < around.count; k += lanes) {
            const auto d = around.near(k);
            const SimdDouble value =
                -partners.conduct(around.index + k, laplacian.weight(volume + d.number, d.r2, distance(d.r2).r));
            const SimdInt index = load_ints(around.index + k), global = gather_ints(row.data(), index);
            const SimdInt column = shift_ints(global, -first);
            const unsigned unknown = first_bits(around.count - k) & ~bits_below(global, 0);
            const unsigned inside = unknown & bits_below(column, rows) & ~bits_below(column, 0);
            // A periodic image of a particle of this rank has a row anywhere in the block.
            rising = rising && (inside & ~bits_below(index, owned)) == 0;
            if (rising) {
                const unsigned below = inside & bits_below(column, r);
                here.append(below, column, value);
                if (!diagonal_written && below != inside) {
                    here.add(r, diagonal(i));
                    diagonal_written = true;
                }
                if (below != inside) here.append(inside & ~below, column, value);
            } else {
                here.add_each(inside, column, value);
            }
            if (inside != unknown) {
                there.add_each(unknown & ~inside, index, value, [&](int j) { return ghost_column(j - owned); });
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
        CountLoop{neighbours.liquid.offset, neighbours.liquid.index, liquid.row(), own_.offset, other_.offset,
            static_cast<int>(first_row_), rows_});
    own_entries_ = counts_to_offsets(own_.offset, rows_);
    other_entries_ = counts_to_offsets(other_.offset, rows_);
}

void PressureSystem::assemble(const SphOptions& options, const Constants& constants, const Comm& comm,
    LiquidParticles& liquid, const Neighbourhood& neighbours, Halo& halo) {
    number_rows(options, comm, liquid, halo);
    connect_halo(comm, {{liquid.store, liquid.row()}});
    map_ghosts(liquid);
    count_entries(liquid, neighbours);
    pack_positions(liquid, liquid.volume());
    for (const auto& [block, entries] : {std::pair(&own_, own_entries_), std::pair(&other_, other_entries_)}) {
        reserve(block->column, static_cast<std::size_t>(entries));
        reserve(block->value, static_cast<std::size_t>(entries));
    }
    reserve(right_hand_side_, static_cast<std::size_t>(rows_));
    reserve(solution_, static_cast<std::size_t>(rows_));
    with_kernel(options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        with_liquids(constants.immiscible, liquid.liquid(), 0, [&](const auto& liquids) {
            using Liquids = std::decay_t<decltype(liquids)>;
            Kokkos::parallel_for("treacle::fill_matrix", liquid.store.owned(),
                FillLoop<Kernel, Liquids>{laplacian_weight(kernel, constants, liquid), liquids,
                    pairs(neighbours.liquid, liquid.store, liquid.store), liquid.packed_position, own_, other_,
                    liquid.row(), ghost_column_, liquid.diagonal(), liquid.source(), liquid.pressure(),
                    right_hand_side_, solution_, static_cast<int>(first_row_), rows_, liquid.store.owned()});
        });
    });
}

PressureSystem::HostSystem PressureSystem::to_host() const {
    return {{on_host(own_.offset), on_host(own_.column), on_host(own_.value)},
        {on_host(other_.offset), on_host(other_.column), on_host(other_.value)}, on_host(right_hand_side_),
        on_host(solution_)};
}

solve::CsrBlocks PressureSystem::blocks(const HostSystem& host) {
    return solve::csr_blocks(host.own, host.other, halo_, {first_row_, rows_, global_rows_});
}

void PressureSystem::take_solution(const HostSystem& host) const { Kokkos::deep_copy(solution_, host.solution); }

void PressureSystem::store_pressure(LiquidParticles& liquid) const {
    const auto row = liquid.row(), role = liquid.role();
    const auto p = liquid.pressure(), source = liquid.source(), wall = liquid.wall_term(), x = solution_;
    const int first = static_cast<int>(first_row_);
    Kokkos::parallel_for(
        "treacle::store_pressure", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            if (role(i) == Role::poisson) {
                p(i) = math::max(0.0, x(row(i) - first));
            } else {
                p(i) = role(i) == Role::separated ? source(i) / wall(i) : 0.0;
            }
        });
}

std::size_t PressureSystem::bytes() const {
    std::size_t total = 8 * (right_hand_side_.span() + solution_.span()) + halo_.bytes() +
                        4 * (ghost_column_.span() + column_map_.column.span() + halo_columns_.capacity());
    for (const auto* block : {&own_, &other_}) {
        total += 4 * (block->offset.span() + block->column.span()) + 8 * block->value.span();
    }
    return total;
}

} // namespace treacle::sph
