#include "solve/multigrid/multilevel.hpp"

#include "base/text/contract.hpp"
#include "solve/multigrid/chebyshev.hpp"
#include "solve/multigrid/coarsen.hpp"
#include "solve/multigrid/dense.hpp"
#include "solve/rows/vectors.hpp"

#include <algorithm>
#include <deque>
#include <stdexcept>

namespace treacle::solve {

namespace {
constexpr int max_coarsening_levels = 20;
// Levels that hardly shrink cost as much as the one above and converge no faster than without.
constexpr double least_shrinkage = 0.7;
// Finite differences on cells of twice the width: half of what P^T A P gives where all eight cells are liquid.
constexpr double grid_divisor = 2;
// Key of rows that no coarse matrix has; larger than all keys of cells, also of coarse levels.
constexpr MortonKey no_cell = ~MortonKey{0};

// A level, and the way from its aggregates to the next one.
struct Stage {
    Level level;
    RankAgglomeration agglomeration;
    std::vector<double> made_r, made_z; // [aggregates], where the next level has moved
    Chebyshev chebyshev;                // where it is the smoother
};
} // namespace

Smoother default_smoother() {
    const bool parallel = Kokkos::is_initialized() && Kokkos::DefaultExecutionSpace().concurrency() > 1;
    return parallel ? Smoother::chebyshev : Smoother::gauss_seidel;
}

struct Multilevel::State {
    const MultilevelOptions* options = nullptr;
    std::deque<Stage> stages; // of the deepest hierarchy so far
    std::size_t used = 0;     // levels of the present one
    bool direct = false;      // the last level is solved for directly
    CellSet dirichlet;
    CoarseRows made;
    Coarsener coarsener;
    DenseFactor dense;

    void coarsen_cells(const Comm& comm, Level& level, bool finest);
    bool add_level(const Comm& comm, int& stride, std::span<const double> densities);
    void cycle(std::size_t depth, std::span<const double> r, std::span<double> z);
    void twice(std::size_t depth, std::span<const double> r, std::span<double> z);
    void correct(std::size_t depth, std::span<const double> t, std::span<double> z);
    void set_up_smoothers(const Comm& comm);
    void smooth_down(std::size_t depth, std::span<const double> r, std::span<double> z);
    void smooth_up(std::size_t depth, std::span<const double> r, std::span<double> z);
    Smoother smoother(std::size_t depth) const {
        return depth > 0 && options->smoother == Smoother::jacobi ? Smoother::gauss_seidel : options->smoother;
    }
    int sweeps(std::size_t depth) const { return depth == 0 ? 1 : options->coarse_sweeps; }
};

// Finds the aggregates of a level: the cells of the matrix itself, then cells of twice the width, or of four times
// and more where liquid is so scattered that few would join.
void Multilevel::State::coarsen_cells(const Comm& comm, Level& level, bool finest) {
    const auto order = options->coarse == CoarseMatrices::grids ? RowOrder::red_black : RowOrder::along_curve;
    if (finest) {
        aggregate(level, 0, order, dirichlet);
        return;
    }
    for (int coarsening_levels = 1; coarsening_levels <= max_coarsening_levels; ++coarsening_levels) {
        coarsen(dirichlet, 1);
        sort_unique(dirichlet);
        aggregate(level, coarsening_levels, order, dirichlet);
        const auto made_rows = comm.sum(std::int64_t{level.aggregates()});
        if (double(made_rows) <= least_shrinkage * double(level.global_rows)) return;
    }
}

// False when there is nothing to coarsen.
bool Multilevel::State::add_level(const Comm& comm, int& stride, std::span<const double> densities) {
    const bool finest = used == 1;
    if (stages.size() == used) stages.emplace_back();
    auto& [level, agglomeration, made_r, made_z, chebyshev] = stages[used - 1];
    coarsen_cells(comm, level, finest);
    const auto global_rows = comm.sum(std::int64_t{level.aggregates()});
    if (global_rows == 0) return false;
    if (options->coarse == CoarseMatrices::galerkin) {
        coarsener.make_galerkin(comm, level, options->overcorrection, made);
    } else if (finest) {
        coarsener.make_grid(comm, level, {options->grid_coupling, densities, dirichlet}, made);
    } else {
        coarsener.make_galerkin(comm, level, grid_divisor, made);
    }
    const int old_stride = stride;
    stride = RankAgglomeration::wider(
        comm, stride, global_rows, global_rows <= options->max_coarse_size ? global_rows : options->min_rows_per_rank);
    agglomeration.move(comm, stride > old_stride ? stride : 1, coarsener.first_made(), made, dirichlet);
    auto& next = stages[used++].level;
    next.take(
        comm, made, static_cast<Index>(comm.exclusive_sum(std::int64_t{made.rows()})), static_cast<Index>(global_rows));
    agglomeration.connect(comm, next);
    const auto made_rows = agglomeration.moved() ? static_cast<std::size_t>(level.aggregates()) : 0;
    made_r.resize(made_rows);
    made_z.resize(made_rows);
    return true;
}

// z += P M_c P^T t
void Multilevel::State::correct(std::size_t depth, std::span<const double> t, std::span<double> z) {
    auto& [level, agglomeration, made_r, made_z, chebyshev] = stages[depth];
    auto& next = stages[depth + 1].level;
    auto& coarse_r = agglomeration.moved() ? made_r : next.r;
    const auto& coarse_z = agglomeration.moved() ? made_z : next.z;
    level.restrict_to(t, coarse_r);
    if (agglomeration.moved()) agglomeration.down(made_r, next.r);
    const bool exact = depth + 2 == used && direct;
    if (options->cycle == Cycle::w && !exact) {
        twice(depth + 1, next.r, next.z);
    } else {
        cycle(depth + 1, next.r, next.z);
    }
    if (agglomeration.moved()) agglomeration.up(next.z, made_z);
    level.prolong(coarse_z, z);
}

// z = (2 M - M A M) r
void Multilevel::State::twice(std::size_t depth, std::span<const double> r, std::span<double> z) {
    auto& level = stages[depth].level;
    auto& [left, more] = level.second;
    left.resize(r.size());
    more.resize(r.size());
    cycle(depth, r, z);
    level.residual(r, z, left);
    cycle(depth, left, more);
    add(1.0, more, z);
}

// From z = 0; leaves t = r - A z in the level.
void Multilevel::State::smooth_down(std::size_t depth, std::span<const double> r, std::span<double> z) {
    auto& stage = stages[depth];
    auto& level = stage.level;
    switch (smoother(depth)) {
    case Smoother::jacobi:
        scale(options->jacobi_weight, level.inverse_diagonal(), r, z);
        level.residual(r, z, level.t);
        return;
    case Smoother::chebyshev: // (ML6)
        stage.chebyshev.start(level, r, z);
        for (int sweep = 1; sweep < sweeps(depth); ++sweep) stage.chebyshev.improve(level, r, z);
        level.residual(r, z, level.t);
        return;
    case Smoother::gauss_seidel: // (ML3)
        level.sweep_forward_from_zero(r, z, level.t);
        for (int sweep = 1; sweep < sweeps(depth); ++sweep) level.sweep_forward(r, z);
        if (sweeps(depth) > 1) level.residual(r, z, level.t);
        if (options->interface_sweeps) level.sweep_interface_forward(z, level.t);
    }
}

// The adjoint of the way down.
void Multilevel::State::smooth_up(std::size_t depth, std::span<const double> r, std::span<double> z) {
    auto& stage = stages[depth];
    auto& level = stage.level;
    switch (smoother(depth)) {
    case Smoother::jacobi:
        level.residual(r, z, level.t);
        add(options->jacobi_weight, level.inverse_diagonal(), level.t, z);
        return;
    case Smoother::chebyshev:
        for (int sweep = 0; sweep < sweeps(depth); ++sweep) stage.chebyshev.improve(level, r, z);
        return;
    case Smoother::gauss_seidel:
        if (options->interface_sweeps) level.sweep_interface_backward(r, z);
        for (int sweep = 0; sweep < sweeps(depth); ++sweep) level.sweep_backward(r, z);
    }
}

void Multilevel::State::cycle(std::size_t depth, std::span<const double> r, std::span<double> z) {
    const bool last = depth + 1 == used;
    if (last && direct) {
        dense.solve(r, z);
        return;
    }
    smooth_down(depth, r, z);
    if (!last) correct(depth, stages[depth].level.t, z);
    smooth_up(depth, r, z);
}

// Smoothers of the levels that are not solved for directly.
void Multilevel::State::set_up_smoothers(const Comm& comm) {
    if (options->smoother == Smoother::chebyshev) {
        const std::size_t smoothed = direct ? used - 1 : used;
        for (std::size_t k = 0; k < smoothed; ++k) stages[k].chebyshev.set_up(comm, stages[k].level);
    } else if (options->relaxation > 1) {
        for (std::size_t k = 0; k < used; ++k) stages[k].level.set_l1_diagonal(options->relaxation);
    }
}

namespace {
MultilevelOptions checked(const MultilevelOptions& options) {
    if (options.overcorrection < 1 || options.overcorrection >= 2) throw std::logic_error("multilevel: overcorrection");
    if (options.relaxation < 1 || options.relaxation >= 2) throw std::logic_error("multilevel: relaxation");
    if (options.jacobi_weight <= 0 || options.jacobi_weight > 1) throw std::logic_error("multilevel: jacobi_weight");
    if (options.coarse == CoarseMatrices::grids && options.cycle == Cycle::w) {
        throw std::logic_error("multilevel: a W-cycle on grids may be indefinite");
    }
    return options;
}
} // namespace

Multilevel::Multilevel(const Comm& comm, MultilevelOptions options)
    : comm_(comm), options_(checked(options)), state_(std::make_unique<State>()) {}
Multilevel::~Multilevel() = default;
Multilevel::Multilevel(Multilevel&&) noexcept = default;
Multilevel& Multilevel::operator=(Multilevel&&) noexcept = default;

void Multilevel::set_up(Matrix& matrix, const MultilevelCells& cells) {
    auto& state = *state_;
    state.options = &options_;
    if (state.stages.empty()) state.stages.emplace_back();
    auto& finest = state.stages[0].level;
    const auto rows = static_cast<std::size_t>(matrix.rows());
    TREACLE_EXPECT(cells.cells.size() == 3 * rows);
    finest.keys.resize(rows);
    for (std::size_t i = 0; i < rows; ++i) finest.keys[i] = cell_key(&cells.cells[3 * i]);
    state.dirichlet.clear();
    finest.fixed.assign(cells.fixed.begin(), cells.fixed.end());
    finest.refer_to(matrix);
    for (std::size_t i = 0; i < finest.fixed.size(); ++i) {
        if (finest.fixed[i] != 0) finest.keys[i] = no_cell;
    }
    if (!finest.fixed.empty()) state.dirichlet = {no_cell};
    finest.walls.clear();
    if (options_.coarse == CoarseMatrices::grids) {
        finest.walls.assign(cells.walls.begin(), cells.walls.end());
        for (std::size_t k = 0; k < cells.dirichlet.size(); k += 3) {
            state.dirichlet.push_back(cell_key(&cells.dirichlet[k]));
        }
        sort_unique(state.dirichlet);
    }
    state.used = 1;
    state.direct = false;
    int stride = 1;
    while (!state.direct && state.add_level(comm_, stride, cells.densities)) {
        auto& last = state.stages[state.used - 1].level;
        state.direct = last.global_rows <= options_.max_coarse_size;
        if (state.direct) state.dense.factor(last);
    }
    state.set_up_smoothers(comm_);
}

void Multilevel::apply(std::span<const double> r, std::span<double> z) { state_->cycle(0, r, z); }

std::vector<LevelSize> Multilevel::sizes() const {
    std::vector<LevelSize> sizes;
    for (std::size_t k = 0; k < state_->used; ++k) {
        const auto& level = state_->stages[k].level;
        sizes.push_back({comm_.sum(std::int64_t{level.rows}), comm_.sum(level.entries()),
            static_cast<int>(comm_.sum(std::int64_t{level.rows > 0}))});
    }
    return sizes;
}

double Multilevel::operator_complexity() const {
    double entries = 0, first = 0;
    for (const auto& size : sizes()) {
        if (entries == 0) first = double(size.entries);
        entries += double(size.entries);
    }
    return first > 0 ? entries / first : 1.0;
}

std::size_t Multilevel::bytes() const {
    std::size_t total = state_->dense.bytes();
    for (const auto& stage : state_->stages) {
        total += stage.level.bytes() + stage.agglomeration.bytes() + stage.chebyshev.bytes() +
                 8 * (stage.made_r.capacity() + stage.made_z.capacity());
    }
    return total;
}

} // namespace treacle::solve
