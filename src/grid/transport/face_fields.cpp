#include "grid/transport/face_fields.hpp"

#include "grid/transport/apic.hpp"

namespace treacle::grid {

void reserve_faces(FaceField& field, const MacGrid& grid, const CellBox& window) {
    for (int a = 0; a < grid.dimensions; ++a) reserve(field.axis[a], static_cast<std::size_t>(window.size()));
}

void copy_faces(const MacGrid& grid, const CellBox& window, const FaceField& from, FaceField& to) {
    reserve_faces(to, grid, window);
    const auto n = Kokkos::make_pair(std::size_t(0), static_cast<std::size_t>(window.size()));
    for (int a = 0; a < grid.dimensions; ++a) {
        Kokkos::deep_copy(Kokkos::subview(to.axis[a], n), Kokkos::subview(from.axis[a], n));
    }
}

void subtract_faces(
    const MacGrid& grid, const CellBox& window, const FaceField& a, const FaceField& b, FaceField& out) {
    reserve_faces(out, grid, window);
    for (int axis = 0; axis < grid.dimensions; ++axis) {
        const auto first = a.axis[axis], second = b.axis[axis], difference = out.axis[axis];
        Kokkos::parallel_for(
            "treacle::subtract_faces", static_cast<int>(window.size()),
            KOKKOS_LAMBDA(int i) { difference(i) = first(i) - second(i); });
    }
}

void gather_faces(const MacGrid& grid, CellHalo& halo, const FaceField& field) {
    if (grid.dimensions == 2) {
        halo.gather({field.axis[0], field.axis[1]});
    } else {
        halo.gather({field.axis[0], field.axis[1], field.axis[2]});
    }
}

void accelerate(
    const MacGrid& grid, const CellBox& window, const std::array<double, 3>& g, double dt, const FaceField& velocity) {
    for (int a = 0; a < grid.dimensions; ++a) {
        const double change = g[static_cast<std::size_t>(a)] * dt;
        const auto u = velocity.axis[a];
        Kokkos::parallel_for(
            "treacle::gravity", static_cast<int>(window.size()), KOKKOS_LAMBDA(int i) { u(i) += change; });
    }
}

void mark_valid_faces(const PressureFaces& faces, const WetFractions& wet, const DiffusionNumber& viscosity, double dx,
    FaceValidity& known) {
    const double least = wet.least;
    const bool viscous = viscosity.cell.extent(0) > 0;
    for (int a = 0; a < faces.dimensions; ++a) {
        reserve(known.axis[a], static_cast<std::size_t>(faces.window.size()));
        const auto mark = known.axis[a];
        const auto fraction = wet.fraction.axis[a];
        Kokkos::parallel_for(
            "treacle::mark_valid_faces", static_cast<int>(faces.window.size()), KOKKOS_LAMBDA(int i) {
                int c[3];
                faces.window.cell(i, c);
                const auto above = static_cast<std::size_t>(i);
                const auto below =
                    c[a] > faces.window.lo[a] ? above - static_cast<std::size_t>(faces.stride[a]) : above;
                const bool beside = faces.is_liquid(above) || faces.is_liquid(below);
                const bool is_viscous =
                    viscous && fraction(i) >= least &&
                    math::max(viscosity.diffusion_number(above, dx), viscosity.diffusion_number(below, dx)) >= 1;
                mark(i) = (beside || is_viscous) && faces.carries(a, above) ? 1 : 0;
            });
    }
}

namespace {
struct TurnLoop {
    MacGrid grid;
    CellBox owned;
    PressureFaces faces;
    DistanceSampler solid;
    Array<int> number;
    BodyMotion motion;
    FaceSampler from;
    WallCondition condition;
    FaceField to;

    // u, relative to the solid at x in it, becomes that of a velocity that falls linearly to the solid's.
    KOKKOS_INLINE_FUNCTION void apply_no_slip(
        int solid_number, double depth, const double x[3], const double n[3], double u[3]) const {
        const double dx = grid.dx;
        if (solid_number == Solids::nothing || depth > 1.25 * dx) return;
        const double length = condition.length(Solids::slot(solid_number));
        if (!math::isfinite(length)) return; // free slip
        double off[3], there[3], moved[3];
        int c[3] = {0, 0, from.window.lo[2]};
        for (int k = 0; k < 3; ++k) off[k] = x[k] + (depth + dx) * n[k]; // a cell off the surface
        for (int k = 0; k < faces.dimensions; ++k) {
            const double beside = off[k] - 0.5 * dx * n[k]; // in the cell at the surface
            const int cell = static_cast<int>(math::floor((beside - from.lower[k]) * from.inverse_width));
            c[k] = math::min(math::max(cell, from.window.lo[k]), from.window.hi[k] - 1);
        }
        from.velocity(off, there);
        motion.velocity(solid_number, off, moved);
        const double spread =
            condition.viscosity.diffusion_number(static_cast<std::size_t>(from.window.index(c[0], c[1], c[2])), dx);
        const double grown = spread / (spread + 1), fraction = (length - depth) / (length + dx);
        for (int k = 0; k < faces.dimensions; ++k) u[k] += grown * (fraction * (there[k] - moved[k]) - u[k]);
    }
    KOKKOS_INLINE_FUNCTION bool sticks(int solid_number) const {
        return condition.any && solid_number != Solids::nothing &&
               math::isfinite(condition.length(Solids::slot(solid_number)));
    }
    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        int c[3];
        owned.cell(i, c);
        const int at = faces.window.index(c[0], c[1], c[2]);
        for (int a = 0; a < faces.dimensions; ++a) {
            if (faces.carries(a, static_cast<std::size_t>(at))) continue;
            double x[3], n[3], u[3], v[3];
            grid.face(a, c, x);
            const double distance = solid.at(x);
            solid.gradient(x, n);
            const double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
            if (!(square > 1e-12)) continue; // in the middle of a solid
            const int nearest = number(solid.nodes.face_middle(a, c));
            motion.velocity(nearest, x, v, sticks(nearest));
            from.velocity(x, u);
            const double steep = 1 / math::sqrt(square);
            for (int k = 0; k < 3; ++k) n[k] *= steep, u[k] -= v[k];
            if (condition.any) apply_no_slip(nearest, math::max(-distance, 0.0), x, n, u);
            double along = 0;
            for (int k = 0; k < faces.dimensions; ++k) along += u[k] * n[k];
            const bool leaves = condition.leaves.extent(0) > 0 &&
                                (condition.leaves(at) != 0 || condition.leaves(at - faces.stride[a]) != 0);
            to.axis[a](at) = v[a] + u[a] - (leaves ? math::min(along, 0.0) : along) * n[a];
        }
    }
};
} // namespace

void enforce_wall_velocity(const FaceScene& scene, const Solids& solids, const WallCondition& condition,
    const FaceField& velocity, FaceField& scratch) {
    const auto& [grid, halo, faces] = scene;
    const CellBox owned = halo.owned();
    if (!owned.empty()) {
        copy_faces(grid, halo.window(), velocity, scratch);
        Kokkos::parallel_for("treacle::enforce_wall_velocity", static_cast<int>(owned.size()),
            TurnLoop{grid, owned, faces, solids.sampler(), solids.number(), solids.motion(),
                FaceSampler(grid, halo.window(), scratch), condition, velocity});
    }
    gather_faces(grid, halo, velocity);
}

namespace {
void find_changes(int axis, int n, const Extrapolated& with, const Array<int>& known, const Array<double>& velocity) {
    const auto start = with.start.axis[axis], change = with.change.axis[axis];
    const auto extrapolated = with.extrapolated.axis[axis];
    Kokkos::parallel_for(
        "treacle::find_changes", n, KOKKOS_LAMBDA(int i) {
            change(i) = known(i) != 0 ? velocity(i) - start(i) : 0.0;
            extrapolated(i) = known(i);
        });
}

void add_changes(int axis, const PressureFaces& faces, const Extrapolated& with, const Array<int>& known,
    const Array<double>& velocity) {
    const auto start = with.start.axis[axis], mass = with.mass.axis[axis], change = with.change.axis[axis];
    const auto extrapolated = with.extrapolated.axis[axis];
    Kokkos::parallel_for(
        "treacle::add_changes", static_cast<int>(faces.window.size()), KOKKOS_LAMBDA(int i) {
            const bool in_air = faces.carries(axis, static_cast<std::size_t>(i));
            if (known(i) != 0 || extrapolated(i) == 0 || !(mass(i) > 0) || !in_air) return;
            velocity(i) = start(i) + change(i);
            known(i) = 1;
        });
}
} // namespace

void extrapolate_increment(
    const FaceScene& scene, const Extrapolated& with, FaceValidity& known, const FaceField& velocity) {
    const auto& [grid, halo, faces] = scene;
    const int n = static_cast<int>(halo.window().size());
    reserve_faces(with.change, grid, halo.window());
    for (int a = 0; a < grid.dimensions; ++a) {
        reserve(with.extrapolated.axis[a], static_cast<std::size_t>(n));
        find_changes(a, n, with, known.axis[a], velocity.axis[a]);
    }
    extrapolate(grid, halo, with.change, with.extrapolated, 2);
    for (int a = 0; a < grid.dimensions; ++a) add_changes(a, faces, with, known.axis[a], velocity.axis[a]);
}

} // namespace treacle::grid
