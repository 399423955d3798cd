#pragma once
#include "grid/mac/mac_grid.hpp"
#include "grid/viscosity/volume_stiffness.hpp"

#include <cstddef>

namespace treacle::grid {

// Role of a face: nothing to solve for, an unknown, or liquid that a solid takes along.
enum FaceRole : int { inactive_face, unknown_face, prescribed_face };

// Faces and stresses for the viscous solve, by the places of a window; place i + stride[a] is the next along a.
struct ViscousFaces {
    CellBox window;
    std::ptrdiff_t stride[3]{1, 1, 1};
    int dimensions = 3;
    Array<double> normal; // w of the stresses xx, yy, zz at the centre [kg/s]
    EdgeField shear;      // w of the shear stress at the edge [kg/s]
    Array<int> role[3];   // FaceRole
    FaceField fraction;   // W_F of free faces, else 0
    FaceField scale;      // of the bodies' fractions of a face's cube: W_S = scale * fraction of the body
    FaceField mass;       // of the liquid, over dt [kg/s]
    FaceField solid;      // sum W_S R V of the bodies as they move now [m/s], with their bend
    FaceField bend;       // of that what BodyMotion::bend gives, and sides of the domain that move
    bool strained = false;
    Array<double>
        strain[3];          // normal strain rates at the centres that no stress resists [m/s over dx], step_strains.hpp
    EdgeField shear_strain; // and twice the shear strain rates at edges
    double dx = 0;          // [m]
    bool slips = false;
    Array<double> traction[6]; // xx, yy, zz, xy, yz, zx of the cell's slip surface: force = -traction (u - V) [kg/s]
    FaceField
        slip_interpolation_weight; // share that face i has, against face i + stride, in the velocity at a cell's slip surface
    Array<int> slip_body;          // whose surface slips in a cell, < 0: of no body
    Array<double> wall[3];         // the velocity of that solid there [m/s]
    Array<double> wall_bend[3]; // of that what sides of the domain have that move
    VolumeStiffness volumes;    // of cells whose volume the matrix holds, too

    // The stresses beside face i across a: use(where), with where = 0 … 3 (2 in 2D): edges, and the two centres.
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_stress(
        int a, std::ptrdiff_t i, const Array<double>& centre, const EdgeField& edge, const Use& use) const {
        use(centre(i));
        use(centre(i - stride[a]));
        for (int b = 0; b < dimensions; ++b) {
            if (b == a) continue;
            use(edge.axis[3 - a - b](i));
            use(edge.axis[3 - a - b](i + stride[b]));
        }
    }

    // Row (a, i) of D^T K e for the strains e that no stress resists [kg m/s2].
    KOKKOS_INLINE_FUNCTION double strain_pull(int a, std::ptrdiff_t i) const {
        if (!strained) return 0;
        const std::ptrdiff_t s = stride[a];
        double sum = 0;
        if (normal(i - s) > 0) sum += normal(i - s) * strain[a](i - s);
        if (normal(i) > 0) sum -= normal(i) * strain[a](i);
        for (int b = 0; b < dimensions; ++b) {
            if (b == a) continue;
            const auto& weight = shear.axis[3 - a - b];
            const auto& rate = shear_strain.axis[3 - a - b];
            if (weight(i) > 0) sum += weight(i) * rate(i);
            if (weight(i + stride[b]) > 0) sum -= weight(i + stride[b]) * rate(i + stride[b]);
        }
        return dx * sum;
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
        each_slip(a, i, [&](std::ptrdiff_t cell, int b, double k) {
            const double lower = slip_interpolation_weight.axis[b](cell);
            use(b, cell, k * lower);
            use(b, cell + stride[b], k * (1 - lower));
        });
    }

    // Slip surfaces of face i: use(cell, b, k) for a force -k (u_b - V_b) along a at the slip surface of the cell.
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_slip(int a, std::ptrdiff_t i, const Use& use) const {
        if (!slips) return;
        for (int side = 0; side < 2; ++side) {
            const std::ptrdiff_t cell = side == 0 ? i : i - stride[a];
            const double part =
                side == 0 ? slip_interpolation_weight.axis[a](cell) : 1 - slip_interpolation_weight.axis[a](cell);
            for (int b = 0; b < dimensions; ++b) {
                const double k = traction[component(a, b)](cell);
                if (k != 0) use(cell, b, k * part);
            }
        }
    }
    // Index of a component among xx, yy, zz, xy, yz, zx.
    KOKKOS_INLINE_FUNCTION static int component(int a, int b) {
        return a == b ? a : (a + b == 1 ? 3 : (a + b == 3 ? 4 : 5));
    }
    // Point at which the velocity along b of the slip surface of cell c is taken.
    KOKKOS_INLINE_FUNCTION void slip_point(const MacGrid& grid, int b, const int c[3], double x[3]) const {
        grid.face(b, c, x);
        x[b] += (1 - slip_interpolation_weight.axis[b](window.index(c[0], c[1], c[2]))) * grid.dx;
    }
};

} // namespace treacle::grid
