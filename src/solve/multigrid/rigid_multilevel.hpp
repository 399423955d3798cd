#pragma once
#include "solve/multigrid/multilevel.hpp"

#include <functional>

namespace treacle::solve {

// Sweeps of the finest level: one before its coarse correction and one back behind it, or one there and one back each time.
enum class FineSweeps { once, there_and_back };

struct RigidMultilevelOptions {
    // Coarse matrices are divided by these, from 1 to below 2: that of the finest aggregates, those below.
    double overcorrection = 1.6, coarse_overcorrection = 1.8;
    // Cells a side of the finest aggregates; and of systems with fewer rows than `small_rows`, which lie in the caches: smaller
    // boxes take fewer iterations, above all of thin liquid, each of twice the work.
    int box = 3, small_aggregate_width = 2;
    int small_rows = 200000;
    Cycle cycle = Cycle::w;
    FineSweeps fine_sweeps = FineSweeps::once;
    int max_coarse_size = 300;    // most unknowns that are solved for directly
    int min_rows_per_rank = 1000; // levels with fewer on average are gathered onto every eighth rank
};

// Rows of the matrix: components of a velocity at positions. Cells are integer coordinates from -2^20 to 2^20 - 1.
struct VelocityRows {
    int dimensions = 3;
    double width = 1;                  // of a cell, the unit of length of the rotations
    std::span<const int> cells;        // [rows][3]
    std::span<const double> positions; // [rows][3]; of periodic axes any image, if only it is near its cell's
    std::span<const signed char> axes; // [rows], 0 … dimensions - 1
    // [rows], 1 where a row is left to the sweeps, as if no coarse matrix had it: stiff ones beside walls; or empty.
    std::span<const unsigned char> aside{};
};

// Unknowns beside the rows, such as the motions of bodies: the whole system is [A C; C^T G]. Their rows stand behind the
// others on rank 0, with G as their entries. All levels have them, and the direct solution at the end, so that a body in a
// high-viscosity liquid moves with it.
struct BorderedBodies {
    int count = 0;
    std::function<void(std::span<const double> q, std::span<double> y)> add; // y += C q on this rank's rows
    std::function<std::vector<double>(std::span<const double> x)> project;   // C^T x of this rank's rows
    std::vector<double> block;                                               // G [count][count], on all ranks
};

// A multilevel preconditioner of matrices that hardly resist rigid motions, such as those of viscous flow or elasticity:
// boxes of cells move as rigid bodies, all components together, then boxes of 2 x 2 x 2 of them, and so on. A stiff
// liquid moves like that wherever it is thick, so that the iterations hardly depend on its viscosity. One cycle with
// symmetric Gauss–Seidel sweeps, symmetric and positive definite. Aggregates do not cross ranks; small levels move to
// fewer ranks, the last one is solved directly on rank 0. Memory is kept from one matrix to the next.
class RigidMultilevel {
public:
    RigidMultilevel(const Comm& comm, RigidMultilevelOptions options);
    ~RigidMultilevel();
    RigidMultilevel(RigidMultilevel&&) noexcept;
    RigidMultilevel& operator=(RigidMultilevel&&) noexcept;

    // Collective. The matrix must outlive its use in apply; the rows' layout is read once.
    void set_up(const Matrix& matrix, const VelocityRows& rows, BorderedBodies border = {});
    // z = M r, collective.
    void apply(std::span<const double> r, std::span<double> z);

    // From the next apply() on, the same on all ranks.
    void set_fine_sweeps(FineSweeps sweeps) { options_.fine_sweeps = sweeps; }

    // Collective. The first one is the matrix itself.
    std::vector<LevelSize> sizes() const;
    // Memory of this rank [bytes].
    std::size_t bytes() const;

    // As given to the constructor, checked, and set since.
    const RigidMultilevelOptions& options() const { return options_; }

private:
    struct State;
    Comm comm_;
    RigidMultilevelOptions options_;
    std::unique_ptr<State> state_;
};

} // namespace treacle::solve
