#include "solve/multigrid/level.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::solve {

namespace {
constexpr int key_bits = 21;
constexpr int key_offset = 1 << 20;

// Puts two zeros after each bit.
MortonKey spread_bits(MortonKey x) {
    x &= (MortonKey{1} << key_bits) - 1;
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    x = (x | x << 2) & 0x1249249249249249;
    return x;
}
constexpr MortonKey lane = 0x1249249249249249; // the bits of x

// No column comes twice in a row.
void scatter(const Index* columns, const double* values, Index begin, Index end, double factor, double* t) {
    for (Index k = begin; k < end; ++k) t[columns[k]] -= values[k] * factor;
}

constexpr int ahead = 3;   // rows
constexpr Index line = 64; // bytes

inline void fetch(const Index* columns, const double* values, Index begin, Index end) {
    for (Index k = begin; k < end; k += line / 8) __builtin_prefetch(values + k);
    for (Index k = begin; k < end; k += line / 4) __builtin_prefetch(columns + k);
}
} // namespace

MortonKey cell_key(const int cell[3]) {
    MortonKey key = 0;
    for (int axis = 0; axis < 3; ++axis) key |= spread_bits(static_cast<MortonKey>(cell[axis] + key_offset)) << axis;
    return key;
}

int colour(MortonKey key) { return static_cast<int>((key ^ key >> 1 ^ key >> 2) & 1); }

MortonKey beside(MortonKey key, int face) {
    const MortonKey mask = lane << (face / 2);
    const MortonKey one = MortonKey{1} << (face / 2);
    const MortonKey part = face % 2 == 0 ? ((key & mask) - one) & mask : ((key | ~mask) + one) & mask;
    return part | (key & ~mask);
}

void Level::refer_to(const Matrix& matrix) {
    const auto& blocks = matrix.blocks();
    rows = matrix.rows();
    first_row = matrix.first_row();
    global_rows = matrix.global_rows();
    own_ = {blocks.diagonal_offsets, blocks.diagonal_columns, blocks.diagonal_values};
    other_ = {blocks.off_offsets, blocks.off_columns, blocks.off_values};
    index_rows();
    blocks_.take(1, rows, own_.offsets, own_.columns, own_.values);
    borrowed_halo_ = blocks.halo;
    t.resize(static_cast<std::size_t>(rows));
}

void Level::index_rows() {
    l1_diagonal_.clear();
    diagonal_.resize(static_cast<std::size_t>(rows));
    for (Index i = 0; i < rows; ++i) {
        const Index* const begin = own_.columns + own_.offsets[i];
        const Index* const end = own_.columns + own_.offsets[i + 1];
        diagonal_[static_cast<std::size_t>(i)] = static_cast<Index>(std::lower_bound(begin, end, i) - own_.columns);
    }
    inverse_.resize(static_cast<std::size_t>(rows));
    for (std::size_t i = 0; i < inverse_.size(); ++i) inverse_[i] = inverse(diagonal(static_cast<Index>(i)), i);
    interface_.clear();
    change_.clear();
    for (Index i = 0; i < rows; ++i) {
        if (other_.offsets[i] < other_.offsets[i + 1]) interface_.push_back(i);
    }
}

void Level::set_l1_diagonal(double relaxation) {
    l1_diagonal_.resize(static_cast<std::size_t>(rows));
    for (Index i = 0; i < rows; ++i) l1_diagonal_[static_cast<std::size_t>(i)] = diagonal(i);
    const auto around = halo().gather(l1_diagonal_);
    const double beside = 1.5 * (1 - 1 / relaxation);
    for (Index i = 0; i < rows; ++i) {
        double& own = l1_diagonal_[static_cast<std::size_t>(i)];
        const double given = own;
        double sum = 0;
        for (Index k = other_.offsets[i]; k < other_.offsets[i + 1]; ++k) {
            const double there = around[static_cast<std::size_t>(other_.columns[k])];
            if (there > 0) sum += std::fabs(other_.values[k]) * std::sqrt(given / there);
        }
        own = std::max(given / relaxation + beside * sum, 0.5 * (given + sum));
    }
    for (std::size_t i = 0; i < l1_diagonal_.size(); ++i) inverse_[i] = inverse(l1_diagonal_[i], i);
}

void Level::take(const Comm& comm, CoarseRows& made, Index first, Index global) {
    rows = made.rows();
    first_row = first;
    global_rows = global;
    keys.swap(made.keys);
    walls.swap(made.walls);
    centres.swap(made.centres);
    const auto& given = made.matrix;
    const auto inside = [&](Index column) { return column >= first && column < first + rows; };
    auto& others = halo_columns_;
    others.clear();
    for (const Index column : given.columns) {
        if (!inside(column)) others.push_back(column);
    }
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    own_store_.clear();
    other_store_.clear();
    for (std::size_t i = 0; i < static_cast<std::size_t>(rows); ++i) {
        for (Index k = given.offsets[i]; k < given.offsets[i + 1]; ++k) {
            const auto at = static_cast<std::size_t>(k);
            const Index column = given.columns[at];
            auto& store = inside(column) ? own_store_ : other_store_;
            const auto found = std::lower_bound(others.begin(), others.end(), column);
            const auto halo_column = static_cast<Index>(found - others.begin());
            store.columns.push_back(inside(column) ? column - first : halo_column);
            store.values.push_back(given.values[at]);
        }
        own_store_.end_row();
        other_store_.end_row();
    }
    own_ = {own_store_.offsets.data(), own_store_.columns.data(), own_store_.values.data()};
    other_ = {other_store_.offsets.data(), other_store_.columns.data(), other_store_.values.data()};
    index_rows();
    blocks_.take(made.block, rows, own_.offsets, own_.columns, own_.values);
    halo_.connect(comm, first, others);
    for (auto* vector : {&r, &z, &t}) vector->resize(static_cast<std::size_t>(rows));
}

void Level::sweep_forward_from_zero(std::span<const double> r_, std::span<double> z_, std::span<double> t_) {
    if (blocks_.taken()) {
        blocks_.down_from_zero(inverse_, r_, z_, t_);
        if (!l1_diagonal_.empty()) {
            for (std::size_t i = 0; i < z_.size(); ++i)
                t_[i] += (l1_diagonal_[i] - diagonal(static_cast<Index>(i))) * z_[i];
        }
        subtract_others(halo().gather(z_), t_);
        return;
    }
    std::fill(t_.begin(), t_.end(), 0.0);
    const Index* const columns = own_.columns;
    const double* const values = own_.values;
    for (Index i = 0; i < rows; ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (is_fixed(at)) {
            z_[at] = 0;
            continue;
        }
        const Index begin = own_.offsets[i], diagonal = diagonal_[at];
        // Hardware that fetches ahead along the arrays would go on into the half that is not read.
        if (i + ahead < rows) fetch(columns, values, own_.offsets[i + ahead], diagonal_[at + ahead]);
        const double sum = r_[at] - sparse_dot(columns, values, begin, diagonal, z_.data());
        z_[at] = sum * inverse_[at];
        // The residual is -U z + (D' - D) z, U the transpose of the part of the row that was just read.
        scatter(columns, values, begin, diagonal, z_[at], t_.data());
        if (!l1_diagonal_.empty()) t_[at] += (l1_diagonal_[at] - values[diagonal]) * z_[at];
    }
    subtract_others(halo().gather(z_), t_);
}

// t -= A_off z, z of other ranks.
void Level::subtract_others(std::span<const double> around, std::span<double> t_) const {
    for (const Index i : interface_) {
        t_[static_cast<std::size_t>(i)] -=
            sparse_dot(other_.columns, other_.values, other_.offsets[i], other_.offsets[i + 1], around.data());
    }
}

// r - A_off z; r itself where no row is beside others.
std::span<const double> Level::less_others(std::span<const double> r_, std::span<const double> around) {
    if (interface_.empty()) return r_;
    right_.assign(r_.begin(), r_.end());
    subtract_others(around, right_);
    return right_;
}

LevelProduct Level::product(std::span<const double> z_, std::span<const double> around) const {
    return {{own_.offsets, own_.columns, own_.values, z_.data()},
        {other_.offsets, other_.columns, other_.values, around.data()}};
}

void Level::sweep_forward(std::span<const double> r_, std::span<double> z_) {
    const auto product_of = product(z_);
    for (Index i = 0; i < rows; ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (!is_fixed(at)) z_[at] += (r_[at] - product_of(i)) * inverse_[at];
    }
}

void Level::sweep_backward(std::span<const double> r_, std::span<double> z_) {
    const auto around = halo().gather(z_);
    if (blocks_.taken()) return blocks_.up(inverse_, less_others(r_, around), z_);
    const auto product_of = product(z_, around);
    for (std::size_t i = static_cast<std::size_t>(rows); i-- > 0;) {
        // Rows fall while the entries of each rise: no order that hardware fetches ahead.
        if (is_fixed(i)) continue;
        if (i >= ahead) fetch(own_.columns, own_.values, own_.offsets[i - ahead], own_.offsets[i - ahead + 1]);
        z_[i] += (r_[i] - product_of(static_cast<Index>(i))) * inverse_[i];
    }
}

void Level::sweep_up_by_rows(std::span<const double> r_, std::span<double> z_, std::span<double> t_) {
    std::fill(t_.begin(), t_.end(), 0.0);
    const auto product_of = product(z_, around_);
    for (std::size_t i = static_cast<std::size_t>(rows); i-- > 0;) {
        if (is_fixed(i)) continue;
        if (i >= ahead) fetch(own_.columns, own_.values, own_.offsets[i - ahead], own_.offsets[i - ahead + 1]);
        const double sum = r_[i] - product_of(static_cast<Index>(i)), change = sum * inverse_[i];
        const Index diagonal = diagonal_[i];
        z_[i] += change;
        t_[i] += sum - own_.values[diagonal] * change;
        scatter(own_.columns, own_.values, diagonal + 1, own_.offsets[i + 1], change, t_.data());
    }
}

// Row i is multiplied with values above it as they are now and those below it, and of other ranks, as they were before:
// of the residual after the sweep all but the changes of the latter are at hand there, and these are a_ij of the row
// that changes.
void Level::sweep_backward(std::span<const double> r_, std::span<double> z_, std::span<double> t_) {
    const auto before = halo().gather(z_);
    around_.assign(before.begin(), before.end());
    if (blocks_.taken())
        blocks_.up(inverse_, less_others(r_, around_), z_, t_);
    else
        sweep_up_by_rows(r_, z_, t_);
    const auto after = halo().gather(z_);
    for (std::size_t k = 0; k < around_.size(); ++k) around_[k] = after[k] - around_[k];
    subtract_others(around_, t_);
}

void Level::sweep_interface_forward(std::span<double> z_, std::span<double> t_) {
    change_.resize(static_cast<std::size_t>(rows)); // other ranks need border rows alone: the rest stays zero
    for (const Index i : interface_) {
        const auto at = static_cast<std::size_t>(i);
        if (is_fixed(at)) continue;
        change_[at] = t_[at] * inverse_[at];
        z_[at] += change_[at];
        scatter(own_.columns, own_.values, own_.offsets[i], own_.offsets[i + 1], change_[at], t_.data());
    }
    subtract_others(halo().gather(change_), t_);
}

void Level::sweep_interface_backward(std::span<const double> r_, std::span<double> z_) {
    const auto product_of = product(z_);
    for (std::size_t k = interface_.size(); k-- > 0;) {
        const auto at = static_cast<std::size_t>(interface_[k]);
        if (!is_fixed(at)) z_[at] += (r_[at] - product_of(interface_[k])) * inverse_[at];
    }
}

void Level::residual(std::span<const double> r_, std::span<const double> z_, std::span<double> t_) {
    const auto product_of = product(z_);
    const double* const right = r_.data();
    double* const left = t_.data();
    Kokkos::parallel_for(
        "treacle::level_residual", rows, KOKKOS_LAMBDA(int i) { left[i] = right[i] - product_of(i); });
}

void Level::restrict_to(std::span<const double> t_, std::span<double> coarse) const {
    const Index* const first_run = group.data();
    const Run* const parts = runs.data();
    const double* const from = t_.data();
    double* const to = coarse.data();
    Kokkos::parallel_for(
        "treacle::restrict", aggregates(), KOKKOS_LAMBDA(int a) {
            double sum = 0;
            for (Index k = first_run[a]; k < first_run[a + 1]; ++k) {
                for (Index i = parts[k].begin; i < parts[k].end; ++i) sum += from[i];
            }
            to[a] = sum;
        });
}

void Level::prolong(std::span<const double> coarse, std::span<double> z_) const {
    const Index* const aggregate_of = aggregate.data();
    const double* const from = coarse.data();
    double* const to = z_.data();
    Kokkos::parallel_for(
        "treacle::prolong", rows, KOKKOS_LAMBDA(int i) {
            if (aggregate_of[i] >= 0) to[i] += from[aggregate_of[i]];
        });
}

std::size_t Level::bytes() const {
    std::size_t reals = keys.capacity(), indices = 0;
    for (const auto* of : {&centres, &walls, &r, &z, &t, &l1_diagonal_, &inverse_, &change_, &around_, &right_})
        reals += of->capacity();
    for (const auto* of : {&halo_columns_, &diagonal_, &interface_, &aggregate, &group}) indices += of->capacity();
    return own_store_.bytes() + other_store_.bytes() + blocks_.bytes() + halo_.bytes() + sizeof(Run) * runs.capacity() +
           fixed.capacity() + 8 * reals + 4 * indices;
}

} // namespace treacle::solve
