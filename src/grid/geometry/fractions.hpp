#pragma once
#include "grid/geometry/solids.hpp"
#include "grid/mac/fine_nodes.hpp"

namespace treacle::grid {

// Method by which volumes are found (dissertation 5.3.3).
enum class FractionMethod {
    consistent,   // parts of the double-resolution grid, each clipped once, summed to the cubes of all places
    independent,  // the cube of each place by its own eight corners; to compare with
    supersampled, // parts of the double-resolution grid by the signs at their middles; to compare with
};

// Volume fractions of all places of a window.
class FractionBuilder {
public:
    // `solid` and `liquid`: distances [m] at the fine nodes of the window of at least 3 layers around the owned cells,
    // negative inside. Fills `out` for the places of all cells of the window but those of its outermost layer, where
    // there is no liquid and no solid: wet = liquid = 0, fluid = open = 1. Arrays grow as they must. Local: no messages.
    // `walls`: sides of the domain that `solid` has, or none: beside those that lie on nodes bodies are cut by their own distance, since the nodes
    // there have that of the wall, zero, and a body that meets it would be rounded off.
    // `changes`: Solids::changes() of `solid`; what depends on them alone is kept where they are as they were. -1: not known.
    void build(const FineNodes& nodes, const Array<double>& solid, const Array<double>& liquid, FractionMethod method,
        Fractions& out, const WallPlanes& walls = {}, std::int64_t changes = -1);
    void build(const Solids& solids, const Array<double>& liquid, FractionMethod method, Fractions& out) {
        build(solids.nodes(), solids.distance(), liquid, method, out, solids.walls(), solids.changes());
    }

    // Shares of the bodies that move in the cubes around the faces across each axis, as build() found the fluid's, of the
    // same window. Solid parts of half-width cubes belong to the solid nearest to their corners.
    // `number`: solids at the fine nodes, Solids::number(); `moves` [bodies]: 1 where a body moves.
    void build_body_fractions(const FineNodes& nodes, const Array<double>& solid, const Array<int>& number,
        const Array<int>& moves, BodyFractions body_fractions[3]) const;

    std::size_t mixed_cells() const { return mixed_; } // of the last build

private:
    Array<int> signs_{"treacle::fraction_signs", 0};     // [window], in build_body_fractions() the cells with bodies
    Array<int> slot_{"treacle::fraction_slot", 0};       // [window] >= 0: row of parts_; below: one kind all through
    Array<int> dry_{"treacle::fraction_dry", 0};         // [window] 1: no node of the cell is in the liquid
    Array<int> written_{"treacle::fraction_written", 0}; // [window] the kind that `out` holds
    Array<double> parts_{"treacle::fraction_parts", 0};  // [mixed cells][8][fluid, liquid, wet]
    std::size_t mixed_ = 0;
    std::int64_t changes_ = -1;           // of the solids that written_ is about
    CellBox filled_;                      // window that written_ is about
    const double* filled_data_ = nullptr; // and the arrays
};

} // namespace treacle::grid
