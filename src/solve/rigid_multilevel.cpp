#include "solve/rigid_multilevel.hpp"

#include "solve/dense.hpp"
#include "solve/rigid_coarsen.hpp"

#include <algorithm>
#include <cassert>
#include <deque>
#include <stdexcept>

namespace treacle::solve {

namespace {
constexpr int most_halvings = 20;
constexpr double least_shrinkage = 0.7; // as in multilevel.cpp
constexpr CellKey no_cell = ~CellKey{0}; // of rows that no coarse matrix has

struct Stage {
    Level level;
    RigidLinks links;
    Gathering gathering;
    std::vector<double> made_r, made_z; // [made rows], where the next level has moved
};

int floor_divide(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }
} // namespace

struct RigidMultilevel::State {
    const RigidMultilevelOptions* options = nullptr;
    std::deque<Stage> stages; // of the deepest hierarchy so far
    std::size_t used = 0;     // levels of the present one
    bool direct = false;      // the last level is solved for directly
    CellSet dropped;
    std::vector<double> places; // of the rows of the matrix [widths]
    MadeRows made;
    Separation separation;
    RigidCoarsener coarsener;
    DenseFactor dense;

    void find_rows(const Matrix& matrix, const VelocityRows& rows);
    void coarsen_cells(const Comm& comm, Level& level, int modes);
    bool add_level(const Comm& comm, int dimensions, int& stride);
    void cycle(std::size_t depth, std::span<const double> r, std::span<double> z);
    void twice(std::size_t depth, std::span<const double> r, std::span<double> z);
    void correct(std::size_t depth, std::span<const double> t, std::span<double> z);
};

void RigidMultilevel::State::find_rows(const Matrix& matrix, const VelocityRows& rows) {
    if (stages.empty()) stages.emplace_back();
    auto& [level, links, gathering, made_r, made_z] = stages[0];
    level.refer_to(matrix);
    const auto n = static_cast<std::size_t>(matrix.rows());
    assert(rows.cells.size() == 3 * n && rows.places.size() == 3 * n && rows.axes.size() == n);
    level.keys.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        int box[3];
        for (std::size_t k = 0; k < 3; ++k) box[k] = floor_divide(rows.cells[3 * i + k], options->box);
        level.keys[i] = !rows.aside.empty() && rows.aside[i] != 0 ? no_cell : cell_key(box);
    }
    dropped.assign(1, no_cell);
    links.axes.assign(rows.axes.begin(), rows.axes.end());
    places.resize(3 * n);
    for (std::size_t i = 0; i < 3 * n; ++i) places[i] = rows.places[i] / rows.width;
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
    for (int halvings = 1; halvings <= most_halvings; ++halvings) {
        aggregate(level, halvings, RowOrder::along_curve, dropped);
        separation.split(level, modes);
        const auto made_rows = modes * comm.sum(std::int64_t{level.aggregates()});
        if (double(made_rows) <= least_shrinkage * double(level.global_rows)) return;
    }
}

// False when there is nothing to coarsen.
bool RigidMultilevel::State::add_level(const Comm& comm, int dimensions, int& stride) {
    if (stages.size() == used) stages.emplace_back();
    auto& [level, links, gathering, made_r, made_z] = stages[used - 1];
    const int modes = rigid_modes(dimensions);
    coarsen_cells(comm, level, modes);
    links.dimensions = dimensions;
    const auto global_rows = modes * comm.sum(std::int64_t{level.aggregates()});
    if (global_rows == 0) return false;
    coarsener.make(comm, level, used == 1 ? std::span<const double>(places) : level.centres, options->overcorrection, links, made);
    const auto made_rows = static_cast<std::size_t>(made.rows());
    const int old_stride = stride;
    stride = Gathering::wider(comm, stride, global_rows,
                              global_rows <= options->dense_rows ? global_rows : options->rows_per_rank);
    gathering.move(comm, stride > old_stride ? stride : 1, coarsener.first_made(), made, dropped);
    auto& next = stages[used++].level;
    next.take(comm, made, static_cast<Index>(comm.exclusive_sum(std::int64_t{made.rows()})),
              static_cast<Index>(global_rows));
    gathering.connect(comm, next);
    made_r.resize(gathering.moved() ? made_rows : 0);
    made_z.resize(made_r.size());
    return true;
}

// z += P M_c P^T t
void RigidMultilevel::State::correct(std::size_t depth, std::span<const double> t, std::span<double> z) {
    auto& [level, links, gathering, made_r, made_z] = stages[depth];
    auto& next = stages[depth + 1].level;
    auto& coarse_r = gathering.moved() ? made_r : next.r;
    const auto& coarse_z = gathering.moved() ? made_z : next.z;
    std::fill(coarse_r.begin(), coarse_r.end(), 0.0);
    links.restrict_to(level, t, coarse_r);
    if (gathering.moved()) gathering.down(made_r, next.r);
    const bool exact = depth + 2 == used && direct;
    if (options->cycle == Cycle::w && !exact) {
        twice(depth + 1, next.r, next.z);
    } else {
        cycle(depth + 1, next.r, next.z);
    }
    if (gathering.moved()) gathering.up(next.z, made_z);
    links.prolong(level, coarse_z, z);
}

// z = (2 M - M A M) r
void RigidMultilevel::State::twice(std::size_t depth, std::span<const double> r, std::span<double> z) {
    auto& level = stages[depth].level;
    auto& [left, more] = level.second;
    left.resize(r.size());
    more.resize(r.size());
    cycle(depth, r, z);
    level.residual(r, z, left);
    cycle(depth, left, more);
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += more[i];
}

void RigidMultilevel::State::cycle(std::size_t depth, std::span<const double> r, std::span<double> z) {
    auto& level = stages[depth].level;
    const bool last = depth + 1 == used;
    if (last && direct) {
        dense.solve(r, z);
        return;
    }
    level.sweep_down_from_zero(r, z, level.t);
    if (!last) correct(depth, level.t, z);
    level.sweep_up(r, z);
}

namespace {
RigidMultilevelOptions checked(const RigidMultilevelOptions& options) {
    if (options.overcorrection < 1 || options.overcorrection >= 2) throw std::logic_error("rigid multilevel: overcorrection");
    if (options.box < 1) throw std::logic_error("rigid multilevel: box");
    return options;
}
} // namespace

RigidMultilevel::RigidMultilevel(const Comm& comm, RigidMultilevelOptions options)
    : comm_(comm), options_(checked(options)), state_(std::make_unique<State>()) {}
RigidMultilevel::~RigidMultilevel() = default;
RigidMultilevel::RigidMultilevel(RigidMultilevel&&) noexcept = default;
RigidMultilevel& RigidMultilevel::operator=(RigidMultilevel&&) noexcept = default;

void RigidMultilevel::set_up(const Matrix& matrix, const VelocityRows& rows) {
    auto& state = *state_;
    state.options = &options_;
    state.find_rows(matrix, rows);
    int stride = 1;
    while (!state.direct && state.add_level(comm_, rows.dimensions, stride)) {
        auto& last = state.stages[state.used - 1].level;
        state.direct = last.global_rows <= options_.dense_rows;
        if (state.direct) state.dense.factor(last);
    }
    for (std::size_t k = 0; k < state.used && comm_.size() > 1; ++k) state.stages[k].level.secure_sweeps();
}

void RigidMultilevel::apply(std::span<const double> r, std::span<double> z) { state_->cycle(0, r, z); }

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
    std::size_t total = state_->dense.bytes() + 8 * state_->places.capacity();
    for (const auto& stage : state_->stages) {
        total += stage.level.bytes() + stage.links.bytes() + stage.gathering.bytes() +
                 8 * (stage.made_r.capacity() + stage.made_z.capacity());
    }
    return total;
}

} // namespace treacle::solve
