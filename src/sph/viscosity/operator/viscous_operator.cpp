#include "sph/viscosity/operator/viscous_operator.hpp"

#include "kokkos/float4.hpp"
#include "sph/viscosity/operator/viscous_loops.hpp"
#include "sph/viscosity/operator/viscous_prepare.hpp"

namespace treacle::sph {

namespace {
// Particles are not taken to be nearer to a surface than that many spacings.
constexpr double least_height = 0.25;
// Share of the tension that is kept to the next step: in liquid that is stretched evenly the bulk viscosity counts twenty times.
constexpr double kept_tension = 0.95;
constexpr double first_tension = 1e-30; // [1/s] of a particle that begins to be stretched, as distinct from none
// Liquid is stretched from where it expands at this share of its shear rate, which is 0.7 in a column that hangs; round-off
// and the noise of pressures are well below. It no longer is where its tension is below the second share of the rate.
constexpr double stretched_from = 0.2, stretched_until = 0.05;

// Velocity gradients G_i = N_i B_i^+, and of them Q_i = dt/m V (2 mu S_i B_i^+ - kappa mu G_i).
template <class Kernel>
struct StressLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    double damping;
    bool by_volumes; // of the neighbours, as the published form has it
    Array<double> share;
    Array6 correction;
    Array3 stress[3]; // columns
    bool rated;
    Array<double> rate;
    Array<float> bulk;                // zeta / mu of each particle, or empty
    Array<double> tension, expansion; // s / mu, or empty; tr D, with `bulk`

    KOKKOS_INLINE_FUNCTION void operator()(int block) const {
        each_row<Columns>(
            block, Base::fluid.count, [&](int i) { return sum_pairs(i); },
            [&](int i, const Columns& pairs) { finish(i, pairs); });
    }

private:
    struct Columns {
        Double4 column[3];
    };
    KOKKOS_INLINE_FUNCTION void finish(int i, const Columns& pairs) const {
        double n[3][3];
        for (int l = 0; l < 3; ++l) {
            double column[4];
            pairs.column[l].store(column);
            for (int k = 0; k < 3; ++k) n[k][l] = column[k];
        }
        double u[3];
        Base::read_velocity(i, u);
        Base::add_wall_gradients(i, u, n);
        const Symmetric fit = read_symmetric(correction, i), spanned = range_projector(fit);
        double g[3][3];
        for (int k = 0; k < 3; ++k) fit.times(n[k], g[k]);
        double s[3][3];
        strain(spanned, g, s);
        if (rated || bulk.size() > 0) rate(i) = math::sqrt(2 * contract(s));
        if (bulk.size() > 0) resist_expansion(i, spanned, s);
        const double c = share(i);
        for (int k = 0; k < 3; ++k) {
            double q[3];
            fit.times(s[k], q);
            for (int l = 0; l < 3; ++l) {
                stress[l](i, k) = c * (2 * q[l] - damping * g[k][l]);
            }
        }
    }
    // S + (zeta tr S + s)/(2 mu) within the span.
    KOKKOS_INLINE_FUNCTION void resist_expansion(int i, const Symmetric& span, double s[3][3]) const {
        const double trace = s[0][0] + s[1][1] + s[2][2];
        expansion(i) = trace;
        if (bulk(i) == 0) return;
        const double more = 0.5 * (static_cast<double>(bulk(i)) * trace + (tension.size() > 0 ? tension(i) : 0));
        const double within[3][3] = {
            {span.xx, span.xy, span.xz}, {span.xy, span.yy, span.yz}, {span.xz, span.yz, span.zz}};
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) s[k][l] += more * within[k][l];
        }
    }
    KOKKOS_INLINE_FUNCTION static double contract(const double s[3][3]) {
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) sum += s[k][l] * s[k][l];
        }
        return sum;
    }
    KOKKOS_INLINE_FUNCTION Columns sum_pairs(int i) const {
        const double *place = Base::fluid.place.data(), *motion = Base::fluid.motion.data();
        const Double4 x = Double4::load(place + 4 * std::int64_t(i)), u = Double4::load(motion + 4 * std::int64_t(i));
        Double4 even[3] = {0.0, 0.0, 0.0}, odd[3] = {0.0, 0.0, 0.0};
        Base::each_entry(i, even, odd, [&](Double4 columns[3], std::int64_t k) {
            const double* other = motion + 4 * std::int64_t(Base::fluid.liquid.index(k));
            const double w = by_volumes ? Base::weights(k) * other[3] : Base::weights(k);
            const Double4 along =
                Double4(w) * (x - Double4::load(place + 4 * std::int64_t(Base::fluid.liquid.index(k))));
            const Double4 apart = u - Double4::load(other);
            columns[0].add(along.all<0>(), apart);
            columns[1].add(along.all<1>(), apart);
            columns[2].add(along.all<2>(), apart);
        });
        return {{even[0] + odd[0], even[1] + odd[1], even[2] + odd[2]}};
    }
};

// C u of the forms with gradients.
template <class Kernel>
struct StressForceLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    double damping;
    RelativeDensity relative;
    Array<double> share;
    Array3 stress[3];
    Array3 product;

    KOKKOS_INLINE_FUNCTION void operator()(int block) const {
        each_row<Double4>(
            block, Base::fluid.count, [&](int i) { return sum_pairs(i); },
            [&](int i, const Double4& pairs) { finish(i, pairs); });
    }

private:
    KOKKOS_INLINE_FUNCTION void finish(int i, const Double4& pairs) const {
        double u[3], f[4];
        Base::read_velocity(i, u);
        pairs.store(f);
        Base::add_wall_stresses(i, StressGrip<Stresses>{{stress[0], stress[1], stress[2]}, share, damping}, u, f);
        const double inertia = relative(i);
        for (int k = 0; k < 3; ++k) product(i, k) = inertia * u[k] + f[k];
    }
    // The fourth ones of `place` are the shares dt/m V mu, of which `damping` acts on differences of velocities.
    KOKKOS_INLINE_FUNCTION Double4 sum_pairs(int i) const {
        const double *place = Base::fluid.place.data(), *motion = Base::fluid.motion.data();
        const auto read = [](const double* rows, int row) { return Double4::load(rows + 4 * std::int64_t(row)); };
        const Double4 x = read(place, i), u = read(motion, i);
        const Double4 twice = 2 * Base::fluid.place(i, 3), factor = damping;
        const Double4 own[3] = {Double4::load(stress[0], i), Double4::load(stress[1], i), Double4::load(stress[2], i)};
        struct Sums {
            Double4 pull[3] = {0.0, 0.0, 0.0}, slide = 0.0, spread = 0.0;
        } even, odd;
        Base::each_entry(i, even, odd, [&](Sums& sums, std::int64_t k) {
            const int j = Base::fluid.liquid.index(k);
            const Double4 w = static_cast<double>(Base::weights(k)), apart = x - read(place, j);
            const Double4 along = w * apart;
            sums.spread.add(w, apart);
            sums.pull[0].add(along.all<0>(), Double4::load(stress[0], j));
            sums.pull[1].add(along.all<1>(), Double4::load(stress[1], j));
            sums.pull[2].add(along.all<2>(), Double4::load(stress[2], j));
            sums.slide.add(w * twice - along.all<3>(), u - read(motion, j));
        });
        const Double4 spread = even.spread + odd.spread;
        Double4 sum = factor * (even.slide + odd.slide);
        for (int l = 0; l < 3; ++l) sum = sum + even.pull[l] + odd.pull[l];
        sum.add(spread.all<0>(), own[0]);
        sum.add(spread.all<1>(), own[1]);
        sum.add(spread.all<2>(), own[2]);
        return sum;
    }
};

// C u of the forms by pairs: along the line between two particles, or the Laplacian of each component.
template <class Kernel>
struct PairForceLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    RelativeDensity relative;
    PairGrip grip;
    Array3 product;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        double u[3];
        Base::read_velocity(i, u);
        const double soft = grip.soft, line = grip.line, own = grip.share(i);
        const Row row = Base::fluid.row(i);
        const std::int64_t first = Base::fluid.liquid.offset(i);
        SimdDouble fx = 0.0, fy = 0.0, fz = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const auto d = row.near(k);
            const auto v = Base::fluid.motions(row, k);
            const SimdDouble w = row.within(k, load_lanes(&Base::weights(first + k)));
            const SimdDouble c = w * (own + d.number) * treacle::inverse(d.r2 + soft);
            const SimdDouble ax = u[0] - v.x, ay = u[1] - v.y, az = u[2] - v.z;
            if (line > 0) {
                const SimdDouble pull = line * c * (ax * d.x + ay * d.y + az * d.z);
                fx = fx + pull * d.x;
                fy = fy + pull * d.y;
                fz = fz + pull * d.z;
            } else {
                fx = fx + c * d.r2 * ax;
                fy = fy + c * d.r2 * ay;
                fz = fz + c * d.r2 * az;
            }
        }
        double f[3] = {sum_lanes(fx), sum_lanes(fy), sum_lanes(fz)};
        Base::add_walls(i, grip, u, f);
        const double inertia = relative(i);
        for (int k = 0; k < 3; ++k) product(i, k) = inertia * u[k] + f[k];
    }
};

double write_own_shares(const Array<double>& viscosity, double scale, int n, const Array<double>& share) {
    double most = 0;
    Kokkos::parallel_reduce(
        "treacle::own_viscous_shares", n,
        KOKKOS_LAMBDA(int i, double& largest) {
            share(i) = scale * viscosity(i);
            largest = math::max(largest, share(i));
        },
        Kokkos::Max<double>(most));
    return n > 0 ? most : 0;
}

template <class Liquids>
double write_shares(const Liquids& liquids, double scale, int n, const Array<double>& share) {
    double most = 0;
    Kokkos::parallel_reduce(
        "treacle::viscous_shares", n,
        KOKKOS_LAMBDA(int i, double& largest) {
            share(i) = scale * liquids.viscosity(i);
            largest = math::max(largest, share(i));
        },
        Kokkos::Max<double>(most));
    return n > 0 ? most : 0;
}

// m/rho in place of the lattice's V on both sides (equations 4.5 and 4.6).
void scale_by_volumes(const Array<double>& volume, double rest_volume, int n, const Array<double>& share) {
    Kokkos::parallel_for(
        "treacle::viscous_volumes", n, KOKKOS_LAMBDA(int i) {
            const double ratio = volume(i) / rest_volume;
            share(i) *= ratio * ratio;
        });
}

// Whether no solid moves at all.
bool at_rest(const Array<double>& motion) {
    int moving = 0;
    Kokkos::parallel_reduce(
        "treacle::moving_solids", motion.extent(0),
        KOKKOS_LAMBDA(std::size_t k, int& count) { count += motion(k) != 0 ? 1 : 0; }, moving);
    return moving == 0;
}

} // namespace

void pack_velocity(LiquidParticles& liquid, int u_field, const Constants& constants) {
    const int n = liquid.store.total();
    reserve(liquid.motion, static_cast<std::size_t>(n));
    const auto to = liquid.motion;
    const auto u = liquid.store.get<Array3>(u_field);
    const auto volume = liquid.volume();
    const double rest_volume = constants.rest_volume;
    Kokkos::parallel_for(
        "treacle::viscous_motion", n, KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) to(i, k) = u(i, k);
            to(i, 3) = volume(i) / rest_volume;
        });
}

ViscousOperator::ViscousOperator(LiquidParticles& liquid, const std::vector<double>& slip_lengths, double bulk)
    : slip_(slip_lengths) {
    const char* names[3] = {"viscous_stress_x", "viscous_stress_y", "viscous_stress_z"};
    for (int k = 0; k < 3; ++k) stress_[k] = liquid.store.add<Array3>(names[k], "m2/s", FieldRole::work);
    share_ = liquid.store.add<Array<double>>("viscous_share", "m2", FieldRole::work);
    if (bulk > 0) tension_ = liquid.store.add<Array<double>>("tension_rate", "1/s", FieldRole::state);
}

ViscousWalls ViscousOperator::walls(const ViscousContext& parts, Walls which) const {
    return {pairs(parts.neighbours.solid, parts.liquid.store, parts.solid.store), parts.solid.volume(),
        parts.solid.body(), parts.solid.normal(), parts.friction, parts.motion, parts.points,
        parts.constants.wall_viscous_factor, parts.constants.wall_depth, least_height * parts.constants.spacing,
        which == Walls::resting || at_rest(parts.motion)};
}

double ViscousOperator::prepare(const ViscousContext& parts, double dt) {
    dt_ = dt;
    const auto& constants = parts.constants;
    const auto& viscosity = parts.options.viscosity;
    auto& liquid = parts.liquid;
    const int n = liquid.store.owned();
    damping_ = viscosity.form == ViscosityForm::corrected ? viscosity.hourglass_coefficient : 0;
    const auto share = liquid.store.get<Array<double>>(share_);
    const double scale = dt / constants.mass * constants.rest_volume;
    double most = 0;
    if (parts.forces.by_particle) {
        most = write_own_shares(liquid.viscosity(), scale, n, share);
    } else {
        with_liquids(constants.immiscible, liquid.liquid(), parts.forces.viscosity,
            [&](const auto& liquids) { most = write_shares(liquids, scale, n, share); });
    }
    most = parts.comm.max(most);
    largest_share_ = most;
    if (most == 0) return 0;
    tiles_are_placed_ = false;
    if (viscosity.form == ViscosityForm::as_published)
        scale_by_volumes(liquid.volume(), constants.rest_volume, n, share);
    if (slip_.any()) slip_.prepare(parts, parts.points, share);
    parts.halo.gather(liquid.store, {share_});
    if (!parts.forces.rheology.empty() || tension_ >= 0) reserve(rate_, static_cast<std::size_t>(n));
    reserve(correction_, static_cast<std::size_t>(n));
    reserve(block_, static_cast<std::size_t>(n));
    for (auto* array : {&inertia_and_wall_diagonal_, &smoothed_viscous_coefficient_})
        reserve(*array, static_cast<std::size_t>(n));
    if (by_gradients(viscosity.form)) reserve(wall_sums_, static_cast<std::size_t>(n));
    const auto inlet = liquid.has_inlets() ? liquid.inlet() : Array<int>();
    if (tension_ >= 0) find_stretched(liquid, viscosity.bulk);
    pack_positions(liquid, share);
    const auto fluid = make_views(constants, liquid, parts.solid, parts.neighbours);
    // Rows are read several entries at a time, beyond their ends.
    reserve(weights_, static_cast<std::size_t>(parts.neighbours.liquid.size + NeighbourList::padding));
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const ViscousLoop<Kernel> base{kernel, fluid, walls(parts, Walls::resting), weights_, wall_sums_};
        Kokkos::parallel_for("treacle::viscous_prepare", n,
            PrepareLoop<Kernel>{base, viscosity.form, constants.rest_volume, damping_,
                relative_density(constants, liquid), share, slip_.any(), slip_.drag(), liquid.has_inlets(), inlet,
                bulk_, correction_, block_, inertia_and_wall_diagonal_, smoothed_viscous_coefficient_});
    });
    prepare_interface(parts);
    return most;
}

// Particles under tension resist expansion by a bulk viscosity.
void ViscousOperator::find_stretched(const LiquidParticles& liquid, double bulk) {
    const int n = liquid.store.owned();
    reserve(bulk_, static_cast<std::size_t>(n));
    reserve(trace_, static_cast<std::size_t>(n));
    const auto tension = liquid.store.get<Array<double>>(tension_);
    const auto to = bulk_;
    const float factor = static_cast<float>(bulk);
    Kokkos::parallel_for(
        "treacle::stretched", n, KOKKOS_LAMBDA(int i) { to(i) = tension(i) > 0 ? factor : 0; });
}

void ViscousOperator::keep_tension(const LiquidParticles& liquid) const {
    if (tension_ < 0) return;
    const auto trace = trace_, rate = rate_, tension = liquid.store.get<Array<double>>(tension_);
    const auto bulk = bulk_;
    Kokkos::parallel_for(
        "treacle::keep_tension", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            const double held = kept_tension * (tension(i) + static_cast<double>(bulk(i)) * trace(i));
            const bool stays = bulk(i) > 0 && held > stretched_until * rate(i);
            tension(i) = stays ? held : trace(i) > stretched_from * rate(i) ? first_tension : 0;
        });
}

void ViscousOperator::clear_tension(const LiquidParticles& liquid) const {
    if (tension_ >= 0) Kokkos::deep_copy(liquid.store.get<Array<double>>(tension_), 0.0);
}

Array<double> ViscousOperator::tension(const LiquidParticles& liquid) const {
    return tension_acts_ ? liquid.store.get<Array<double>>(tension_) : Array<double>();
}

void ViscousOperator::multiply(const ViscousContext& parts, int u_field, Walls which, const Array3& product) {
    auto& liquid = parts.liquid;
    const auto& constants = parts.constants;
    const ViscosityForm form = parts.options.viscosity.form;
    const auto share = liquid.store.get<Array<double>>(share_);
    parts.halo.gather(liquid.store, {u_field});
    pack_velocity(liquid, u_field, constants);
    const auto fluid = make_views(constants, liquid, parts.solid, parts.neighbours);
    const auto relative = relative_density(constants, liquid);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const ViscousLoop<Kernel> base{kernel, fluid, walls(parts, which), weights_, wall_sums_};
        if (!by_gradients(form)) {
            Kokkos::parallel_for("treacle::viscous_pairs", fluid.count,
                PairForceLoop<Kernel>{base, relative, pair_grip(parts, share), product});
            return;
        }
        const auto& store = liquid.store;
        const Array3 rows[3] = {
            store.get<Array3>(stress_[0]), store.get<Array3>(stress_[1]), store.get<Array3>(stress_[2])};
        Kokkos::parallel_for("treacle::viscous_stress", row_blocks(fluid.count),
            StressLoop<Kernel>{base, damping_, form == ViscosityForm::as_published, share, correction_,
                {rows[0], rows[1], rows[2]}, !parts.forces.rheology.empty(), rate_, bulk_, tension(liquid), trace_});
        const Stresses stress{{rows[0], rows[1], rows[2]}};
        stress_interface(parts, which, u_field, stress);
        parts.halo.gather(store, {stress_[0], stress_[1], stress_[2]});
        Kokkos::parallel_for("treacle::viscous_forces", row_blocks(fluid.count),
            StressForceLoop<Kernel>{base, damping_, relative, share, {rows[0], rows[1], rows[2]}, product});
        force_interface(parts, which, u_field, stress, product);
    });
    add_slip(parts, which, product);
}

void ViscousOperator::add_slip(const ViscousContext& parts, Walls which, const Array3& product) const {
    if (!slip_.any()) return;
    if (which == Walls::resting)
        slip_.add(parts, product);
    else
        slip_.add(parts, parts.motion, product);
}

void ViscousOperator::precondition(const LiquidParticles& liquid, const Array3& r, const Array3& z) const {
    const auto block = block_;
    Kokkos::parallel_for(
        "treacle::viscous_precondition", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            const double from[3] = {r(i, 0), r(i, 1), r(i, 2)};
            double to[3];
            read_symmetric(block, i).times(from, to);
            for (int k = 0; k < 3; ++k) z(i, k) = to[k];
        });
}

void ViscousOperator::thin(const ViscousContext& parts, const Array<flow::ViscosityModel>& curves) const {
    const auto rate = rate_, viscosity = parts.liquid.viscosity();
    const auto liquid = parts.liquid.liquid();
    Kokkos::parallel_for(
        "treacle::thin_by_shear", parts.liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            const flow::ViscosityModel& curve = curves(liquid(i));
            if (curve.law != scene::ViscosityModelKind::newtonian) viscosity(i) = curve(rate(i));
        });
}

std::size_t ViscousOperator::bytes() const {
    const std::size_t doubles = correction_.span() + rate_.span() + wall_sums_.span();
    const std::size_t floats = weights_.span() + block_.span() + inertia_and_wall_diagonal_.span() +
                               smoothed_viscous_coefficient_.span() + tiles_.span() + rows_.span() + fits_.span();
    return sizeof(double) * doubles + sizeof(float) * floats + slip_.bytes() + interface_.bytes();
}

} // namespace treacle::sph
