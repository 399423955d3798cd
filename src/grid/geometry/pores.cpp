#include "grid/geometry/pores.hpp"

namespace treacle::grid {

namespace {
constexpr int shell = 3; // nodes from the middle of a cell to what encloses a pore

struct Enclosure {
    FineNodes nodes;
    Array<double> distance, solid;

    KOKKOS_INLINE_FUNCTION bool is_open(int node) const { return distance(node) >= 0 && !nodes.is_inside(solid(node)); }
    // True if the window has all nodes of the shell around the middle of cell c.
    KOKKOS_INLINE_FUNCTION bool is_known(const int c[3]) const {
        bool known = true;
        for (int k = 0; k < nodes.dimensions; ++k)
            known = known && c[k] > nodes.window.lo[k] && c[k] + 2 < nodes.window.hi[k];
        return known;
    }
    // Calls use(node) for the nodes `far` nodes from the middle of cell c, along the axis that each is farthest along, until it returns
    // false; returns whether it never did.
    template <class Use>
    KOKKOS_INLINE_FUNCTION bool each_around(const int c[3], int far, const Use& use) const {
        const bool flat = nodes.dimensions == 2;
        const int deep = flat ? 0 : far, middle[3] = {2 * c[0] + 1, 2 * c[1] + 1, flat ? 0 : 2 * c[2] + 1};
        for (int z = -deep; z <= deep; ++z) {
            for (int y = -far; y <= far; ++y) {
                const bool outermost = y == -far || y == far || (!flat && (z == -far || z == far));
                for (int x = -far; x <= far; x += outermost ? 1 : 2 * far) {
                    if (!use(nodes.index(middle[0] + x, middle[1] + y, middle[2] + z))) return false;
                }
            }
        }
        return true;
    }
    // True where the nodes around the middle of cell c are not all in liquid or solids, but those of the shell are, and one in liquid.
    KOKKOS_INLINE_FUNCTION bool is_pore(const int c[3]) const {
        if (!is_known(c)) return false;
        const int middle =
            FineNodes::per_cell * static_cast<int>(nodes.window.index(c[0], c[1], c[2])) + nodes.used() - 1;
        if (!is_open(middle) && each_around(c, 1, [&](int node) { return !is_open(node); })) return false;
        bool wet = false;
        return each_around(c, shell, [&](int node) {
            wet = wet || distance(node) < 0;
            return !is_open(node);
        }) && wet;
    }
    // True if node `corner` of cell c is at most two nodes from the middle of a cell with a pore around it.
    KOKKOS_INLINE_FUNCTION bool is_in_pore(const int c[3], int corner, const Array<int>& pores) const {
        const int deep = nodes.dimensions == 2 ? 0 : 1;
        for (int z = -deep; z <= (corner >> 2 & 1); ++z) {
            for (int y = -1; y <= (corner >> 1 & 1); ++y) {
                for (int x = -1; x <= (corner & 1); ++x) {
                    if (pores(nodes.window.index(c[0] + x, c[1] + y, c[2] + z))) return true;
                }
            }
        }
        return false;
    }
};
} // namespace

void Pores::close(CellHalo& halo, const Solids& solids, const Array<double>& distance) {
    const Enclosure around{solids.nodes(), distance, solids.distance()};
    const CellBox window = halo.window(), owned = halo.owned();
    reserve(found_, static_cast<std::size_t>(window.size()));
    const auto found = found_;
    const CellBox near =
        owned.empty() ? owned : grown(owned, 1, around.nodes.dimensions); // whose pores have owned nodes
    Kokkos::parallel_for(
        "treacle::find_pores", static_cast<int>(near.size()), KOKKOS_LAMBDA(int i) {
            int c[3];
            near.cell(i, c);
            found(window.index(c[0], c[1], c[2])) = around.is_pore(c);
        });
    Kokkos::parallel_for(
        "treacle::close_pores", static_cast<int>(owned.size()), KOKKOS_LAMBDA(int i) {
            int c[3];
            owned.cell(i, c);
            const int first = FineNodes::per_cell * static_cast<int>(window.index(c[0], c[1], c[2]));
            for (int k = 0; k < around.nodes.used(); ++k) {
                if (around.is_open(first + k) && around.is_in_pore(c, k, found))
                    distance(first + k) = -math::max(distance(first + k), around.nodes.surface());
            }
        });
    halo.gather_blocks(distance, FineNodes::per_cell);
}

} // namespace treacle::grid
