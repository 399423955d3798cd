#pragma once
// Inside viscous_multilevel: one level of cells with a velocity at each corner, linear along each axis between them.
#include "base/key_index_map.hpp"
#include "kokkos/cells.hpp"
#include "mpi/shared_node_sum.hpp"
#include "sph/viscosity/multigrid/velocity_element.hpp"

#include <vector>

namespace treacle::sph {

// Widths of a cell, and how many there are along periodic axes (0: not periodic).
struct LatticeShape {
    double width[3]{1, 1, 1}; // [m]
    int period[3]{0, 0, 0};

    // The indices of a cell or node, a periodic axis once around.
    void wrap(int node[3]) const {
        for (int k = 0; k < 3; ++k) {
            if (period[k] > 0) node[k] -= period[k] * floor_divide(node[k], period[k]);
        }
    }
};

// One level: E = sum over cells of stiffness u.K u / 2 + sum over nodes of mass u.u / 2. Nodes that several ranks have are
// copies with each rank's own cells and masses: products are sums over the ranks.
template <int D>
struct VelocityCells {
    LatticeShape shape;
    int cells = 0, nodes = 0;
    std::vector<std::int64_t> cell_keys;
    KeyIndexMap node_numbers;
    std::vector<float> host_stiffness, host_mass; // [cells], [nodes]
    std::vector<int> host_corner;                 // [cells][corners] nodes
    Element<D> element;
    double largest = 1; // bound on the eigenvalues of the diagonal blocks' inverses times the matrix

    SharedNodeSum shared;                              // nodes that several ranks have
    Array<int> corner{"treacle::velocity_corners", 0}; // [cells][corners] nodes
    Array<int> around{"treacle::velocity_around", 0};  // [nodes][corners] cell * corners + corner, -1: none
    Array<float> stiffness{"treacle::velocity_stiffness", 0}, mass{"treacle::velocity_mass", 0}; // [cells], [nodes]
    Array<float> block{"treacle::velocity_blocks", 0}; // [nodes][3][4] inverses of the diagonal blocks
    Array<float> force{"treacle::velocity_forces", 0}; // [cells][corners][4]
    Array<float> r{"treacle::velocity_r", 0}, z{"treacle::velocity_z", 0}; // [nodes][4]
    Array<float> d{"treacle::velocity_d", 0}, q{"treacle::velocity_q", 0}; // [nodes][4] last change of z, A d
    Array<int> parents{"treacle::velocity_parents", 0}; // [nodes][corners] nodes of the next level, -1: none
    Array<float> parent_weight{"treacle::velocity_parent_weight", 0}; // [nodes], the same for each of them
    Array<int> children{"treacle::velocity_children", 0};             // of the level before: [nodes][3^D], -1: none

    // Collective: from cell_keys and shape, the nodes and what lies around them.
    void connect(const Comm& comm);
    // Collective: the rest, with host_mass and the element of unit stiffness and its matrix.
    void finish(const Element<D>& unit, const typename Element<D>::Matrix& matrix, double largest_eigenvalue);
    // Collective: q = A d.
    void multiply();
    // Collective: r = what the forces of all cells on each node add up to.
    void sum_forces();
    // Collective: r -= A d.
    void subtract_product();
    // Collective: steps of Chebyshev's iteration (Saad 2003, algorithm 12.1) for A z = r on this share of the eigenvalues and
    // above: from z = 0 the first time, otherwise on from z, whose last change, d, is still to be taken off r. Leaves that of
    // its own last step.
    void smooth(int steps, double fraction, bool first);
    std::size_t bytes() const;
};

} // namespace treacle::sph
