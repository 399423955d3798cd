#pragma once
#include "kokkos/cells.hpp"
#include "mpi/comm.hpp"

#include <span>
#include <vector>

namespace treacle {

// Distribution of the grid's cells: cell-aligned boxes, one per rank, by recursive coordinate bisection. Boxes may be
// empty when there are more ranks than cells. Every rank has all boxes.
class Decomposition {
public:
    Decomposition(const Comm& comm, const CellGrid& grid);

    // Group, cells, this rank's box of cells, and all boxes by rank; boxes change with load balance and restore().
    const Comm& comm() const { return comm_; }
    const CellGrid& grid() const { return grid_; }
    const CellBox& box() const { return boxes_[static_cast<std::size_t>(comm_.rank())]; }
    const std::vector<CellBox>& boxes() const { return boxes_; }

    // Collective: repartitions so that each rank gets about the same weight. `cells` [n][3] and `weights` [n]
    // are this rank's weighted cells, of any rank's box. Each level of the bisection sums one histogram per
    // box and axis and takes the plane with the least load, for a little more one between coarse cells of multigrid: what moves grows with the cells of an edge, not of the volume.
    void repartition(std::span<const int> cells, std::span<const double> weights);
    // Collective: goes back to a bisection of the same number of ranks, as state() gave it.
    void restore(std::span<const std::int64_t> state);
    std::vector<std::int64_t> state() const;

    // The bisection as arrays that kernels descend: node k cuts at `cut` along `axis`; children >= 0 are
    // nodes, children < 0 are ranks -1-child.
    struct Tree {
        Array<int> axis, cut, left, right; // [nodes]
        KOKKOS_INLINE_FUNCTION int owner(const int c[3]) const {
            int node = root;
            while (node >= 0) node = c[axis(node)] < cut(node) ? left(node) : right(node);
            return -1 - node;
        }
        int root = -1; // rank 0 owns everything
    };
    const Tree& tree() const { return tree_; }

private:
    struct Node {
        int axis, cut, left, right;
    };
    void upload(const std::vector<Node>& nodes, int root);

    Comm comm_;
    CellGrid grid_;
    std::vector<CellBox> boxes_;
    std::vector<Node> nodes_;
    Tree tree_;
};

} // namespace treacle
