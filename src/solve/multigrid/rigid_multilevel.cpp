#include "solve/multigrid/rigid_multilevel.hpp"

#include "base/text/contract.hpp"
#include "kokkos/cells.hpp"
#include "solve/multigrid/dense.hpp"
#include "solve/multigrid/rigid_coarsen.hpp"

#include <algorithm>
#include <deque>
#include <stdexcept>

namespace treacle::solve {

namespace {
constexpr int max_coarsening_levels = 20;
constexpr double least_shrinkage = 0.7;      // as in multilevel.cpp
constexpr MortonKey no_cell = ~MortonKey{0}; // of rows that no coarse matrix has

struct Stage {
    Level level;
    RigidBodyProlongation links;
    RankAgglomeration agglomeration;
    std::vector<double> made_r, made_z; // [made rows], where the next level has moved
    // With a border: its columns [count][rows] but of the matrix itself; the parts of r, z and of a second cycle that are
    // its unknowns; r less what they pull.
    std::vector<Index> bordered; // rows that the columns reach
    std::vector<double> columns, border_r, border_z, second_r, second_z, shifted;
};
using Vector = std::span<const double>;
using Out = std::span<double>;

} // namespace

struct RigidMultilevel::State {
    const RigidMultilevelOptions* options = nullptr;
    std::deque<Stage> stages; // of the deepest hierarchy so far
    std::size_t used = 0;     // levels of the present one
    bool direct = false;      // the last level is solved for directly
    CellSet dropped;
    std::vector<double> positions; // of the rows of the matrix [widths]
    CoarseRows made;
    DisconnectedSplit separation;
    RigidCoarsener coarsener;
    DenseFactor dense;

    void find_rows(const Matrix& matrix, const VelocityRows& rows);
    void coarsen_cells(const Comm& comm, Level& level, int modes);
    bool add_level(const Comm& comm, int dimensions, int& stride);
    void cycle(std::size_t depth, Vector r, Vector border_r, Out z, Out border_z, std::vector<double>* left = nullptr);
    void twice(std::size_t depth, Vector r, Vector border_r, Out z, Out border_z);
    void correct(std::size_t depth, Vector t, Vector border_t, Out z, Out border_z);
    void solve_last(Vector r, Vector border_r, Out z, Out border_z);

    BorderedBodies border;
    const Comm* comm = nullptr;
    std::size_t count() const { return static_cast<std::size_t>(border.count); }
    void coarsen_border(std::size_t depth);
    void factor_last();
    std::vector<double> block(std::size_t depth) const;
    double overcorrection(std::size_t depth) const {
        return depth == 0 ? options->overcorrection : options->coarse_overcorrection;
    }
    Vector shift(std::size_t depth, Vector r, Vector q);
    void pull(std::size_t depth, Vector z, Vector border_r, Out left);
    std::vector<double> dense_r, dense_z;
};

void RigidMultilevel::State::find_rows(const Matrix& matrix, const VelocityRows& rows) {
    if (stages.empty()) stages.emplace_back();
    auto& level = stages[0].level;
    auto& links = stages[0].links;
    const auto n = static_cast<std::size_t>(matrix.rows());
    TREACLE_EXPECT(rows.cells.size() == 3 * n && rows.positions.size() == 3 * n && rows.axes.size() == n);
    level.keys.resize(n);
    const int side = matrix.global_rows() < options->small_rows ? options->small_aggregate_width : options->box;
    for (std::size_t i = 0; i < n; ++i) {
        int box[3];
        for (std::size_t k = 0; k < 3; ++k) box[k] = floor_divide(rows.cells[3 * i + k], side);
        level.keys[i] = !rows.aside.empty() && rows.aside[i] != 0 ? no_cell : cell_key(box);
    }
    level.fixed.clear();
    if (border.count > 0) level.fixed.assign(n, 0);
    for (std::size_t k = 0; k < count() && comm->is_root(); ++k) level.fixed[n - 1 - k] = 1;
    level.refer_to(matrix);
    dropped.assign(1, no_cell);
    links.finest = true;
    links.axes.assign(rows.axes.begin(), rows.axes.end());
    positions.resize(3 * n);
    for (std::size_t i = 0; i < 3 * n; ++i) positions[i] = rows.positions[i] / rows.width;
    used = 1;
    direct = false;
}

// Boxes of twice the width, or of four times and more where liquid is so scattered that few would join.
void RigidMultilevel::State::coarsen_cells(const Comm& comm, Level& level, int modes) {
    if (used == 1) {
        aggregate(level, 0, RowOrder::along_curve, dropped);
        separation.split(level, 1);
        dropped.clear();
        return;
    }
    for (int coarsening_levels = 1; coarsening_levels <= max_coarsening_levels; ++coarsening_levels) {
        aggregate(level, coarsening_levels, RowOrder::along_curve, dropped);
        separation.split(level, modes);
        const auto made_rows = modes * comm.sum(std::int64_t{level.aggregates()});
        if (double(made_rows) <= least_shrinkage * double(level.global_rows)) return;
    }
}

// False when there is nothing to coarsen.
bool RigidMultilevel::State::add_level(const Comm& comm, int dimensions, int& stride) {
    if (stages.size() == used) stages.emplace_back();
    auto& stage = stages[used - 1];
    auto& level = stage.level;
    auto& links = stage.links;
    auto& agglomeration = stage.agglomeration;
    auto &made_r = stage.made_r, &made_z = stage.made_z;
    const int modes = rigid_modes(dimensions);
    coarsen_cells(comm, level, modes);
    links.dimensions = dimensions;
    const auto global_rows = modes * comm.sum(std::int64_t{level.aggregates()});
    if (global_rows == 0) return false;
    coarsener.make(comm, level, used == 1 ? std::span<const double>(positions) : level.centres,
        overcorrection(used - 1), links, made);
    const auto made_rows = static_cast<std::size_t>(made.rows());
    const int old_stride = stride;
    stride = RankAgglomeration::wider(
        comm, stride, global_rows, global_rows <= options->max_coarse_size ? global_rows : options->min_rows_per_rank);
    agglomeration.move(comm, stride > old_stride ? stride : 1, coarsener.first_made(), made, dropped);
    auto& next = stages[used++].level;
    next.take(
        comm, made, static_cast<Index>(comm.exclusive_sum(std::int64_t{made.rows()})), static_cast<Index>(global_rows));
    agglomeration.connect(comm, next);
    made_r.resize(agglomeration.moved() ? made_rows : 0);
    made_z.resize(made_r.size());
    return true;
}

// C of the next level is P^T C, divided as its matrix is.
void RigidMultilevel::State::coarsen_border(std::size_t depth) {
    auto& stage = stages[depth];
    auto& next = stages[depth + 1];
    const auto rows = static_cast<std::size_t>(stage.level.rows),
               coarse_rows = static_cast<std::size_t>(next.level.rows);
    const bool moved = stage.agglomeration.moved();
    next.columns.resize(count() * coarse_rows);
    next.bordered.clear();
    std::vector<double> unit(count()), fine(rows), made(moved ? stage.made_r.size() : coarse_rows),
        arrived(coarse_rows);
    for (std::size_t k = 0; k < count(); ++k) {
        Vector column = Vector(stage.columns).subspan(depth == 0 ? 0 : k * rows, depth == 0 ? 0 : rows);
        if (depth == 0) {
            std::fill(fine.begin(), fine.end(), 0.0);
            unit[k] = 1;
            border.add(unit, fine);
            unit[k] = 0;
            column = fine;
        }
        std::fill(made.begin(), made.end(), 0.0);
        stage.links.restrict_to(stage.level, column, made);
        if (moved) stage.agglomeration.down(made, arrived);
        const auto& from = moved ? arrived : made;
        for (std::size_t i = 0; i < coarse_rows; ++i)
            next.columns[k * coarse_rows + i] = from[i] / overcorrection(depth);
    }
    for (std::size_t i = 0; i < coarse_rows; ++i) {
        bool coupled = false;
        for (std::size_t k = 0; k < count() && !coupled; ++k) coupled = next.columns[k * coarse_rows + i] != 0;
        if (coupled) next.bordered.push_back(static_cast<Index>(i));
    }
}

std::vector<double> RigidMultilevel::State::block(std::size_t depth) const {
    auto out = border.block;
    for (std::size_t above = 0; above < depth; ++above) {
        for (double& entry : out) entry /= overcorrection(above);
    }
    return out;
}

// On rank 0: the last level with the border, or the border alone where sweeps are all that the last level gets.
void RigidMultilevel::State::factor_last() {
    const Stage& last = stages[used - 1];
    if (!comm->is_root()) {
        if (direct) dense.factor(last.level);
        return;
    }
    if (direct)
        dense.factor(last.level, last.columns, block(used - 1), count());
    else
        dense.factor(Level(), {}, block(used - 1), count());
}

// r - C q
Vector RigidMultilevel::State::shift(std::size_t depth, Vector r, Vector q) {
    if (border.count == 0) return r;
    const auto& columns = stages[depth].columns;
    auto& shifted = stages[depth].shifted;
    if (depth == 0) {
        shifted.assign(r.size(), 0.0);
        border.add(q, shifted);
        for (std::size_t i = 0; i < r.size(); ++i) shifted[i] = r[i] - shifted[i];
        return shifted;
    }
    shifted.assign(r.begin(), r.end());
    for (const Index row : stages[depth].bordered) {
        const auto i = static_cast<std::size_t>(row);
        for (std::size_t k = 0; k < q.size(); ++k) shifted[i] -= columns[k * r.size() + i] * q[k];
    }
    return shifted;
}

// left = border_r - C^T z, on all ranks.
void RigidMultilevel::State::pull(std::size_t depth, Vector z, Vector border_r, Out left) {
    if (border.count == 0) return;
    std::vector<double> sums(count(), 0.0);
    if (depth == 0) {
        sums = border.project(z);
    } else {
        for (const Index row : stages[depth].bordered) {
            const auto i = static_cast<std::size_t>(row);
            for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += stages[depth].columns[k * z.size() + i] * z[i];
        }
    }
    comm->sum(std::span(sums));
    for (std::size_t k = 0; k < sums.size(); ++k) left[k] = border_r[k] - sums[k];
}

// z += P M_c P^T t
void RigidMultilevel::State::correct(std::size_t depth, Vector t, Vector border_t, Out z, Out border_z) {
    auto& stage = stages[depth];
    auto& next = stages[depth + 1].level;
    auto& agglomeration = stage.agglomeration;
    auto& coarse_r = agglomeration.moved() ? stage.made_r : next.r;
    const auto& coarse_z = agglomeration.moved() ? stage.made_z : next.z;
    std::fill(coarse_r.begin(), coarse_r.end(), 0.0);
    stage.links.restrict_to(stage.level, t, coarse_r);
    if (agglomeration.moved()) agglomeration.down(stage.made_r, next.r);
    const bool exact = depth + 2 == used && direct;
    if (options->cycle == Cycle::w && !exact) {
        twice(depth + 1, next.r, border_t, next.z, border_z);
    } else {
        cycle(depth + 1, next.r, border_t, next.z, border_z);
    }
    if (agglomeration.moved()) agglomeration.up(next.z, stage.made_z);
    stage.links.prolong(stage.level, coarse_z, z);
}

// z = (2 M - M A M) r
void RigidMultilevel::State::twice(std::size_t depth, Vector r, Vector border_r, Out z, Out border_z) {
    auto& stage = stages[depth];
    auto& [left, more] = stage.level.second;
    left.resize(r.size());
    more.resize(r.size());
    stage.second_r.resize(count());
    stage.second_z.resize(count());
    cycle(depth, r, border_r, z, border_z, &left);
    pull(depth, z, border_r, stage.second_r);
    const auto g = block(depth);
    for (std::size_t k = 0; k < count(); ++k) {
        for (std::size_t l = 0; l < count(); ++l) stage.second_r[k] -= g[k * count() + l] * border_z[l];
    }
    cycle(depth, left, stage.second_r, more, stage.second_z);
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += more[i];
    for (std::size_t k = 0; k < count(); ++k) border_z[k] += stage.second_z[k];
}

void RigidMultilevel::State::solve_last(Vector r, Vector border_r, Out z, Out border_z) {
    if (border.count == 0) {
        dense.solve(r, z);
        return;
    }
    dense_r.assign(r.begin(), r.end());
    if (comm->is_root()) dense_r.insert(dense_r.end(), border_r.begin(), border_r.end());
    dense_z.resize(dense_r.size());
    dense.solve(dense_r, dense_z);
    std::copy_n(dense_z.begin(), z.size(), z.begin());
    if (comm->is_root()) std::copy_n(dense_z.end() - static_cast<std::ptrdiff_t>(count()), count(), border_z.begin());
    comm->broadcast(border_z);
}

// Sweeps pass over the border's unknowns; the levels below and the direct solution set them. `left`, unless null,
// becomes r - C q - A z.
void RigidMultilevel::State::cycle(
    std::size_t depth, Vector r, Vector border_r, Out z, Out border_z, std::vector<double>* left) {
    auto& stage = stages[depth];
    auto& level = stage.level;
    const bool last = depth + 1 == used;
    if (last && direct) {
        solve_last(r, border_r, z, border_z);
        if (left) level.residual(shift(depth, r, border_z), z, *left);
        return;
    }
    const bool back_too = depth == 0 && options->fine_sweeps == FineSweeps::there_and_back;
    level.sweep_forward_from_zero(r, z, level.t);
    if (back_too) level.sweep_backward(r, z, level.t);
    stage.border_r.resize(count());
    pull(depth, z, border_r, stage.border_r);
    if (!last) {
        correct(depth, level.t, stage.border_r, z, border_z);
    } else if (border.count > 0) {
        solve_last({}, stage.border_r, {}, border_z);
    }
    const auto right = shift(depth, r, border_z);
    if (back_too) level.sweep_forward(right, z);
    if (left)
        level.sweep_backward(right, z, *left);
    else
        level.sweep_backward(right, z);
}

namespace {
RigidMultilevelOptions checked(const RigidMultilevelOptions& options) {
    for (const double factor : {options.overcorrection, options.coarse_overcorrection}) {
        if (factor < 1 || factor >= 2) throw std::logic_error("rigid multilevel: overcorrection");
    }
    if (options.box < 1 || options.small_aggregate_width < 1) throw std::logic_error("rigid multilevel: box");
    return options;
}
} // namespace

RigidMultilevel::RigidMultilevel(const Comm& comm, RigidMultilevelOptions options)
    : comm_(comm), options_(checked(options)), state_(std::make_unique<State>()) {}
RigidMultilevel::~RigidMultilevel() = default;
RigidMultilevel::RigidMultilevel(RigidMultilevel&&) noexcept = default;
RigidMultilevel& RigidMultilevel::operator=(RigidMultilevel&&) noexcept = default;

void RigidMultilevel::set_up(const Matrix& matrix, const VelocityRows& rows, BorderedBodies border) {
    auto& state = *state_;
    state.options = &options_;
    state.comm = &comm_;
    state.border = std::move(border);
    state.find_rows(matrix, rows);
    int stride = 1;
    while (!state.direct && state.add_level(comm_, rows.dimensions, stride)) {
        auto& last = state.stages[state.used - 1].level;
        state.direct = last.global_rows <= options_.max_coarse_size;
        if (state.border.count > 0) state.coarsen_border(state.used - 2);
    }
    state.factor_last();
    for (std::size_t k = 0; k < state.used && comm_.size() > 1; ++k) state.stages[k].level.set_l1_diagonal();
}

void RigidMultilevel::apply(std::span<const double> r, std::span<double> z) {
    auto& state = *state_;
    const std::size_t m = state.count(), behind = m > 0 && comm_.is_root() ? r.size() - m : r.size();
    std::vector<double> border_r(m), border_z(m);
    if (behind < r.size()) std::copy(r.begin() + static_cast<std::ptrdiff_t>(behind), r.end(), border_r.begin());
    if (m > 0) comm_.broadcast(std::span(border_r));
    state.cycle(0, r, border_r, z, border_z);
    if (behind < r.size()) std::copy(border_z.begin(), border_z.end(), z.begin() + static_cast<std::ptrdiff_t>(behind));
}

std::vector<LevelSize> RigidMultilevel::sizes() const {
    std::vector<LevelSize> sizes;
    for (std::size_t k = 0; k < state_->used; ++k) {
        const auto& level = state_->stages[k].level;
        sizes.push_back({comm_.sum(std::int64_t{level.rows}), comm_.sum(level.entries()),
            static_cast<int>(comm_.sum(std::int64_t{level.rows > 0}))});
    }
    return sizes;
}

std::size_t RigidMultilevel::bytes() const {
    std::size_t total = state_->dense.bytes() + 8 * state_->positions.capacity();
    for (const auto& stage : state_->stages) {
        total += stage.level.bytes() + stage.links.bytes() + stage.agglomeration.bytes() +
                 8 * (stage.made_r.capacity() + stage.made_z.capacity() + stage.columns.capacity() +
                         stage.shifted.capacity()) +
                 sizeof(Index) * stage.bordered.capacity();
    }
    return total;
}

} // namespace treacle::solve
