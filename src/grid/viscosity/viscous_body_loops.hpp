#pragma once
#include "grid/viscosity/viscous_bodies.hpp"

namespace treacle::grid {

// The owned faces, axis after axis of one cell after the other.
struct OwnedFaces {
    CellBox owned, window;
    int dimensions;
    int count() const { return static_cast<int>(owned.size()) * dimensions; }
    KOKKOS_INLINE_FUNCTION std::ptrdiff_t index(int n, int& axis, int c[3]) const {
        axis = n % dimensions;
        owned.cell(n / dimensions, c);
        return window.index(c[0], c[1], c[2]);
    }
};

// Lists of ViscousBodies::build(): a first run counts the bodies of each owned face, a second one writes their numbers.
struct ListLoop {
    ViscousFaces faces;
    OwnedFaces owned;
    BodyFractions body_fractions[3];
    BodyMotion motion; // poses and velocities of the bodies
    MacGrid grid;
    ViscousBodies::List pulled, slipped, moved; // W_F D^T K D W_S R, the same by slip surfaces, W_S R
    bool write;                                 // false: counts

    // W_S R of the bodies at a face: use(body, six numbers).
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_body(int a, std::ptrdiff_t i, const Use& use) const {
        const auto& of = body_fractions[a];
        for (int k = of.first(i); k < of.first(i + 1); ++k) {
            int c[3];
            double x[3], r[3], u[6] = {0, 0, 0, 0, 0, 0};
            owned.window.cell(static_cast<int>(i), c);
            grid.face(a, c, x);
            motion.arm(of.body(k), x, r);
            add_load(a, r, faces.scale.axis[a](i) * of.fraction(k), u);
            use(of.body(k), u);
        }
    }
    KOKKOS_INLINE_FUNCTION static void add(
        const ViscousBodies::List& to, int first, int& count, int body, const double u[6], double factor) {
        int k = first;
        while (k < first + count && to.body(k) != body) ++k;
        if (k == first + count) {
            to.body(k) = body;
            for (int l = 0; l < 6; ++l) to.u(6 * k + l) = 0;
            ++count;
        }
        for (int l = 0; l < 6; ++l) to.u(6 * k + l) += factor * u[l];
    }
    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int a, c[3];
        const auto i = owned.index(n, a, c);
        const int own =
            faces.role[a](i) == inactive_face ? 0 : body_fractions[a].first(i + 1) - body_fractions[a].first(i);
        const bool feels = own > 0 || faces.role[a](i) == unknown_face;
        if (!write) {
            int around = 0;
            if (feels) {
                faces.each_entry(a, i, [&](int b, std::ptrdiff_t j, double) {
                    around += body_fractions[b].first(j + 1) - body_fractions[b].first(j);
                });
            }
            int slips = 0;
            if (feels && faces.slips) {
                slips = static_cast<int>(faces.slip_body(i) >= 0) +
                        static_cast<int>(faces.slip_body(i - faces.stride[a]) >= 0);
            }
            moved.first(n) = own;
            pulled.first(n) = around;
            slipped.first(n) = slips;
            return;
        }
        int count = 0;
        if (own > 0) {
            each_body(a, i, [&](int body, const double u[6]) { add(moved, moved.first(n), count, body, u, 1); });
        }
        moved.last(n) = moved.first(n) + count;
        count = 0;
        if (feels && pulled.first(n + 1) > pulled.first(n)) {
            faces.each_entry(a, i, [&](int b, std::ptrdiff_t j, double entry) {
                each_body(
                    b, j, [&](int body, const double u[6]) { add(pulled, pulled.first(n), count, body, u, entry); });
            });
        }
        pulled.last(n) = pulled.first(n) + count;
        count = 0;
        if (slipped.first(n + 1) > slipped.first(n)) {
            faces.each_slip(a, i, [&](std::ptrdiff_t cell, int b, double k) {
                if (faces.slip_body(cell) < 0) return;
                int cell_indices[3];
                double x[3], r[3], u[6] = {0, 0, 0, 0, 0, 0};
                owned.window.cell(static_cast<int>(cell), cell_indices);
                faces.slip_point(grid, b, cell_indices, x);
                motion.arm(faces.slip_body(cell), x, r);
                add_load(b, r, 1, u);
                add(slipped, slipped.first(n), count, faces.slip_body(cell), u, -k);
            });
        }
        slipped.last(n) = slipped.first(n) + count;
    }
};

// Pull at the bodies in a face besides their rigid motions and the liquid: D^T K (e - D W_S bend).
struct GivenLoop {
    ViscousFaces faces;
    OwnedFaces owned;
    ViscousBodies::List moved;
    Array<double> out; // [owned faces] [N]

    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int a, c[3];
        const auto i = owned.index(n, a, c);
        out(n) = 0;
        if (moved.first(n) == moved.last(n)) return;
        double sum = faces.strain_pull(a, i);
        faces.each_entry(a, i, [&](int b, std::ptrdiff_t j, double entry) { sum -= entry * faces.bend.axis[b](j); });
        faces.each_slip(a, i, [&](std::ptrdiff_t cell, int b, double k) { sum += k * faces.wall_bend[b](cell); });
        out(n) = sum;
    }
};

// The velocities at the slip surface of a cell, along each axis, that the motions of its body give.
struct SurfaceLoop {
    ViscousFaces faces;
    CellBox owned;
    BodyMotion motion;
    MacGrid grid;
    ViscousBodies::List surface;
    bool write;

    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int c[3];
        owned.cell(n, c);
        const int body = faces.slip_body(faces.window.index(c[0], c[1], c[2]));
        if (!write) {
            surface.first(n) = body < 0 ? 0 : faces.dimensions;
            return;
        }
        if (body < 0) return;
        for (int a = 0; a < faces.dimensions; ++a) {
            double x[3], r[3], u[6] = {0, 0, 0, 0, 0, 0};
            faces.slip_point(grid, a, c, x);
            motion.arm(body, x, r);
            add_load(a, r, 1, u);
            surface.body(surface.first(n) + a) = body;
            for (int l = 0; l < 6; ++l) surface.u(6 * (surface.first(n) + a) + l) = u[l];
        }
    }
};

} // namespace treacle::grid
