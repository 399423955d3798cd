#include "sph/viscosity/operator/viscous_interface.hpp"

#include "sph/viscosity/operator/viscous_prepare.hpp"

// The rows beside interfaces. The loops of all particles have gone through them as if there were none: what they wrote there is
// written anew.
namespace treacle::sph {

namespace {
// An interface is there where the neighbours of another viscosity lie on one side, by that share of the sum of their distances, and
// those of the own one, as they count, spread in all directions by that share of the lattice's spread. Of a thread, a sheet, a single
// particle or a blend the stress is that of one liquid.
constexpr double least_direction = 0.5, least_side = 0.2;

// Numbers the particles with neighbours of another viscosity.
int find_rows(const Pairs& pairs, const ViscousContrast& contrast, int n, const Array<int>& rows) {
    int count = 0;
    Kokkos::parallel_scan(
        "treacle::interface_rows", n,
        KOKKOS_LAMBDA(int i, int& sum, bool last) {
            bool mixed = false;
            for (std::int64_t k = pairs.offset(i); k < pairs.offset(i + 1) && !mixed; ++k)
                mixed = contrast(i, pairs.index(k)) != 0;
            if (mixed && last) rows(sum) = i;
            sum += mixed ? 1 : 0;
        },
        count);
    return count;
}

// Shapes, and B^+ where there is an interface.
template <class Kernel>
struct InterfaceShapeLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    ViscousContrast contrast;
    Array<int> rows;
    InterfaceShapes shapes;
    Array3 normal;
    Array6 correction;

    KOKKOS_INLINE_FUNCTION void operator()(int row) const {
        const int i = rows(row);
        InterfaceShape shape;
        weigh(i, shape);
        const Symmetric fit = truncated_pseudo_inverse(shape.spread, least_side), span = range_projector(fit);
        if (span.xx + span.yy + span.zz > Kernel::dimensions - 0.5) find_normal(i, shape);
        if (shape.has_normal()) {
            add_skew(i, shape);
            write_symmetric(fit, correction, i);
        }
        write_shape(shape, shapes, row);
        for (int k = 0; k < 3; ++k) normal(i, k) = shape.normal[k];
    }

private:
    KOKKOS_INLINE_FUNCTION void weigh(int i, InterfaceShape& out) const {
        Base::each_pair(i, [&](double w, int j, double dx, double dy, double dz, double) {
            const double h = contrast(i, j), weight = w * (1 + h);
            out.spread.add_square(weight, dx, dy, dz);
            out.squares.add_square(weight * excess_square(h), dx, dy, dz);
        });
        Base::each_wall(i,
            [&](int, double w, double dx, double dy, double dz, const auto&) { out.spread.add_square(w, dx, dy, dz); });
    }
    KOKKOS_INLINE_FUNCTION void find_normal(int i, InterfaceShape& shape) const {
        double sum[3] = {0, 0, 0}, most = 0;
        Base::each_pair(i, [&](double w, int j, double dx, double dy, double dz, double r2) {
            const double weight = w * contrast(i, j);
            sum[0] += weight * dx;
            sum[1] += weight * dy;
            sum[2] += weight * dz;
            most += math::fabs(weight) * math::sqrt(r2);
        });
        const double size = math::sqrt(inner(sum, sum));
        if (size <= least_direction * most) return;
        for (int k = 0; k < 3; ++k) shape.normal[k] = sum[k] / size;
    }
    KOKKOS_INLINE_FUNCTION void add_skew(int i, InterfaceShape& shape) const {
        Base::each_pair(i, [&](double w, int j, double dx, double dy, double dz, double) {
            const double h = contrast(i, j), x[3] = {dx, dy, dz};
            const double weight = w * (1 + h) * h * inner(shape.normal, x);
            for (int k = 0; k < 3; ++k) shape.skew[k] += weight * x[k];
        });
    }
};

// Diagonal blocks of the preconditioner, as in PrepareLoop::stress_block. Of a thicker neighbour's stress a particle
// gets the part that its own viscosity lets it have, where the interface is within the neighbour's support.
template <class Kernel>
struct InterfaceBlockLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    double damping;
    RelativeDensity relative;
    ViscousContrast contrast;
    bool slips;
    Array<double> drag;
    bool has_inlets;
    Array<int> inlet;
    Array<int> rows;
    Array3 normal;
    Array6 correction;
    ViscousOperator::Blocks block;
    Array<float> inertia_and_wall_diagonal, smoothed_viscous_coefficient;

    KOKKOS_INLINE_FUNCTION void operator()(int row) const {
        const int i = rows(row);
        Sums sums;
        add_pairs(i, sums);
        add_walls(i, sums);
        const double c = contrast.viscous_coefficient(i), inertia = relative(i) + (slips ? drag(i) : 0);
        const Symmetric fit = read_symmetric(correction, i);
        double own[3];
        fit.times(sums.pull, own);
        Symmetric d = enclosed(fit, sums.strained);
        const double both = d.xx + d.yy + d.zz + c * inner(own, own) + damping * sums.damped + inertia;
        d.add_square(c, own[0], own[1], own[2]);
        d.xx += both, d.yy += both, d.zz += both;
        write_symmetric(inverse(d), block, i);
        const bool prescribed = has_inlets && inlet(i) > 0;
        smoothed_viscous_coefficient(i) = static_cast<float>(0.5 * (c + sums.around / sums.weights));
        inertia_and_wall_diagonal(i) =
            static_cast<float>(prescribed ? (d.xx + d.yy + d.zz) / 3 : inertia + 2 * c * sums.wall_sum);
    }

private:
    struct Sums {
        Symmetric strained;
        double damped = 0, wall_sum = 0, around = 0, weights = 0, pull[3] = {0, 0, 0};
    };
    // The contrast in the stress of i.
    KOKKOS_INLINE_FUNCTION double seen(int i, double h) const {
        return h != 0 && is_normal(normal(i, 0), normal(i, 1), normal(i, 2)) ? h : 0;
    }
    KOKKOS_INLINE_FUNCTION void add_pairs(int i, Sums& to) const {
        const double c = contrast.viscous_coefficient(i);
        Base::each_pair(i, [&](double w, int j, double dx, double dy, double dz, double r2) {
            const double h = contrast(i, j), own = 1 + seen(i, h), back = 1 + seen(j, -h), x[3] = {dx, dy, dz};
            const double felt = back * back * contrast.viscous_coefficient(j);
            to.strained.add_square(w * w * felt, dx, dy, dz);
            to.damped += w * (c * own + contrast.viscous_coefficient(j) * back);
            to.around += w * r2 * felt;
            to.weights += w * r2;
            for (int k = 0; k < 3; ++k) to.pull[k] += w * own * x[k];
        });
    }
    KOKKOS_INLINE_FUNCTION void add_walls(int i, Sums& to) const {
        Base::each_wall(i, [&](int, double w, double dx, double dy, double dz, const auto& contact) {
            const double beta = contact.beta, x[3] = {dx, dy, dz};
            to.wall_sum += w * beta;
            to.damped += 2 * contrast.viscous_coefficient(i) * w * beta * beta;
            for (int k = 0; k < 3; ++k) to.pull[k] += w * beta * x[k];
        });
    }
};

// Columns of Q, for the products in double and in single precision.
KOKKOS_INLINE_FUNCTION void write_stress(const InterfaceStress& stress, const Stresses& to, int i) {
    for (int l = 0; l < 3; ++l) {
        for (int k = 0; k < 3; ++k) to.column[l](i, k) = stress.q[k][l];
    }
}
KOKKOS_INLINE_FUNCTION void write_stress(const InterfaceStress& stress, const TileStresses& to, int i) {
    for (int l = 0; l < 3; ++l) {
        for (int k = 0; k < 3; ++k) to.tiles(i, 4 * l + k) = static_cast<float>(stress.q[k][l]);
    }
}

struct InterfaceFields {
    Array3 velocity, normal, tilted, across[3]; // across: columns

    KOKKOS_INLINE_FUNCTION void read_difference(int i, int j, double u[3]) const {
        for (int k = 0; k < 3; ++k) u[k] = velocity(i, k) - velocity(j, k);
    }
};

// As StressLoop.
template <class Kernel, class Stress>
struct InterfaceStressLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    double damping;
    ViscousContrast contrast;
    Array<int> rows;
    InterfaceShapes shapes;
    Array6 correction;
    InterfaceFields fields;
    Stress stress;
    bool rated;
    Array<double> rate;

    KOKKOS_INLINE_FUNCTION void operator()(int row) const {
        const int i = rows(row);
        const InterfaceShape shape = read_shape(shapes, row);
        if (!shape.has_normal()) return; // the loop of all has its stress
        InterfaceSums sums;
        Base::each_pair(i, [&](double w, int j, double dx, double dy, double dz, double) {
            const double x[3] = {dx, dy, dz};
            double u[3];
            fields.read_difference(i, j, u);
            sums.add(w, contrast(i, j), shape.normal, x, u);
        });
        const double u[3] = {fields.velocity(i, 0), fields.velocity(i, 1), fields.velocity(i, 2)};
        Base::add_wall_gradients(i, u, sums.n);
        double s[3][3];
        InterfaceStress out;
        InterfaceLaw{shape, read_symmetric(correction, i), contrast.viscous_coefficient(i), damping}(sums, s, out);
        write_stress(out, stress, i);
        for (int k = 0; k < 3; ++k) {
            fields.tilted(i, k) = out.tilted[k];
            for (int l = 0; l < 3; ++l) fields.across[l](i, k) = out.across[k][l];
        }
        if (rated) rate(i) = math::sqrt(2 * (inner(s[0], s[0]) + inner(s[1], s[1]) + inner(s[2], s[2])));
    }
};

// As StressForceLoop.
template <class Kernel, class Stress>
struct InterfaceForceLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    double damping;
    RelativeDensity relative;
    ViscousContrast contrast;
    Array<int> rows;
    InterfaceFields fields;
    Stress stress;
    Array3 product;

    KOKKOS_INLINE_FUNCTION void operator()(int row) const {
        const int i = rows(row);
        const InterfacePull own = read_pull(i);
        const double u[3] = {fields.velocity(i, 0), fields.velocity(i, 1), fields.velocity(i, 2)};
        double f[3] = {0, 0, 0};
        Base::each_pair(i, [&](double w, int j, double dx, double dy, double dz, double) {
            const double x[3] = {dx, dy, dz}, h = contrast(i, j);
            double apart[3];
            fields.read_difference(i, j, apart);
            if (h == 0) {
                add_within(own, j, w, x, apart, f);
            } else {
                own.add(w, own.has_normal() ? h : 0, x, apart, f);
                const InterfacePull other = read_pull(j);
                other.add(w, other.has_normal() ? -h : 0, x, apart, f);
            }
        });
        Base::add_wall_stresses(i, WallStressForce<Stress>{stress, contrast.viscous_coefficient, damping}, u, f);
        const double inertia = relative(i);
        for (int k = 0; k < 3; ++k) product(i, k) = inertia * u[k] + f[k];
    }

private:
    // A pair within one liquid.
    KOKKOS_INLINE_FUNCTION void add_within(
        const InterfacePull& own, int j, double w, const double x[3], const double apart[3], double f[3]) const {
        const double slide = own.damping + damping * contrast.viscous_coefficient(j);
        for (int k = 0; k < 3; ++k) {
            double pull = slide * apart[k];
            for (int l = 0; l < 3; ++l) pull += (own.stress.q[k][l] + stress(j, k, l)) * x[l];
            f[k] += w * pull;
        }
    }
    // Pull of a particle with neighbours of another viscosity. Without a normal there is nothing but a stress.
    KOKKOS_INLINE_FUNCTION InterfacePull read_pull(int i) const {
        InterfacePull out{};
        out.damping = damping * contrast.viscous_coefficient(i);
        for (int k = 0; k < 3; ++k) {
            out.normal[k] = fields.normal(i, k);
            for (int l = 0; l < 3; ++l) out.stress.q[k][l] = stress(i, k, l);
        }
        if (!out.has_normal()) return out;
        for (int k = 0; k < 3; ++k) {
            out.stress.tilted[k] = fields.tilted(i, k);
            for (int l = 0; l < 3; ++l) out.stress.across[k][l] = fields.across[l](i, k);
        }
        return out;
    }
};

void declare_fields(ParticleStore& store, ViscousInterface& to) {
    if (to.normal >= 0) return;
    to.normal = store.add<Array3>("interface_normal", "", FieldRole::work);
    to.tilted = store.add<Array3>("interface_shear", "1/s", FieldRole::work);
    const char* names[3] = {"interface_stress_x", "interface_stress_y", "interface_stress_z"};
    for (int k = 0; k < 3; ++k) to.across[k] = store.add<Array3>(names[k], "m2/s", FieldRole::work);
}

InterfaceFields fields(const ParticleStore& store, const ViscousInterface& of, int u_field) {
    const auto get = [&](int field) { return store.get<Array3>(field); };
    return {get(u_field), get(of.normal), get(of.tilted), {get(of.across[0]), get(of.across[1]), get(of.across[2])}};
}
} // namespace

void ViscousOperator::prepare_interface(const ViscousContext& parts) {
    const auto& constants = parts.constants;
    auto& liquid = parts.liquid;
    interface_.any = false;
    interface_.count = 0;
    interface_.contrast = {};
    if (!constants.immiscible.several() || parts.options.viscosity.form != ViscosityForm::corrected) return;
    const int n = liquid.store.owned();
    interface_.contrast = {true, liquid.store.get<Array<double>>(viscous_coefficient_), liquid.liquid()};
    reserve(interface_.rows, static_cast<std::size_t>(n));
    interface_.count =
        find_rows(pairs(parts.neighbours.liquid, liquid.store, liquid.store), interface_.contrast, n, interface_.rows);
    interface_.any = parts.comm.sum(std::int64_t{interface_.count}) > 0;
    if (!interface_.any) return;
    declare_fields(liquid.store, interface_);
    reserve(interface_.shapes, static_cast<std::size_t>(interface_.count));
    const auto inlet = liquid.has_inlets() ? liquid.inlet() : Array<int>();
    const auto normal = liquid.store.get<Array3>(interface_.normal);
    const auto fluid = make_views(constants, liquid, parts.solid, parts.neighbours);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const ViscousLoop<Kernel> base{kernel, fluid, walls(parts, Walls::resting), weights_, wall_sums_};
        Kokkos::parallel_for("treacle::interface_shapes", interface_.count,
            InterfaceShapeLoop<Kernel>{
                base, interface_.contrast, interface_.rows, interface_.shapes, normal, correction_});
        parts.halo.gather(liquid.store, {interface_.normal});
        Kokkos::parallel_for("treacle::interface_blocks", interface_.count,
            InterfaceBlockLoop<Kernel>{base, damping_, relative_density(constants, liquid), interface_.contrast,
                slip_.any(), slip_.drag(), liquid.has_inlets(), inlet, interface_.rows, normal, correction_, block_,
                inertia_and_wall_diagonal_, smoothed_viscous_coefficient_});
    });
    if (tension_ < 0) return;
    const auto rows = interface_.rows;
    const auto bulk = bulk_;
    Kokkos::parallel_for(
        "treacle::interface_bulk", interface_.count,
        KOKKOS_LAMBDA(int k) { bulk(rows(k)) = 0; }); // their stresses have no tension
}

// Both loops, in between the ghosts' fields are gathered.
template <class Stress>
void ViscousOperator::stress_interface(const ViscousContext& parts, Walls which, int u_field, const Stress& stress) {
    if (!interface_.any) return;
    const auto& constants = parts.constants;
    const auto& store = parts.liquid.store;
    const auto fluid = make_views(constants, parts.liquid, parts.solid, parts.neighbours);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const ViscousLoop<Kernel> base{kernel, fluid, walls(parts, which), weights_, wall_sums_};
        Kokkos::parallel_for("treacle::interface_stress", interface_.count,
            InterfaceStressLoop<Kernel, Stress>{base, damping_, interface_.contrast, interface_.rows, interface_.shapes,
                correction_, fields(store, interface_, u_field), stress, !parts.forces.rheology.empty(), rate_});
    });
    parts.halo.gather(store, {interface_.tilted, interface_.across[0], interface_.across[1], interface_.across[2]});
}

template <class Stress>
void ViscousOperator::force_interface(
    const ViscousContext& parts, Walls which, int u_field, const Stress& stress, const Array3& product) {
    if (!interface_.any) return;
    const auto& constants = parts.constants;
    const auto fluid = make_views(constants, parts.liquid, parts.solid, parts.neighbours);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const ViscousLoop<Kernel> base{kernel, fluid, walls(parts, which), weights_, wall_sums_};
        Kokkos::parallel_for("treacle::interface_forces", interface_.count,
            InterfaceForceLoop<Kernel, Stress>{base, damping_, relative_density(constants, parts.liquid),
                interface_.contrast, interface_.rows, fields(parts.liquid.store, interface_, u_field), stress,
                product});
    });
}

template void ViscousOperator::stress_interface(const ViscousContext&, Walls, int, const Stresses&);
template void ViscousOperator::stress_interface(const ViscousContext&, Walls, int, const TileStresses&);
template void ViscousOperator::force_interface(const ViscousContext&, Walls, int, const Stresses&, const Array3&);
template void ViscousOperator::force_interface(const ViscousContext&, Walls, int, const TileStresses&, const Array3&);

} // namespace treacle::sph
