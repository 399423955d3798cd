#pragma once
// Inside src/solve only: from one level of a multilevel hierarchy to the next.
#include "solve/multigrid/level.hpp"
#include "solve/multigrid/multilevel.hpp"

#include <utility>

namespace treacle::solve {

// Cells with p = 0 that hold no unknown of the grid, keys rising.
using CellSet = std::vector<MortonKey>;
inline void coarsen(CellSet& cells, int coarsening_levels) {
    for (auto& key : cells) key >>= 3 * coarsening_levels;
}
void sort_unique(CellSet& cells);

// Order of the aggregates, which is that of the sweeps over them: by key, or by colour and then by key.
enum class RowOrder { along_curve, red_black };

// (ML1) Puts the rows of each cell of 2^coarsening_levels cells into one aggregate; cells of `dropped` get none. Local.
void aggregate(Level& level, int coarsening_levels, RowOrder order, const CellSet& dropped);

// Finite differences on cells of one width.
struct Rediscretisation {
    double coupling = 1;                 // of two cells, and of a cell and one of p = 0
    std::span<const double> densities{}; // [rows]; couplings are divided by the mean of both cells' means. Empty: 1
    const CellSet& dirichlet;
};

// The aggregates that this rank's rows belong to or are coupled to, under one local number each, their index: this
// rank's own first, then those of other ranks. Keeps its arrays.
class AggregateIndex {
public:
    // Collective: numbers the aggregates of all ranks.
    void number(const Comm& comm, Level& level);

    Index first() const { return first_; } // global number of this rank's first aggregate
    // Numbers of aggregates: this rank's, all with an index, those of other ranks. Global number of 0 <= index < size().
    Index own() const { return own_; }
    std::size_t size() const { return static_cast<std::size_t>(own_) + others_.size(); }
    std::size_t others() const { return others_.size(); }
    Index global(Index index) const {
        return index < own_ ? first_ + index : others_[static_cast<std::size_t>(index - own_)];
    }
    // [halo of the level]: index of the aggregate of each row of other ranks, -1: none.
    const std::vector<Index>& of_halo() const { return of_halo_; }

private:
    Index first_ = 0, own_ = 0;
    std::vector<Index> of_halo_;
    std::vector<Index> others_; // global numbers, rising
    std::vector<double> numbers_;
};

// Makes coarse matrices. Keeps its work arrays.
class Coarsener {
public:
    // (ML2) Collective: P^T A P / divisor in one pass over the entries of the level, and the sums of the walls.
    void make_galerkin(const Comm& comm, Level& level, double divisor, CoarseRows& made);
    // (ML5) Collective: finite differences with 7 points on the aggregates of the matrix itself. Cells that the matrix does
    // not couple are not coupled; walls count by their mean.
    void make_grid(const Comm& comm, Level& level, const Rediscretisation& rule, CoarseRows& made);

    Index first_made() const { return index_.first(); } // global number of this rank's first made row

private:
    using Entry = std::pair<Index, double>;
    void find_keys(Level& level);
    void find_densities(Level& level, std::span<const double> densities);
    // Collective: work(index, value) for the other ranks' aggregates, with the part of scratch_ on their rows.
    template <class Work>
    void ask_others(Level& level, const Work& work);
    void sum_rows(const Level& level, Index aggregate);
    void add(Index index, double value);
    MortonKey key_at(const CoarseRows& made, Index index) const;
    double density_at(Index index) const {
        return densities_.empty() ? 1 : densities_[static_cast<std::size_t>(index)];
    }
    void end_row(CoarseRows& made);

    void number(const Comm& comm, Level& level);

    AggregateIndex index_;
    std::vector<MortonKey> halo_keys_; // of other ranks' aggregates
    std::vector<double> densities_;    // [indices], means of the aggregates' rows; or empty
    std::vector<Index> slot_;          // where in row_ an aggregate stands, -1: nowhere
    std::vector<Entry> row_;           // of places: this rank's aggregates, then the others
    std::vector<double> scratch_;
};

// The move of a made level to fewer ranks, and the vectors' way there and back.
class RankAgglomeration {
public:
    // The stride between the ranks that hold rows, for levels of so many rows, of which each is to hold so many.
    static int wider(const Comm& comm, int stride, std::int64_t rows, std::int64_t rows_wanted);
    // Collective. Rows go to the rank's next lower multiple of the stride; other ranks are left without. 1: no move.
    void move(const Comm& comm, int stride, Index first_made, CoarseRows& made, CellSet& dropped);
    bool moved() const { return moved_; }
    // Collective, after the level has its numbers.
    void connect(const Comm& comm, const Level& level);

    // Collective: [made rows] to [level rows] on the ranks that hold rows, and back. Only where moved().
    void down(std::span<const double> made, std::span<double> level);
    void up(std::span<const double> level, std::span<double> made);
    std::size_t bytes() const { return down_.bytes() + up_.bytes(); } // memory of this rank [bytes]

private:
    bool moved_ = false, leads_ = false;
    Index first_made_ = 0, made_rows_ = 0;
    RowHalo down_, up_;
    std::vector<Index> numbers_;
};

} // namespace treacle::solve
