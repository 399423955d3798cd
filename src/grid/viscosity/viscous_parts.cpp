#include "grid/viscosity/viscous_parts.hpp"

#include "grid/pressure/resting_solids.hpp"
#include "grid/viscosity/step_strains.hpp"

namespace treacle::grid {

namespace {
constexpr double aligned =
    1 - 1e-8; // cosine between the normal of a surface and an axis from which it is along the faces

// By how much more a place a cell along the best of the axes lies within a plane wall, at least, in 2D and in 3D [cells]:
// cos 45 degrees and 1/sqrt(3), less what walls of three cells radius lack.
constexpr double plane_deepening[2] = {0.6, 0.45};

// w = K wet / W_F^2 dx^3 / dx^2 of one stress; 0 where there is no liquid, or no room for it to slide.
struct StressLoop {
    Array<double> viscosity, wet, fluid, out;
    double factor, min_liquid_fraction, min_fluid_fraction; // factor: K / eta dx, of a 2D scene K / eta

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const bool strains = wet(i) > min_liquid_fraction && fluid(i) >= min_fluid_fraction;
        out(i) = strains ? factor * viscosity(i) * wet(i) / (fluid(i) * fluid(i)) : 0.0;
    }
};

// The inner part of a window, where places have all neighbours.
struct Inner {
    CellBox window, box;
    Inner(const CellBox& w, int dimensions, int layers = 1) : window(w), box(w) {
        for (int k = 0; k < dimensions; ++k) {
            box.lo[k] += layers;
            box.hi[k] -= layers;
        }
    }
    int count() const { return static_cast<int>(box.size()); }
    KOKKOS_INLINE_FUNCTION std::ptrdiff_t index(int n, int c[3]) const {
        box.cell(n, c);
        return window.index(c[0], c[1], c[2]);
    }
};

struct RoleLoop {
    ViscousFaces faces;
    Inner inner;
    int axis;
    Array<double> wet, fluid, cell_fluid;
    EdgeField edge_fluid;
    double min_liquid_fraction, min_fluid_fraction, mass;
    PressureFaces pressure_faces;
    bool with_pressure;
    DistanceSampler no_slip;

    // True where the middle of the face is in a solid that is no plane wall there: it has an edge, or is thin.
    KOKKOS_INLINE_FUNCTION bool is_in_edge(const int c[3]) const {
        if (no_slip.values.extent(0) == 0) return false;
        const auto& nodes = no_slip.nodes;
        const double here = no_slip.values(nodes.face_middle(axis, c));
        if (!nodes.is_inside(here)) return false;
        double deepest = here;
        for (int k = 0; k < nodes.dimensions; ++k) {
            for (int way = -1; way <= 1; way += 2) {
                int beside[3] = {c[0], c[1], c[2]};
                beside[k] += way;
                deepest = math::min(deepest, no_slip.values(nodes.face_middle(axis, beside)));
            }
        }
        return here - deepest < plane_deepening[nodes.dimensions - 2] * 2 * nodes.width;
    }

    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int c[3];
        const auto i = inner.index(n, c);
        const double push =
            with_pressure ? pressure_faces.effective_area_fraction(axis, static_cast<std::size_t>(i)) : -1;
        bool stressed = false, tight = false;
        faces.each_stress(axis, i, faces.normal, faces.shear, [&](double w) { stressed = stressed || w > 0; });
        faces.each_stress(axis, i, cell_fluid, edge_fluid, [&](double f) { tight = tight || f < min_fluid_fraction; });
        const bool has_liquid = wet(i) > min_liquid_fraction;
        int role = inactive_face;
        if (has_liquid || stressed || push > 0)
            role = fluid(i) < min_fluid_fraction || tight || is_in_edge(c) ? prescribed_face : unknown_face;
        const double solid = 1 - fluid(i);
        faces.role[axis](i) = role;
        faces.fraction.axis[axis](i) = role == unknown_face ? fluid(i) : 0.0;
        faces.scale.axis[axis](i) = role == unknown_face || !(solid > min_liquid_fraction) ? 1.0 : 1 / solid;
        const bool by_pressure = role == unknown_face && ((push > 0 && !has_liquid) || (push == 0 && stressed));
        faces.mass.axis[axis](i) = mass * (by_pressure ? push : wet(i));
    }
};

struct SolidLoop {
    ViscousFaces faces;
    Inner inner;
    int axis;
    BodyFractions body_fractions;
    BodyMotion motion;
    MacGrid grid;

    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int c[3];
        const auto i = inner.index(n, c);
        double sum = 0, bend = 0;
        for (int k = body_fractions.first(i); k < body_fractions.first(i + 1); ++k) {
            double x[3], r[3];
            grid.face(axis, c, x);
            motion.arm(body_fractions.body(k), x, r);
            sum += body_fractions.fraction(k) * motion.velocity(body_fractions.body(k), axis, r);
            bend += body_fractions.fraction(k) * motion.bend(body_fractions.body(k), axis, r);
        }
        faces.solid.axis[axis](i) = faces.scale.axis[axis](i) * sum;
        faces.bend.axis[axis](i) = faces.scale.axis[axis](i) * bend;
    }
};

struct WallLoop {
    ViscousFaces faces;
    Inner inner;
    BodyMotion motion, sides;
    MacGrid grid;

    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int c[3];
        const auto i = inner.index(n, c);
        const int body = faces.slip_body(i);
        for (int k = 0; k < faces.dimensions; ++k) {
            double x[3], r[3];
            faces.wall[k](i) = faces.wall_bend[k](i) = body < 0 && body >= -6 ? sides.side[-1 - body][k] : 0.0;
            if (body < 0) continue;
            faces.slip_point(grid, k, c, x);
            motion.arm(body, x, r);
            faces.wall[k](i) = motion.rigid_velocity(body, k, r);
        }
    }
};

// Tractions of slip surfaces, whose areas are the divergence of the open areas of a cell's faces.
// Along a surface: in the cell that has it where its centre is not in the solid, otherwise in the next one; velocities at the
// cell's centre, a distance from the surface that adds to the slip length.
// Across a surface along the faces, of a side of the domain or a body: in the cell that has it, at the surface, where the
// velocity is that between two faces. The face behind it is closed and has no flux, so that pressures leave it free: without
// this traction the liquid in front of it is not strained, and bears nothing. Across others, whose flux the pressures have: as
// along them, where there are no pressures. At curved ones both together resist rotation.
struct TractionLoop {
    ViscousFaces faces;
    Inner inner;
    FaceField open;
    Array<double> wet, fluid, viscosity;
    Array<double> distance; // none: no pressure
    SlipSolids slip;
    MacGrid grid;
    double area, min_liquid_fraction, no_penetration_layer; // [m2], of a 2D scene [m]; [1]; [m]

    // Out of the solid, in faces' areas.
    KOKKOS_INLINE_FUNCTION double surface(std::ptrdiff_t i, double n[3]) const {
        for (int k = 0; k < faces.dimensions; ++k) {
            const auto j = i + faces.stride[k];
            n[k] = (open.axis[k](j) - open.axis[k](i)) -
                   (slip.no_slip_fractions.open.axis[k](j) - slip.no_slip_fractions.open.axis[k](i));
        }
        return size_of(n);
    }
    KOKKOS_INLINE_FUNCTION double size_of(const double n[3]) const {
        double squares = 0;
        for (int k = 0; k < faces.dimensions; ++k) squares += n[k] * n[k];
        return math::sqrt(squares);
    }
    // Adds across n nT + along (1 - n nT), 1/m each, times the area.
    KOKKOS_INLINE_FUNCTION void add(
        std::ptrdiff_t i, const double n[3], double size, double across, double along) const {
        const double whole = area * size * viscosity(i) * wet(i) / fluid(i);
        for (int k = 0; k < faces.dimensions; ++k) {
            for (int l = k; l < faces.dimensions; ++l) {
                const double nn = n[k] * n[l] / (size * size);
                faces.traction[ViscousFaces::component(k, l)](i) +=
                    whole * (across * nn + along * ((k == l ? 1.0 : 0.0) - nn));
            }
        }
    }
    KOKKOS_INLINE_FUNCTION double along(std::ptrdiff_t i, double beyond) const {
        return 1 / (math::max(slip.length(i), no_penetration_layer) + beyond);
    }
    // A surface of that size along the faces across axis k, so many widths above the lower one.
    KOKKOS_INLINE_FUNCTION void constrain(std::ptrdiff_t i, int k, double at, double size) const {
        double normal[3] = {0, 0, 0};
        normal[k] = 1;
        faces.slip_interpolation_weight.axis[k](i) = 1 - math::min(1.0, math::max(0.0, at));
        add(i, normal, size, 1 / no_penetration_layer, 0);
    }
    // Takes what is along the faces, cell c's, off its areas n; `constrains`: with its traction.
    KOKKOS_INLINE_FUNCTION void take_sides(std::ptrdiff_t i, const int c[3], bool constrains, double n[3]) const {
        for (int k = 0; k < faces.dimensions; ++k) {
            double x[3];
            grid.face(k, c, x);
            for (int side = 0; side < 2; ++side) {
                if (!slip.slides[2 * k + side]) continue;
                const double at = (slip.side[2 * k + side] - x[k]) / grid.dx, thickness = side == 0 ? 1 - at : at;
                if (!(thickness > min_liquid_fraction) || !(thickness < 1 + min_liquid_fraction)) continue;
                const double size = open.axis[k](side == 0 ? i + faces.stride[k] : i);
                n[k] -= side == 0 ? size : -size;
                if (constrains && size > 0) constrain(i, k, at, size);
            }
        }
        const double size = size_of(n);
        for (int k = 0; k < faces.dimensions; ++k) {
            if (!(size > min_liquid_fraction) || !(math::fabs(n[k]) > aligned * size)) continue;
            if (constrains) constrain(i, k, 0.5 - (n[k] > 0 ? 1 : -1) * slip.distance(i) / grid.dx, math::fabs(n[k]));
            n[k] = 0;
        }
    }
    // True for cell i or the one beside it that the areas n lead to most.
    KOKKOS_INLINE_FUNCTION bool has_pressure(std::ptrdiff_t i, const double n[3]) const {
        if (distance.extent(0) == 0) return false;
        int k = 0;
        for (int l = 1; l < faces.dimensions; ++l) k = n[l] * n[l] > n[k] * n[k] ? l : k;
        return distance(i) < 0 || distance(i + (n[k] < 0 ? -faces.stride[k] : faces.stride[k])) < 0;
    }
    // Across what is left of the areas. A cell without a pressure below one that has it is a hole in the liquid, not a film: held at
    // its centre, off the surface, the liquid would turn by as much as it flows into the hole.
    KOKKOS_INLINE_FUNCTION void resist_rest(std::ptrdiff_t i, const double n[3]) const {
        const double size = size_of(n);
        if (size > min_liquid_fraction && !has_pressure(i, n)) add(i, n, size, 1 / no_penetration_layer, 0);
    }
    KOKKOS_INLINE_FUNCTION void operator()(int at) const {
        int c[3];
        const auto i = inner.index(at, c);
        for (int k = 0; k < 6; ++k) faces.traction[k](i) = 0;
        if (!(wet(i) > min_liquid_fraction)) return;
        const bool carries = fluid(i) >= 0.5;
        double n[3] = {0, 0, 0};
        double size = surface(i, n);
        if (size > 0 && carries) add(i, n, size, 0, along(i, (fluid(i) - 0.5) * grid.dx));
        take_sides(i, c, true, n);
        if (!carries) return;
        resist_rest(i, n);
        for (int k = 0; k < faces.dimensions; ++k) {
            for (int side = -1; side <= 1; side += 2) {
                const auto j = i - side * faces.stride[k];
                if (!(fluid(j) < 0.5)) continue;
                size = surface(j, n);
                bool here = size > 0 && side * n[k] > 0; // along its largest component, the first of equal ones
                for (int l = 0; l < faces.dimensions; ++l) {
                    here = here && (l > k ? n[l] * n[l] <= n[k] * n[k] : l == k || n[l] * n[l] < n[k] * n[k]);
                }
                if (!here) continue;
                add(i, n, size, 0, along(i, (fluid(j) + 0.5) * grid.dx));
                int of[3] = {c[0], c[1], c[2]};
                of[k] -= side;
                take_sides(j, of, false, n);
                resist_rest(i, n);
            }
        }
    }
};

struct SlipWeightLoop {
    Array<double> wet, out;
    std::ptrdiff_t stride;
    Inner inner;

    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int c[3];
        const auto i = inner.index(n, c);
        const double lower = wet(i), upper = wet(i + stride);
        out(i) = lower + upper > 0 ? lower / (lower + upper) : 0.5;
    }
};

void make_room(const Array<double>& like, std::initializer_list<Array<double>*> arrays) {
    for (auto* array : arrays) {
        if (array->extent(0) >= like.extent(0)) continue;
        reserve(*array, like.extent(0));
        Kokkos::deep_copy(*array, 0.0); // the outermost places are never written
    }
}
} // namespace

void ViscousParts::weigh_stresses(const ViscousScene& scene, const ViscosityOptions& options) {
    const auto& f = scene.fractions;
    const auto& no_slip_fractions = scene.slip ? scene.slip->no_slip_fractions : f;
    const int n = static_cast<int>(faces_.window.size());
    const double length = scene.grid.dimensions == 3 ? scene.grid.dx : 1.0;
    const auto weigh = [&](const Array<double>& viscosity, const Array<double>& wet, const Array<double>& fluid,
                           double k, Array<double>& out) {
        make_room(f.cell_liquid_clipped, {&out});
        Kokkos::parallel_for("treacle::weigh_stresses", n,
            StressLoop{
                viscosity, wet, fluid, out, k * length, options.min_liquid_fraction, options.min_fluid_fraction});
    };
    weigh(scene.viscosity.cell, f.cell_liquid_clipped, no_slip_fractions.cell_fluid, 2, faces_.normal);
    for (int e = scene.grid.dimensions == 3 ? 0 : 2; e < 3; ++e) {
        weigh(scene.viscosity.edge.axis[e], f.edge_liquid_clipped.axis[e], no_slip_fractions.edge_fluid.axis[e], 1,
            faces_.shear.axis[e]);
    }
}

void ViscousParts::weigh_slip(const ViscousScene& scene, const ViscosityOptions& options) {
    faces_.slips = scene.slip != nullptr;
    if (!faces_.slips) return;
    const auto& f = scene.fractions;
    const Inner inner(faces_.window, faces_.dimensions);
    faces_.slip_body = scene.slip->body;
    for (auto& component : faces_.traction) make_room(f.cell_liquid_clipped, {&component});
    for (auto& component : faces_.wall) make_room(f.cell_liquid_clipped, {&component});
    for (auto& component : faces_.wall_bend) make_room(f.cell_liquid_clipped, {&component});
    const double dx = scene.grid.dx;
    const Inner second(faces_.window, faces_.dimensions, 2); // the neighbours' neighbours are read
    for (int a = 0; a < faces_.dimensions; ++a) {
        make_room(f.cell_liquid_clipped, {&faces_.slip_interpolation_weight.axis[a]});
        Kokkos::parallel_for("treacle::lean_slip", inner.count(),
            SlipWeightLoop{
                f.face_liquid_clipped.axis[a], faces_.slip_interpolation_weight.axis[a], faces_.stride[a], inner});
    }
    Kokkos::parallel_for("treacle::weigh_slip", second.count(),
        TractionLoop{faces_, second, f.open, f.cell_liquid_clipped, f.cell_fluid, scene.viscosity.cell,
            scene.distance ? *scene.distance : Array<double>(), *scene.slip, scene.grid,
            faces_.dimensions == 3 ? dx * dx : dx, options.min_liquid_fraction, options.no_penetration_layer * dx});
}

void ViscousParts::classify_faces(const ViscousScene& scene, const ViscosityOptions& options, double dt) {
    const auto& f = scene.fractions;
    const auto& no_slip_fractions = scene.slip ? scene.slip->no_slip_fractions : f;
    const Inner inner(faces_.window, faces_.dimensions);
    for (int a = 0; a < faces_.dimensions; ++a) {
        make_room(f.cell_liquid_clipped, {&faces_.fraction.axis[a], &faces_.scale.axis[a], &faces_.mass.axis[a],
                                             &faces_.solid.axis[a], &faces_.bend.axis[a]});
        if (faces_.role[a].extent(0) < f.cell_liquid_clipped.extent(0)) {
            reserve(faces_.role[a], f.cell_liquid_clipped.extent(0));
            Kokkos::deep_copy(faces_.role[a], int(inactive_face));
        }
        Kokkos::parallel_for("treacle::classify_faces", inner.count(),
            RoleLoop{faces_, inner, a, f.face_liquid_clipped.axis[a], no_slip_fractions.face_fluid.axis[a],
                no_slip_fractions.cell_fluid, no_slip_fractions.edge_fluid, options.min_liquid_fraction,
                options.min_fluid_fraction, scene.density * cube_volume(scene.grid) / dt,
                scene.pressure_faces ? *scene.pressure_faces : PressureFaces(), scene.pressure_faces != nullptr,
                scene.no_slip});
    }
}

void ViscousParts::move_solids(const ViscousScene& scene, const BodyMotion& motion) {
    const Inner inner(faces_.window, faces_.dimensions);
    const bool sides = scene.resting && scene.resting->any_moves();
    if (faces_.slips && (motion.bodies > 0 || sides)) {
        Kokkos::parallel_for("treacle::move_slip_surfaces", inner.count(),
            WallLoop{faces_, inner, motion, sides ? scene.resting->motion() : BodyMotion(), scene.grid});
    }
    for (int a = 0; a < faces_.dimensions; ++a) {
        if (motion.bodies == 0) {
            Kokkos::deep_copy(faces_.solid.axis[a], 0.0);
            Kokkos::deep_copy(faces_.bend.axis[a], 0.0);
        } else {
            Kokkos::parallel_for("treacle::move_solids", inner.count(),
                SolidLoop{faces_, inner, a, scene.body_fractions[static_cast<std::size_t>(a)], motion, scene.grid});
        }
        if (!sides) continue;
        for (const auto& out : {faces_.solid.axis[a], faces_.bend.axis[a]}) {
            scene.resting->add_velocities(a, faces_.window, faces_.scale.axis[a], out);
        }
    }
}

void ViscousParts::build(
    const ViscousScene& scene, const ViscosityOptions& options, const BodyMotion& motion, double dt) {
    faces_.window = scene.halo.window();
    faces_.dimensions = scene.grid.dimensions;
    for (int k = 1; k < 3; ++k) {
        faces_.stride[k] = faces_.stride[k - 1] * (faces_.window.hi[k - 1] - faces_.window.lo[k - 1]);
    }
    faces_.dx = scene.grid.dx;
    faces_.strained = scene.strains != nullptr;
    if (scene.strains) {
        for (int a = 0; a < 3; ++a) faces_.strain[a] = scene.strains->normal(a);
        faces_.shear_strain = scene.strains->shear();
    }
    faces_.volumes = scene.volumes ? *scene.volumes : VolumeStiffness();
    if (faces_.window.empty()) return;
    weigh_stresses(scene, options);
    weigh_slip(scene, options);
    classify_faces(scene, options, dt);
    move_solids(scene, motion);
}

std::size_t ViscousParts::bytes() const {
    std::size_t total = faces_.normal.span();
    for (int a = 0; a < 3; ++a) {
        total += faces_.shear.axis[a].span();
        for (const auto* field : {&faces_.fraction, &faces_.scale, &faces_.mass, &faces_.solid, &faces_.bend,
                 &faces_.slip_interpolation_weight}) {
            total += field->axis[a].span();
        }
    }
    for (const auto& component : faces_.traction) total += component.span();
    for (int a = 0; a < 3; ++a) total += faces_.wall[a].span() + faces_.wall_bend[a].span();
    return 8 * total + 4 * (faces_.role[0].span() + faces_.role[1].span() + faces_.role[2].span());
}

} // namespace treacle::grid
