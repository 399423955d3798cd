#pragma once
// Inside src/solve only: coarse matrices whose unknowns are the rigid motions of aggregates.
#include "solve/multigrid/coarsen.hpp"

#include <array>

namespace treacle::solve {

// Motions of an aggregate: t + w x a, a the arm from its centre; in 2D t_x, t_y, w_z.
constexpr int rigid_modes(int dimensions) { return dimensions == 3 ? 6 : 3; }

// Splits aggregates whose rows the matrix does not join, such as of a ball above a pool, which move on their own. Rows come
// in groups of `joined`, of one aggregate below. Of coarse levels, what is joined to nothing at all gets no aggregate any
// more: the sweeps are all it needs. Local; keeps its arrays.
class DisconnectedSplit {
public:
    void split(Level& level, int joined);

private:
    struct Piece {
        MortonKey key;
        Index root, begin, end;
    };
    Index root(Index row);
    void unite(Index a, Index b);
    void join_rows(const Level& level, int joined);
    bool alone(const Level& level, Index first, int joined) const;

    std::vector<Index> parent_; // [rows], of smaller numbers
    std::vector<Piece> pieces_;
    std::vector<std::pair<Index, Index>> first_met_; // [aggregates] by which row or aggregate below, and the row it met
};

// (RM1) From the motions of the aggregates of one level to what is below: the rows of the matrix, one component of a velocity
// each, or the motions of the aggregates of the level before.
struct RigidBodyProlongation {
    int dimensions = 3;
    bool finest = false; // below are the rows of the matrix; the same on all ranks, also on those without rows
    std::vector<signed char> axes; // [rows], of the matrix; of coarse levels empty
    std::vector<double> arms;      // [rows or aggregates below][3], from the centre of the aggregate [widths]

    // coarse += P^T t; z += P coarse.
    void restrict_to(const Level& level, std::span<const double> t, std::span<double> coarse) const;
    void prolong(const Level& level, std::span<const double> coarse, std::span<double> z) const;
    std::size_t bytes() const { return axes.capacity() + 8 * arms.capacity(); }
};

// Makes Galerkin products. Keeps its work arrays.
class RigidCoarsener {
public:
    // (RM2) Collective: P^T A P / divisor of a level whose rows have their aggregates; `positions` [rows or aggregates below][3]
    // in widths. Fills links.arms and, of made, all but walls.
    void make(const Comm& comm, Level& level, std::span<const double> positions, double divisor,
        RigidBodyProlongation& links, CoarseRows& made);
    Index first_made() const { return modes_ * index_.first(); } // global number of this rank's first made row

private:
    void find_arms(
        const Level& level, std::span<const double> positions, RigidBodyProlongation& links, CoarseRows& made);
    void gather_arms(const Comm& comm, Level& level, const RigidBodyProlongation& links);
    template <int D>
    void make_rows(const Level& level, double divisor, const RigidBodyProlongation& links, CoarseRows& made);
    template <int D>
    void add_row(const Level& level, const RigidBodyProlongation& links, Index row);
    template <int D>
    void add_blocks(const Level& level, const RigidBodyProlongation& links, Index node);
    template <int D>
    void end_rows(double divisor, CoarseRows& made);
    double* block(Index index);

    int modes_ = 6;
    AggregateIndex index_;
    std::vector<double> halo_arms_;            // [halo of the level][3], of aggregates [halo / modes][3]
    std::vector<signed char> halo_axes_;       // [halo of the level], of the matrix
    std::vector<Index> slot_;                  // where in blocks_ an index stands, -1: nowhere
    std::vector<std::pair<Index, Index>> met_; // global number and slot of the aggregates that one couples to
    std::vector<Index> met_indices_;
    std::vector<double> blocks_; // [slots][modes][modes]
    std::vector<double> scratch_;
};

} // namespace treacle::solve
