#include "solve/multigrid/rigid_coarsen.hpp"

#include <algorithm>

namespace treacle::solve {

namespace {
// Arms below this are round-off of zero [widths]. Motions in the null space of an aggregate's rows, as the spin of a
// single row about itself, get rows and columns of zeros, which the sweeps pass over.
constexpr double least_arm = 1e-9;

// Fraction of the diagonal that is added to it in coarse matrices: motions that cost nothing, as semidefinite matrices
// have, would have nothing but round-off there, of either sign, and its inverse in the cycle. Far below the mass of
// free pieces that are stiff.
constexpr double least_cost = 1e-10;

// Entries of a row of the matrix for the motions of its aggregate: those that are not zero.
template <int D>
struct ModeEntries {
    static constexpr int count = D == 3 ? 3 : 2;
    int mode[count];
    double value[count];

    ModeEntries(int axis, const double* arm) {
        mode[0] = axis;
        value[0] = 1;
        if constexpr (D == 3) { // (w x a)_k = w_l a_m - w_m a_l
            const int l = (axis + 1) % 3, m = (axis + 2) % 3;
            mode[1] = 3 + l;
            mode[2] = 3 + m;
            value[1] = arm[m];
            value[2] = -arm[l];
        } else {
            mode[1] = 2;
            value[1] = axis == 0 ? -arm[1] : arm[0];
        }
    }
};

// The velocity w x a of the centre of an aggregate below, entry [k][l] times w_l; its spin is w.
template <int D>
using Turn = std::array<std::array<double, D == 3 ? 3 : 1>, D>;
template <int D>
Turn<D> turn(const double* a) {
    if constexpr (D == 3) {
        return {{{0, a[2], -a[1]}, {-a[2], 0, a[0]}, {a[1], -a[0], 0}}};
    } else {
        return {{{-a[1]}, {a[0]}}};
    }
}

template <int D>
void restrict_rows(
    const Level& level, const RigidBodyProlongation& links, std::span<const double> t, std::span<double> coarse) {
    constexpr auto modes = static_cast<std::size_t>(rigid_modes(D));
    for (std::size_t i = 0; i < t.size(); ++i) {
        if (level.aggregate[i] < 0) continue;
        double* const motion = &coarse[modes * static_cast<std::size_t>(level.aggregate[i])];
        const ModeEntries<D> felt(links.axes[i], &links.arms[3 * i]);
        for (int k = 0; k < felt.count; ++k) motion[felt.mode[k]] += felt.value[k] * t[i];
    }
}

template <int D>
void prolong_rows(
    const Level& level, const RigidBodyProlongation& links, std::span<const double> coarse, std::span<double> z) {
    constexpr auto modes = static_cast<std::size_t>(rigid_modes(D));
    for (std::size_t i = 0; i < z.size(); ++i) {
        if (level.aggregate[i] < 0) continue;
        const double* const motion = &coarse[modes * static_cast<std::size_t>(level.aggregate[i])];
        const ModeEntries<D> felt(links.axes[i], &links.arms[3 * i]);
        double sum = 0;
        for (int k = 0; k < felt.count; ++k) sum += felt.value[k] * motion[felt.mode[k]];
        z[i] += sum;
    }
}

template <int D>
void restrict_blocks(
    const Level& level, const RigidBodyProlongation& links, std::span<const double> t, std::span<double> coarse) {
    constexpr auto modes = static_cast<std::size_t>(rigid_modes(D));
    for (std::size_t n = 0; modes * n < t.size(); ++n) {
        if (level.aggregate[modes * n] < 0) continue;
        double* const motion = &coarse[modes * static_cast<std::size_t>(level.aggregate[modes * n])];
        const double* const own = &t[modes * n];
        const auto s = turn<D>(&links.arms[3 * n]);
        for (std::size_t k = 0; k < modes; ++k) motion[k] += own[k];
        for (std::size_t k = 0; k < D; ++k) {
            for (std::size_t l = 0; l < s[k].size(); ++l) motion[D + l] += s[k][l] * own[k];
        }
    }
}

template <int D>
void prolong_blocks(
    const Level& level, const RigidBodyProlongation& links, std::span<const double> coarse, std::span<double> z) {
    constexpr auto modes = static_cast<std::size_t>(rigid_modes(D));
    for (std::size_t n = 0; modes * n < z.size(); ++n) {
        if (level.aggregate[modes * n] < 0) continue;
        const double* const motion = &coarse[modes * static_cast<std::size_t>(level.aggregate[modes * n])];
        double* const own = &z[modes * n];
        const auto s = turn<D>(&links.arms[3 * n]);
        for (std::size_t k = 0; k < modes; ++k) own[k] += motion[k];
        for (std::size_t k = 0; k < D; ++k) {
            for (std::size_t l = 0; l < s[k].size(); ++l) own[k] += s[k][l] * motion[D + l];
        }
    }
}
} // namespace

void RigidBodyProlongation::restrict_to(const Level& level, std::span<const double> t, std::span<double> coarse) const {
    const auto work = finest ? (dimensions == 3 ? restrict_rows<3> : restrict_rows<2>)
                             : (dimensions == 3 ? restrict_blocks<3> : restrict_blocks<2>);
    work(level, *this, t, coarse);
}

void RigidBodyProlongation::prolong(const Level& level, std::span<const double> coarse, std::span<double> z) const {
    const auto work = finest ? (dimensions == 3 ? prolong_rows<3> : prolong_rows<2>)
                             : (dimensions == 3 ? prolong_blocks<3> : prolong_blocks<2>);
    work(level, *this, coarse, z);
}

// Centres are the means of what the aggregates contain.
void RigidCoarsener::find_arms(
    const Level& level, std::span<const double> positions, RigidBodyProlongation& links, CoarseRows& made) {
    const std::size_t step = links.finest ? 1 : static_cast<std::size_t>(modes_);
    const auto aggregates = static_cast<std::size_t>(level.aggregates());
    made.centres.assign(3 * aggregates, 0.0);
    scratch_.assign(aggregates, 0.0);
    const auto each = [&](auto&& work) {
        for (std::size_t i = 0; 3 * i < positions.size(); ++i) {
            const Index aggregate = level.aggregate[step * i];
            if (aggregate >= 0) work(i, static_cast<std::size_t>(aggregate));
        }
    };
    each([&](std::size_t i, std::size_t a) {
        scratch_[a] += 1;
        for (std::size_t k = 0; k < 3; ++k) made.centres[3 * a + k] += positions[3 * i + k];
    });
    for (std::size_t a = 0; a < aggregates; ++a) {
        for (std::size_t k = 0; k < 3; ++k) made.centres[3 * a + k] /= scratch_[a];
    }
    links.arms.assign(positions.size(), 0.0);
    each([&](std::size_t i, std::size_t a) {
        for (std::size_t k = 0; k < 3; ++k) {
            const double arm = positions[3 * i + k] - made.centres[3 * a + k];
            links.arms[3 * i + k] = arm < -least_arm || arm > least_arm ? arm : 0.0;
        }
    });
}

void RigidCoarsener::gather_arms(const Comm& comm, Level& level, const RigidBodyProlongation& links) {
    halo_arms_.clear();
    halo_axes_.clear();
    if (comm.size() == 1) return;
    const auto rows = static_cast<std::size_t>(level.rows);
    const auto modes = static_cast<std::size_t>(modes_);
    scratch_.resize(rows);
    if (!links.finest) { // the first rows of an aggregate take the numbers along
        for (std::size_t i = 0; i < rows; ++i) {
            const std::size_t k = i % modes;
            scratch_[i] = k < 3 ? links.arms[3 * (i / modes) + k] : 0;
        }
        const auto around = level.halo().gather(scratch_);
        for (std::size_t i = 0; i < around.size(); i += modes) {
            for (std::size_t k = 0; k < 3; ++k) halo_arms_.push_back(around[i + k]);
        }
        return;
    }
    for (std::size_t k = 0; k < 4; ++k) {
        for (std::size_t i = 0; i < rows; ++i) scratch_[i] = k < 3 ? links.arms[3 * i + k] : double(links.axes[i]);
        const auto around = level.halo().gather(scratch_);
        halo_arms_.resize(3 * around.size());
        halo_axes_.resize(around.size());
        for (std::size_t i = 0; i < around.size(); ++i) {
            if (k < 3)
                halo_arms_[3 * i + k] = around[i];
            else
                halo_axes_[i] = static_cast<signed char>(around[i]);
        }
    }
}

double* RigidCoarsener::block(Index index) {
    auto& slot = slot_[static_cast<std::size_t>(index)];
    const auto size = static_cast<std::size_t>(modes_ * modes_);
    if (slot < 0) {
        slot = static_cast<Index>(met_indices_.size());
        met_indices_.push_back(index);
        if (blocks_.size() < size * met_indices_.size()) blocks_.resize(2 * size * met_indices_.size());
        std::fill_n(blocks_.begin() + static_cast<std::ptrdiff_t>(size) * slot, size, 0.0);
    }
    return &blocks_[size * static_cast<std::size_t>(slot)];
}

// P_i^T a_ij P_j of the entries of a row of the matrix.
template <int D>
void RigidCoarsener::add_row(const Level& level, const RigidBodyProlongation& links, Index row) {
    constexpr int modes = rigid_modes(D);
    const auto at = static_cast<std::size_t>(row);
    const ModeEntries<D> left(links.axes[at], &links.arms[3 * at]);
    const auto add = [&](Index index, const ModeEntries<D>& right, double value) {
        double* const sum = block(index);
        for (int k = 0; k < left.count; ++k) {
            const double part = left.value[k] * value;
            for (int l = 0; l < right.count; ++l) sum[modes * left.mode[k] + right.mode[l]] += part * right.value[l];
        }
    };
    const auto& own = level.own();
    for (Index e = own.offsets[row]; e < own.offsets[row + 1]; ++e) {
        const auto j = static_cast<std::size_t>(own.columns[e]);
        const double value = static_cast<Index>(j) == row ? (1 + least_cost) * own.values[e] : own.values[e];
        if (level.aggregate[j] >= 0) add(level.aggregate[j], ModeEntries<D>(links.axes[j], &links.arms[3 * j]), value);
    }
    const auto& other = level.other();
    for (Index e = other.offsets[row]; e < other.offsets[row + 1]; ++e) {
        const auto j = static_cast<std::size_t>(other.columns[e]);
        const Index index = index_.of_halo()[j];
        if (index >= 0) add(index, ModeEntries<D>(halo_axes_[j], &halo_arms_[3 * j]), other.values[e]);
    }
}

// The same of the rows of an aggregate below, whose entries come in blocks.
template <int D>
void RigidCoarsener::add_blocks(const Level& level, const RigidBodyProlongation& links, Index node) {
    constexpr auto m = static_cast<std::size_t>(rigid_modes(D));
    const auto left = turn<D>(&links.arms[3 * static_cast<std::size_t>(node)]);
    const auto add = [&](const Level::Block& part, Index entry, Index index, const Turn<D>& right) {
        double b[m][m];
        for (std::size_t k = 0; k < m; ++k) {
            const double* const values = &part.values[part.offsets[node * Index(m) + Index(k)] + entry];
            for (std::size_t l = 0; l < m; ++l) b[k][l] = values[l];
        }
        for (std::size_t k = 0; k < m; ++k) {
            for (std::size_t l = 0; l < D; ++l) {
                for (std::size_t w = 0; w < right[l].size(); ++w) b[k][D + w] += b[k][l] * right[l][w];
            }
        }
        for (std::size_t k = 0; k < D; ++k) {
            for (std::size_t w = 0; w < left[k].size(); ++w) {
                for (std::size_t l = 0; l < m; ++l) b[D + w][l] += left[k][w] * b[k][l];
            }
        }
        double* const sum = block(index);
        for (std::size_t k = 0; k < m * m; ++k) sum[k] += b[k / m][k % m];
    };
    const auto each = [&](const Level::Block& part, auto&& index_of, auto&& arm_of) {
        const Index begin = part.offsets[node * Index(m)], end = part.offsets[node * Index(m) + 1];
        for (Index e = begin; e < end; e += Index(m)) {
            const auto column = static_cast<std::size_t>(part.columns[e]);
            const Index index = index_of(column);
            if (index >= 0) add(part, e - begin, index, turn<D>(arm_of(column / m)));
        }
    };
    each(
        level.own(), [&](std::size_t column) { return level.aggregate[column]; },
        [&](std::size_t other) { return &links.arms[3 * other]; });
    each(
        level.other(), [&](std::size_t column) { return index_.of_halo()[column]; },
        [&](std::size_t other) { return &halo_arms_[3 * other]; });
}

template <int D>
void RigidCoarsener::end_rows(double divisor, CoarseRows& made) {
    constexpr auto m = static_cast<std::size_t>(rigid_modes(D));
    met_.clear();
    for (std::size_t k = 0; k < met_indices_.size(); ++k) {
        met_.emplace_back(index_.global(met_indices_[k]), static_cast<Index>(k));
        slot_[static_cast<std::size_t>(met_indices_[k])] = -1;
    }
    met_indices_.clear();
    std::sort(met_.begin(), met_.end());
    for (std::size_t k = 0; k < m; ++k) {
        for (const auto& [number, slot] : met_) {
            const double* const values = &blocks_[m * m * static_cast<std::size_t>(slot) + m * k];
            for (std::size_t l = 0; l < m; ++l) {
                made.matrix.columns.push_back(static_cast<Index>(m) * number + static_cast<Index>(l));
                made.matrix.values.push_back(values[l] / divisor);
            }
        }
        made.matrix.end_row();
    }
}

template <int D>
void RigidCoarsener::make_rows(
    const Level& level, double divisor, const RigidBodyProlongation& links, CoarseRows& made) {
    constexpr int modes = rigid_modes(D);
    for (std::size_t a = 0; a < static_cast<std::size_t>(level.aggregates()); ++a) {
        for (auto k = static_cast<std::size_t>(level.group[a]); k < static_cast<std::size_t>(level.group[a + 1]); ++k) {
            const Run& run = level.runs[k];
            if (links.finest) {
                for (Index i = run.begin; i < run.end; ++i) add_row<D>(level, links, i);
            } else {
                for (Index n = run.begin / modes; n < run.end / modes; ++n) add_blocks<D>(level, links, n);
            }
        }
        const MortonKey key = level.runs[static_cast<std::size_t>(level.group[a])].key;
        made.keys.insert(made.keys.end(), static_cast<std::size_t>(modes), key);
        end_rows<D>(divisor, made);
    }
}

void RigidCoarsener::make(const Comm& comm, Level& level, std::span<const double> positions, double divisor,
    RigidBodyProlongation& links, CoarseRows& made) {
    modes_ = rigid_modes(links.dimensions);
    made.clear();
    made.block = modes_;
    index_.number(comm, level);
    slot_.assign(index_.size(), -1);
    met_indices_.clear();
    find_arms(level, positions, links, made);
    gather_arms(comm, level, links);
    if (links.dimensions == 3)
        make_rows<3>(level, divisor, links, made);
    else
        make_rows<2>(level, divisor, links, made);
}

} // namespace treacle::solve
