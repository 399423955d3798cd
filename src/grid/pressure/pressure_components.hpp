#pragma once
#include "base/disjoint_sets.hpp"
#include "grid/pressure/part_relief.hpp"
#include "grid/pressure/pressure_coupling.hpp"

#include <span>
#include <vector>

namespace treacle::grid {

// Closed parts of the liquid (P3): sets of cells that openings connect, across ranks, and that no surface ends. Their
// pressure is free but for a constant, and there is none unless as much flows in as out; so is that of several together to
// which no body gives way. Without them nothing is done; one pass of union-find over the entries, and messages only while
// labels change at the borders of ranks.
class PressureComponents {
public:
    // Collective. Weights one cell of each closed part, by as much as its diagonal: for right-hand sides that are balanced
    // that cell's pressure is zero then, and that of the others is what it is without the weight. Where a dynamic body
    // moves under a constant pressure, there is nothing free: `unpinned()` has what to take off of the product again.
    void anchor(const Comm& comm, const solve::CsrBlocks& matrix, std::span<const double> dirichlet_diagonal,
        const PressureCoupling& coupling, const rigid::RigidBodies& bodies);
    // Collective: takes off of b what closed parts have too much, where no body gives way to it, from each cell by its openings: a cell
    // that a solid all but closes would else have to take through them what any other does. Returns the largest share of |b| that was taken.
    double balance(const Comm& comm, std::span<double> b) const;

    // Addition to a diagonal entry.
    struct Weight {
        int row;      // of this rank
        double value; // [1], as the matrix
    };
    const std::vector<Weight>& unpinned() const {
        return unpinned_;
    } // this rank's; those whose parts bodies can relieve
    // [rows] number of the enclosed component that a row belongs to, or -1; empty without any.
    std::span<const int> closed_rows() const {
        return closed() > 0 ? std::span<const int>(parts_) : std::span<const int>();
    }
    int closed() const { return static_cast<int>(labels_.size()); } // parts, over all ranks

private:
    void label(const Comm& comm, const solve::CsrBlocks& matrix, std::span<const double> dirichlet_diagonal);
    void weigh(const solve::CsrBlocks& matrix);
    void number(const Comm& comm, std::int64_t first_row);
    void find_relief(const Comm& comm, const PressureCoupling& coupling, const rigid::RigidBodies& bodies);

    DisjointSets sets_; // of rows: parts on this rank
    std::vector<double>
        label_; // [rows] of the least of each: least row of the part over all ranks; + 0.5: it ends at a surface
    std::vector<std::int64_t> labels_; // of the enclosed components, rising, the same on all ranks
    std::vector<int> parts_;           // [rows] number of the closed part, or -1
    std::vector<double> weights_;      // [rows] diagonal entries, the openings of cells
    std::vector<double> sizes_;        // [enclosed components] their sums, over all ranks
    std::vector<Weight> unpinned_;
    PartRelief relief_;
};

} // namespace treacle::grid
