#include "grid/rheology/rheology.hpp"

#include "grid/pressure/resting_solids.hpp"
#include "grid/transport/apic.hpp"

#include <algorithm>

namespace treacle::grid {

namespace {
int first_edge(int dimensions) { return dimensions == 2 ? 2 : 0; }

// The part of a window that is some layers away from its border.
CellBox within(CellBox window, int layers, int dimensions) {
    for (int k = 0; k < dimensions; ++k) {
        window.lo[k] += layers;
        window.hi[k] -= layers;
    }
    return window;
}

// v = W_F u + sum_b W_S R V of the faces across one axis.
struct MeanVelocityLoop {
    Array<double> u, fluid, out;
    BodyFractions body_fractions; // without rows where no body moves
    BodyMotion motion;
    MacGrid grid;
    CellBox window, box;
    int axis;
    double carried;

    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int c[3];
        box.cell(n, c);
        const int i = window.index(c[0], c[1], c[2]);
        double sum = fluid(i) * u(i);
        const bool bodies = body_fractions.first.extent(0) > 0;
        for (int k = bodies ? body_fractions.first(i) : 0; bodies && k < body_fractions.first(i + 1); ++k) {
            double x[3], r[3];
            grid.face(axis, c, x);
            motion.arm(body_fractions.body(k), x, r);
            const int b = body_fractions.body(k);
            sum += body_fractions.fraction(k) * (motion.rigid_velocity(b, axis, r) - carried * motion.bend(b, axis, r));
        }
        out(i) = sum;
    }
};

// Strains at their own places, and what they make where others are.
struct Strains {
    CellBox window;
    std::ptrdiff_t stride[3]{1, 1, 1};
    int dimensions;
    double dx, min_liquid_fraction, min_fluid_fraction;
    FaceField v;
    Array<double> normal[3], cell_liquid_clipped, cell_fluid;
    EdgeField shear, edge_liquid_clipped, edge_fluid;
    Array<double> step_normal[3]; // of (S)
    EdgeField step_shear;
    double carried;

    // The liquid of a place, where it has a stress.
    KOKKOS_INLINE_FUNCTION double weight(const Array<double>& wet, const Array<double>& fluid, std::ptrdiff_t i) const {
        return wet(i) > min_liquid_fraction && fluid(i) >= min_fluid_fraction ? wet(i) : 0.0;
    }
    KOKKOS_INLINE_FUNCTION double carried_rate(const Array<double>& of, std::ptrdiff_t i) const {
        return carried > 0 ? carried * of(i) : 0.0;
    }
    KOKKOS_INLINE_FUNCTION void strain(std::ptrdiff_t i) const {
        for (int a = 0; a < dimensions; ++a) {
            const bool strains = weight(cell_liquid_clipped, cell_fluid, i) > 0;
            normal[a](i) =
                strains
                    ? ((v.axis[a](i + stride[a]) - v.axis[a](i)) / dx + carried_rate(step_normal[a], i)) / cell_fluid(i)
                    : 0.0;
        }
        for (int e = dimensions == 2 ? 2 : 0; e < 3; ++e) {
            const int a = (e + 1) % 3, b = (e + 2) % 3;
            const auto& fluid = edge_fluid.axis[e];
            const bool strains = weight(edge_liquid_clipped.axis[e], fluid, i) > 0;
            const double rise = v.axis[a](i) - v.axis[a](i - stride[b]) + v.axis[b](i) - v.axis[b](i - stride[a]);
            shear.axis[e](i) = strains ? (rise / dx + carried_rate(step_shear.axis[e], i)) / fluid(i) : 0.0;
        }
    }
    // The mean of a strain at i and, from there, s, t and s + t.
    KOKKOS_INLINE_FUNCTION double mean(const Array<double>& strains, const Array<double>& wet,
        const Array<double>& fluid, std::ptrdiff_t i, std::ptrdiff_t s, std::ptrdiff_t t) const {
        double sum = 0, weights = 0;
        for (int corner = 0; corner < 4; ++corner) {
            const auto j = i + (corner & 1 ? s : 0) + (corner & 2 ? t : 0);
            const double w = weight(wet, fluid, j);
            sum += w * strains(j);
            weights += w;
        }
        return weights > 0 ? sum / weights : 0.0;
    }
    KOKKOS_INLINE_FUNCTION double rate_at_centre(std::ptrdiff_t i) const {
        if (!(weight(cell_liquid_clipped, cell_fluid, i) > 0)) return 0;
        double square = 0;
        for (int a = 0; a < dimensions; ++a) square += 2 * normal[a](i) * normal[a](i);
        for (int e = dimensions == 2 ? 2 : 0; e < 3; ++e) {
            const double g = mean(shear.axis[e], edge_liquid_clipped.axis[e], edge_fluid.axis[e], i,
                stride[(e + 1) % 3], stride[(e + 2) % 3]);
            square += g * g;
        }
        return math::sqrt(square);
    }
    KOKKOS_INLINE_FUNCTION double rate_at_edge(int e, std::ptrdiff_t i) const {
        if (!(weight(edge_liquid_clipped.axis[e], edge_fluid.axis[e], i) > 0)) return 0;
        const int a = (e + 1) % 3, b = (e + 2) % 3;
        double square = shear.axis[e](i) * shear.axis[e](i);
        for (int k = 0; k < dimensions; ++k) {
            const double d = mean(normal[k], cell_liquid_clipped, cell_fluid, i, -stride[a], -stride[b]);
            square += 2 * d * d;
        }
        for (int f = 0; f < 3 && dimensions == 3; ++f) {
            if (f == e) continue;
            const double g =
                mean(shear.axis[f], edge_liquid_clipped.axis[f], edge_fluid.axis[f], i, -stride[f], stride[e]);
            square += g * g;
        }
        return math::sqrt(square);
    }
};

void find_mean_velocities(const StrainContext& scene, const FaceField& velocity, FaceField& out) {
    const CellBox window = scene.halo.window(), box = within(window, 1, scene.grid.dimensions);
    for (int a = 0; a < scene.grid.dimensions; ++a) {
        reserve(out.axis[a], static_cast<std::size_t>(window.size()));
        Kokkos::parallel_for("treacle::mean_velocities", static_cast<int>(box.size()),
            MeanVelocityLoop{velocity.axis[a], scene.no_slip_fractions.face_fluid.axis[a], out.axis[a],
                scene.body_fractions[static_cast<std::size_t>(a)], scene.motion, scene.grid, window, box, a,
                scene.carried});
        if (scene.resting) scene.resting->add_velocities(a, window, {}, out.axis[a]);
    }
}

void find_strains(const Strains& strains, const CellBox& box) {
    Kokkos::parallel_for(
        "treacle::strains", static_cast<int>(box.size()), KOKKOS_LAMBDA(int n) {
            int c[3];
            box.cell(n, c);
            strains.strain(strains.window.index(c[0], c[1], c[2]));
        });
}

void combine_strains(
    const Strains& strains, const CellBox& owned, const Array<double>& centres, const EdgeField& edges) {
    Kokkos::parallel_for(
        "treacle::shear_rates", static_cast<int>(owned.size()), KOKKOS_LAMBDA(int n) {
            int c[3];
            owned.cell(n, c);
            const int i = strains.window.index(c[0], c[1], c[2]);
            centres(i) = strains.rate_at_centre(i);
            for (int e = strains.dimensions == 2 ? 2 : 0; e < 3; ++e) edges.axis[e](i) = strains.rate_at_edge(e, i);
        });
}

// sum += mass / viscosity, total += mass.
void add_by_rate(const flow::ViscosityModel& curve, int n, const Array<double>& mass, const Array<double>& rate,
    const Array<double>& sum, const Array<double>& total) {
    Kokkos::parallel_for(
        "treacle::viscosity_by_rate", n, KOKKOS_LAMBDA(int i) {
            if (!(mass(i) > 0)) return;
            sum(i) += mass(i) * fluidity_of(curve(rate(i)));
            total(i) += mass(i);
        });
}

void add(
    int n, const Array<double>& mass, const Array<double>& sums, const Array<double>& sum, const Array<double>& total) {
    Kokkos::parallel_for(
        "treacle::add_fluidity", n, KOKKOS_LAMBDA(int i) {
            sum(i) += sums(i);
            total(i) += mass(i);
        });
}

void invert(int n, const Array<double>& sums, const Array<double>& mass) {
    Kokkos::parallel_for(
        "treacle::invert_fluidity", n, KOKKOS_LAMBDA(int i) { sums(i) = harmonic_viscosity(mass(i), sums(i)); });
}

// Copies `all`, per liquid, where `use`; zero elsewhere.
template <class Use>
void select(const Array<double>& all, const Array<double>& some, const Use& use) {
    const auto from = on_host(all);
    auto host = Kokkos::create_mirror_view(some);
    for (std::size_t l = 0; l < some.extent(0); ++l) host(l) = use(l) ? from(l) : 0.0;
    Kokkos::deep_copy(some, host);
}

void show(const flow::ViscosityModel& curve, int liquid, const CellGrid& grid, const CellBox& window,
    const Array<double>& rate, const GridParticles& particles) {
    const auto x = particles.position();
    const auto which = particles.liquid();
    const auto viscosity = particles.viscosity();
    Kokkos::parallel_for(
        "treacle::show_viscosity", particles.store.owned(), KOKKOS_LAMBDA(int k) {
            if (which(k) != liquid) return;
            int c[3];
            grid.locate(x(k, 0), x(k, 1), x(k, 2), c);
            viscosity(k) = curve(rate(window.index(c[0], c[1], c[2])));
        });
}
} // namespace

Rheology::Rheology(std::vector<flow::ViscosityModel> curves) : curves_(std::move(curves)) {
    const auto newtonian = [](const flow::ViscosityModel& curve) {
        return curve.law == scene::ViscosityModelKind::newtonian;
    };
    any_ = !std::ranges::all_of(curves_, newtonian);
    any_newtonian_ = std::ranges::any_of(curves_, newtonian);
    some_mass_ = Array<double>("treacle::particle_mass_of_one", curves_.size());
}

void Rheology::compute_rates(const StrainContext& scene, const FaceField& velocity) {
    const CellBox window = scene.halo.window();
    const int dimensions = scene.grid.dimensions;
    const auto n = static_cast<std::size_t>(window.size());
    reserve(cell_rate_, n);
    Kokkos::deep_copy(cell_rate_, 0.0);
    for (int e = first_edge(dimensions); e < 3; ++e) {
        reserve(shear_.axis[e], n);
        reserve(edge_rate_.axis[e], n);
        Kokkos::deep_copy(edge_rate_.axis[e], 0.0);
    }
    for (int a = 0; a < dimensions; ++a) reserve(normal_[a], n);
    if (scene.halo.owned().empty()) return;
    find_mean_velocities(scene, velocity, mean_velocity_);
    Strains strains;
    strains.window = window;
    for (int k = 1; k < 3; ++k) strains.stride[k] = strains.stride[k - 1] * (window.hi[k - 1] - window.lo[k - 1]);
    strains.dimensions = dimensions;
    strains.dx = scene.grid.dx;
    strains.min_liquid_fraction = scene.options.min_liquid_fraction;
    strains.min_fluid_fraction = scene.options.min_fluid_fraction;
    strains.v = mean_velocity_;
    for (int k = 0; k < 3; ++k) strains.normal[k] = normal_[k];
    strains.shear = shear_;
    strains.cell_liquid_clipped = scene.fractions.cell_liquid_clipped;
    strains.cell_fluid = scene.no_slip_fractions.cell_fluid;
    strains.edge_liquid_clipped = scene.fractions.edge_liquid_clipped;
    strains.edge_fluid = scene.no_slip_fractions.edge_fluid;
    strains.carried = scene.strains ? scene.carried : 0.0;
    for (int k = 0; k < 3 && scene.strains; ++k) strains.step_normal[k] = scene.strains->normal(k);
    if (scene.strains) strains.step_shear = scene.strains->shear();
    find_strains(strains, within(window, 2, dimensions));
    combine_strains(strains, scene.halo.owned(), cell_rate_, edge_rate_);
}

// Mean over the places of one kind, numbered as in apic.hpp.
void Rheology::mean(
    const StrainContext& scene, const LiquidScene& liquids, int node, const Array<double>& rate, Array<double>& out) {
    const CellBox window = scene.halo.window();
    const auto window_size = static_cast<std::size_t>(window.size());
    const int n = static_cast<int>(window.size());
    for (auto* array : {&out, &total_}) {
        reserve(*array, window_size);
        Kokkos::deep_copy(*array, 0.0);
    }
    const auto gather_one = [&](const auto& use) {
        select(liquids.particle_mass, some_mass_, use);
        fluidity_sums(scene.grid, {liquids.particles, liquids.cells, some_mass_}, window, node, {mass_, sums_});
    };
    if (any_newtonian_) {
        gather_one([&](std::size_t l) { return curves_[l].law == scene::ViscosityModelKind::newtonian; });
        add(n, mass_, sums_, out, total_);
    }
    for (std::size_t l = 0; l < curves_.size(); ++l) {
        if (curves_[l].law == scene::ViscosityModelKind::newtonian) continue;
        gather_one([&](std::size_t other) { return other == l; });
        add_by_rate(curves_[l], n, mass_, rate, out, total_);
    }
    invert(n, out, total_);
}

void Rheology::find_viscosities(const StrainContext& scene, const LiquidScene& liquids, Viscosities& out) {
    mean(scene, liquids, 0, cell_rate_, out.cell);
    for (int e = first_edge(scene.grid.dimensions); e < 3; ++e) {
        mean(scene, liquids, (scene.grid.dimensions == 2 ? 3 : 7) & ~(1 << e), edge_rate_.axis[e], out.edge.axis[e]);
    }
    auto& edge = out.edge.axis;
    if (scene.grid.dimensions == 2) {
        scene.halo.gather({out.cell, edge[2]});
    } else {
        scene.halo.gather({out.cell, edge[0], edge[1], edge[2]});
    }
}

void Rheology::to_particles(const StrainContext& scene, const GridParticles& particles) const {
    for (std::size_t l = 0; l < curves_.size(); ++l) {
        if (curves_[l].law == scene::ViscosityModelKind::newtonian) continue;
        show(curves_[l], static_cast<int>(l), scene.grid.cells, scene.halo.window(), cell_rate_, particles);
    }
}

std::size_t Rheology::bytes() const {
    std::size_t numbers = cell_rate_.span() + mass_.span() + sums_.span() + total_.span();
    for (int a = 0; a < 3; ++a) {
        numbers +=
            mean_velocity_.axis[a].span() + normal_[a].span() + shear_.axis[a].span() + edge_rate_.axis[a].span();
    }
    return sizeof(double) * numbers;
}

} // namespace treacle::grid
