#pragma once
#include "grid/mac_grid.hpp"

#include <cstddef>

namespace treacle::grid {

// Of a face: nothing to solve for, an unknown, or liquid that a solid takes along.
enum FaceRole : int { idle_face, free_face, held_face };

// What the viscous solve sees of faces and stresses, by the places of a window; place i + stride[a] is the next along a.
struct ViscousFaces {
    CellBox window;
    std::ptrdiff_t stride[3]{1, 1, 1};
    int dimensions = 3;
    Array<double> normal;   // w of the stresses xx, yy, zz at the centre [kg/s]
    EdgeField shear;        // w of the shear stress at the edge [kg/s]
    Array<int> role[3];     // FaceRole
    FaceField share;        // W_F of free faces, else 0
    FaceField scale;        // of the bodies' shares in a face's cube: W_S = scale * share of the body
    FaceField mass;         // of the liquid, over dt [kg/s]
    FaceField solid;        // sum W_S R V of the bodies as they move now [m/s]
    bool slips = false;
    Array<double> traction[6]; // xx, yy, zz, xy, yz, zx of the cell's slip surface: force = -traction (u - V) [kg/s]
    FaceField lean;            // share that face i has, against face i + stride, in the velocity at a cell's centre

    // The stresses beside face i across a: use(where), with where = 0 … 3 (2 in the plane): edges, and the two centres.
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_stress(int a, std::ptrdiff_t i, const Array<double>& centre, const EdgeField& edge,
                                            const Use& use) const {
        use(centre(i));
        use(centre(i - stride[a]));
        for (int b = 0; b < dimensions; ++b) {
            if (b == a) continue;
            use(edge.axis[3 - a - b](i));
            use(edge.axis[3 - a - b](i + stride[b]));
        }
    }

    // Row (a, i) of D^T K D: use(b, j, entry) for each face j across b that it meets, itself first; some come twice.
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_entry(int a, std::ptrdiff_t i, const Use& use) const {
        double sum = 0;
        each_stress(a, i, normal, shear, [&](double w) { sum += w; });
        use(a, i, sum);
        const std::ptrdiff_t s = stride[a];
        if (normal(i) > 0) use(a, i + s, -normal(i));
        if (normal(i - s) > 0) use(a, i - s, -normal(i - s));
        for (int b = 0; b < dimensions; ++b) {
            if (b == a) continue;
            const std::ptrdiff_t t = stride[b];
            const double below = shear.axis[3 - a - b](i), above = shear.axis[3 - a - b](i + t);
            if (below > 0) {
                use(a, i - t, -below);
                use(b, i, below);
                use(b, i - s, -below);
            }
            if (above > 0) {
                use(a, i + t, -above);
                use(b, i + t, -above);
                use(b, i + t - s, above);
            }
        }
        if (!slips) return;
        slip_entries(a, i, lean.axis[a](i), use);
        slip_entries(a, i - s, 1 - lean.axis[a](i - s), use);
    }
    // Those of the slip surface in a cell, in which the face has a part of the velocity.
    template <class Use>
    KOKKOS_INLINE_FUNCTION void slip_entries(int a, std::ptrdiff_t cell, double part, const Use& use) const {
        for (int b = 0; b < dimensions; ++b) {
            const double k = traction[a == b ? a : (a + b == 1 ? 3 : (a + b == 3 ? 4 : 5))](cell);
            if (k == 0) continue;
            const double lower = lean.axis[b](cell);
            use(b, cell, k * (part * lower));
            use(b, cell + stride[b], k * (part * (1 - lower)));
        }
    }
};

} // namespace treacle::grid
