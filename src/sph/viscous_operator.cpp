#include "sph/viscous_operator.hpp"

#include "sph/symmetric.hpp"

#include <algorithm>

namespace treacle::sph {

namespace {
// Directions in which the neighbours spread less than that share of the lattice's spread carry no stress: a thread of
// particles has a strain along it, a sheet in it.
constexpr double least_spread = 0.02;
// Particles are not taken to be nearer to a surface than that many spacings.
constexpr double least_height = 0.25;

using Array6 = Kokkos::View<double* [6], Memory>;

KOKKOS_INLINE_FUNCTION bool by_gradients(ViscosityForm form) {
    return form == ViscosityForm::corrected || form == ViscosityForm::adjoint;
}

// What every loop reads; `place` has the shares dt/m V mu, `motion` the velocities.
template <class Kernel>
struct ViscousLoop {
    Kernel kernel;
    Fluid fluid;
    ViscousWalls walls;
    double volume; // V0 [m^D]

    KOKKOS_INLINE_FUNCTION double weight(double volumes, double r2) const {
        return -volumes * kernel.gradient(math::sqrt(r2));
    }
    // visit(s, w, dx, dy, dz, contact) for the solid particles that grip, with V_s |W'|/r [1/m2].
    template <class Visit>
    KOKKOS_INLINE_FUNCTION void each_wall(int i, const Visit& visit) const {
        walls.pairs.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            if (!walls.grips(s)) return;
            visit(s, weight(walls.grip * walls.volume(s), r2), dx, dy, dz, walls.touch(s, dx, dy, dz));
        });
    }
    template <class Grip>
    KOKKOS_INLINE_FUNCTION void add_walls(int i, const Grip& grip, const double u[3], double sum[3]) const {
        each_wall(i, [&](int, double w, double dx, double dy, double dz, const auto& contact) {
            const double x[3] = {dx, dy, dz};
            double force[3];
            grip(i, w, x, u, contact, force);
            for (int k = 0; k < 3; ++k) sum[k] += force[k];
        });
    }
    KOKKOS_INLINE_FUNCTION void read_velocity(int i, double u[3]) const {
        for (int k = 0; k < 3; ++k) u[k] = fluid.motion(i, k);
    }
};

// What one solid particle adds to a row of C u.
struct StressGrip {
    Array4 packed[3];

    template <class Contact>
    KOKKOS_INLINE_FUNCTION void operator()(int i, double w, const double x[3], const double u[3],
                                           const Contact& contact, double out[3]) const {
        for (int k = 0; k < 3; ++k) {
            const double pull = packed[k](i, 0) * x[0] + packed[k](i, 1) * x[1] + packed[k](i, 2) * x[2];
            const double slide = packed[0](i, 3) * contact.reach * (u[k] - contact.velocity[k]);
            out[k] = w * contact.reach * (pull + slide);
        }
    }
};
struct PairGrip {
    Array<double> share;
    double soft, line; // 0.01 h^2; D + 2 for the pairwise form, 0 for the Laplacian

    template <class Contact>
    KOKKOS_INLINE_FUNCTION void operator()(int i, double w, const double x[3], const double u[3],
                                           const Contact& contact, double out[3]) const {
        const double r2 = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
        const double c = 2 * share(i) * w * contact.reach / (r2 + soft);
        double along = 0;
        for (int k = 0; k < 3; ++k) along += (u[k] - contact.velocity[k]) * x[k];
        for (int k = 0; k < 3; ++k) {
            out[k] = c * (line > 0 ? line * along * x[k] : r2 * (u[k] - contact.velocity[k]));
        }
    }
};

// B_i = sum V w x x^T, its inverse, and the blocks that precondition.
template <class Kernel>
struct PrepareLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    ViscosityForm form;
    double damping;
    RelativeDensity relative;
    Array<double> share;
    bool slips;
    Array<double> drag; // of walls along which the liquid slips
    Array6 correction, span, block;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        Symmetric spread;
        double weights = 0, pull[3] = {0, 0, 0};
        Base::fluid.liquid.each(i, [&](int, double dx, double dy, double dz, double r2) {
            const double w = Base::weight(Base::volume, r2);
            add(spread, weights, pull, w, 1, dx, dy, dz);
        });
        Base::each_wall(i, [&](int, double w, double dx, double dy, double dz, const auto& contact) {
            add(spread, weights, pull, w, contact.reach, dx, dy, dz);
        });
        PartialInverse fit{{1, 1, 1, 0, 0, 0}, {1, 1, 1, 0, 0, 0}};
        if (form == ViscosityForm::corrected) fit = invert_above(spread, least_spread);
        write_symmetric(fit.inverse, correction, i);
        write_symmetric(fit.span, span, i);
        double own[3];
        fit.inverse.times(pull, own);
        Symmetric d = pair_block(i, fit.inverse);
        const double c = share(i), square = own[0] * own[0] + own[1] * own[1] + own[2] * own[2];
        if (by_gradients(form)) {
            d.add_square(c, own[0], own[1], own[2]);
            const double both = c * square + 2 * damping * c * weights;
            d.xx += both, d.yy += both, d.zz += both;
        }
        const double inertia = relative(i) + (slips ? drag(i) : 0);
        d.xx += inertia, d.yy += inertia, d.zz += inertia;
        write_symmetric(inverse(d), block, i);
    }

private:
    KOKKOS_INLINE_FUNCTION static void add(Symmetric& spread, double& weights, double pull[3], double w, double reach,
                                           double dx, double dy, double dz) {
        spread.add_square(w, dx, dy, dz);
        weights += w * reach * reach;
        pull[0] += w * reach * dx;
        pull[1] += w * reach * dy;
        pull[2] += w * reach * dz;
    }
    // What the strains of the neighbours, or the pairs, add. Their corrections are taken to be like this one's.
    KOKKOS_INLINE_FUNCTION Symmetric pair_block(int i, const Symmetric& fit) const {
        Symmetric d;
        const double soft = 0.01 * Base::kernel.h * Base::kernel.h;
        const auto pair = [&](double shares, double w, double dx, double dy, double dz, double r2) {
            if (by_gradients(form)) {
                const double x[3] = {dx, dy, dz};
                double g[3];
                fit.times(x, g);
                for (double& v : g) v *= w;
                const double square = 0.5 * shares * (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
                d.add_square(0.5 * shares, g[0], g[1], g[2]);
                d.xx += square, d.yy += square, d.zz += square;
            } else if (form == ViscosityForm::pairwise) {
                d.add_square((Kernel::dimensions + 2) * shares * w / (r2 + soft), dx, dy, dz);
            } else {
                const double along = shares * w * r2 / (r2 + soft);
                d.xx += along, d.yy += along, d.zz += along;
            }
        };
        Base::fluid.liquid.each(i, [&](int j, double dx, double dy, double dz, double r2) {
            pair(share(i) + share(j), Base::weight(Base::volume, r2), dx, dy, dz, r2);
        });
        if (by_gradients(form)) return d;
        Base::each_wall(i, [&](int, double w, double dx, double dy, double dz, const auto& contact) {
            pair(2 * share(i), w * contact.reach, dx, dy, dz, dx * dx + dy * dy + dz * dz);
        });
        return d;
    }
};

// Velocity gradients G_i = N_i B_i^+, and of them Q_i = dt/m V (2 mu S_i B_i^+ - kappa mu G_i).
template <class Kernel>
struct StressLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    double damping;
    Array<double> share;
    Array6 correction, span;
    Array3 stress[3];
    Array4 packed[3];
    bool rated;
    Array<double> rate;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        double n[3][3];
        sum_pairs(i, n);
        double u[3];
        Base::read_velocity(i, u);
        Base::each_wall(i, [&](int, double w, double dx, double dy, double dz, const auto& contact) {
            for (int k = 0; k < 3; ++k) {
                const double difference = w * contact.reach * (u[k] - contact.velocity[k]);
                n[k][0] += difference * dx;
                n[k][1] += difference * dy;
                n[k][2] += difference * dz;
            }
        });
        const Symmetric fit = read_symmetric(correction, i), spanned = read_symmetric(span, i);
        double g[3][3];
        for (int k = 0; k < 3; ++k) fit.times(n[k], g[k]);
        double s[3][3];
        strain(spanned, g, s);
        const double c = share(i);
        for (int k = 0; k < 3; ++k) {
            double q[3];
            fit.times(s[k], q);
            for (int l = 0; l < 3; ++l) {
                const double value = c * (2 * q[l] - damping * g[k][l]);
                stress[k](i, l) = value;
                packed[k](i, l) = value;
            }
        }
        packed[0](i, 3) = damping * c;
        if (rated) rate(i) = math::sqrt(2 * contract(s));
    }

private:
    KOKKOS_INLINE_FUNCTION static double contract(const double s[3][3]) {
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) sum += s[k][l] * s[k][l];
        }
        return sum;
    }
    KOKKOS_INLINE_FUNCTION void sum_pairs(int i, double n[3][3]) const {
        const auto& motion = Base::fluid.motion;
        const double ux = motion(i, 0), uy = motion(i, 1), uz = motion(i, 2);
        const Row row = Base::fluid.row(i);
        Lanes xx = 0.0, xy = 0.0, xz = 0.0, yx = 0.0, yy = 0.0, yz = 0.0, zx = 0.0, zy = 0.0, zz = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const auto d = row.near(k);
            const auto v = Base::fluid.motions(row, k);
            const auto along = distance(d.r2);
            const Lanes w = row.within(k, -Base::volume * Base::kernel.gradient(along.r, along.inverse));
            const Lanes ax = w * (ux - v.x), ay = w * (uy - v.y), az = w * (uz - v.z);
            xx = xx + ax * d.x;
            xy = xy + ax * d.y;
            xz = xz + ax * d.z;
            yx = yx + ay * d.x;
            yy = yy + ay * d.y;
            yz = yz + ay * d.z;
            zx = zx + az * d.x;
            zy = zy + az * d.y;
            zz = zz + az * d.z;
        }
        const Lanes sums[3][3] = {{xx, xy, xz}, {yx, yy, yz}, {zx, zy, zz}};
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) n[k][l] = sum_lanes(sums[k][l]);
        }
    }
    // The symmetric part of G within the span, in which a rotation has none.
    KOKKOS_INLINE_FUNCTION static void strain(const Symmetric& spanned, const double g[3][3], double s[3][3]) {
        double half[3][3]; // G is 0 across the span on the right already: only the left side is cut
        for (int l = 0; l < 3; ++l) {
            const double column[3] = {g[0][l], g[1][l], g[2][l]};
            double cut[3];
            spanned.times(column, cut);
            for (int k = 0; k < 3; ++k) half[k][l] = cut[k];
        }
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) s[k][l] = 0.5 * (half[k][l] + half[l][k]);
        }
    }
};

// C u of the forms with gradients.
template <class Kernel>
struct StressForceLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    RelativeDensity relative;
    Array4 packed[3];
    Array3 product;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        double u[3];
        Base::read_velocity(i, u);
        double q[3][3], own = packed[0](i, 3);
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) q[k][l] = packed[k](i, l);
        }
        const Row row = Base::fluid.row(i);
        Lanes fx = 0.0, fy = 0.0, fz = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const auto d = row.near(k);
            const auto v = Base::fluid.motions(row, k);
            const auto x = gather_quads(packed[0].data(), row.index + k);
            const auto y = gather_quads(packed[1].data(), row.index + k);
            const auto z = gather_quads(packed[2].data(), row.index + k);
            const auto along = distance(d.r2);
            const Lanes w = row.within(k, -Base::volume * Base::kernel.gradient(along.r, along.inverse));
            const Lanes damp = own + x.w;
            fx = fx + w * ((q[0][0] + x.x) * d.x + (q[0][1] + x.y) * d.y + (q[0][2] + x.z) * d.z + damp * (u[0] - v.x));
            fy = fy + w * ((q[1][0] + y.x) * d.x + (q[1][1] + y.y) * d.y + (q[1][2] + y.z) * d.z + damp * (u[1] - v.y));
            fz = fz + w * ((q[2][0] + z.x) * d.x + (q[2][1] + z.y) * d.y + (q[2][2] + z.z) * d.z + damp * (u[2] - v.z));
        }
        double f[3] = {sum_lanes(fx), sum_lanes(fy), sum_lanes(fz)};
        Base::add_walls(i, StressGrip{{packed[0], packed[1], packed[2]}}, u, f);
        const double inertia = relative(i);
        for (int k = 0; k < 3; ++k) product(i, k) = inertia * u[k] + f[k];
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
        Lanes fx = 0.0, fy = 0.0, fz = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const auto d = row.near(k);
            const auto v = Base::fluid.motions(row, k);
            const auto along = distance(d.r2);
            const Lanes w = row.within(k, -Base::volume * Base::kernel.gradient(along.r, along.inverse));
            const Lanes c = w * (own + d.number) * inverse(d.r2 + soft);
            const Lanes ax = u[0] - v.x, ay = u[1] - v.y, az = u[2] - v.z;
            if (line > 0) {
                const Lanes pull = line * c * (ax * d.x + ay * d.y + az * d.z);
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

// The reaction of the grips, per solid.
template <class Kernel, class Grip>
struct ViscousLoadLoop : ViscousLoop<Kernel>, LoadReduction {
    using Base = ViscousLoop<Kernel>;
    Grip grip;
    double scale; // m / dt

    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        double u[3];
        Base::read_velocity(i, u);
        Base::each_wall(i, [&](int s, double w, double dx, double dy, double dz, const auto& contact) {
            const double x[3] = {dx, dy, dz};
            double force[3];
            grip(i, w, x, u, contact, force);
            for (double& f : force) f *= scale;
            const int body = Base::walls.body(s);
            Base::walls.points.add(sum + 6 * body, body, contact.place, force);
        });
    }
};

// How hard the grips hold each solid, to precondition.
template <class Kernel>
struct StiffnessLoop : ViscousLoop<Kernel>, LoadReduction {
    using Base = ViscousLoop<Kernel>;
    Array<double> share;

    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        Base::each_wall(i, [&](int s, double w, double, double, double, const auto& contact) {
            Base::walls.points.add_stiffness(sum, Base::walls.body(s), contact.place, 2 * share(i) * w * contact.reach);
        });
    }
};

double write_own_shares(const Array<double>& viscosity, double scale, int n, const Array<double>& share) {
    double most = 0;
    Kokkos::parallel_reduce("treacle::own_viscous_shares", n, KOKKOS_LAMBDA(int i, double& largest) {
        share(i) = scale * viscosity(i);
        largest = math::max(largest, share(i));
    }, Kokkos::Max<double>(most));
    return n > 0 ? most : 0;
}

template <class Liquids>
double write_shares(const Liquids& liquids, double scale, int n, const Array<double>& share) {
    double most = 0;
    Kokkos::parallel_reduce("treacle::viscous_shares", n, KOKKOS_LAMBDA(int i, double& largest) {
        share(i) = scale * liquids.viscosity(i);
        largest = math::max(largest, share(i));
    }, Kokkos::Max<double>(most));
    return n > 0 ? most : 0;
}

void pack_motion(LiquidParticles& liquid, const Array3& u) {
    const int n = liquid.store.total();
    reserve(liquid.motion, static_cast<std::size_t>(n));
    const auto to = liquid.motion;
    Kokkos::parallel_for("treacle::viscous_motion", n, KOKKOS_LAMBDA(int i) {
        for (int k = 0; k < 3; ++k) to(i, k) = u(i, k);
        to(i, 3) = 0;
    });
}

// The ghosts' rows of Q_i, to where pair sums read them.
void pack_ghosts(const ParticleStore& store, const Array3 (&from)[3], const Array4 (&to)[3],
                 const Array<double>& share, double damping) {
    const auto fx = from[0], fy = from[1], fz = from[2];
    const auto x = to[0], y = to[1], z = to[2];
    using Range = Kokkos::RangePolicy<Execution>;
    Kokkos::parallel_for("treacle::viscous_ghosts", Range(store.owned(), store.total()), KOKKOS_LAMBDA(int i) {
        for (int k = 0; k < 3; ++k) {
            x(i, k) = fx(i, k);
            y(i, k) = fy(i, k);
            z(i, k) = fz(i, k);
        }
        x(i, 3) = damping * share(i);
    });
}

PairGrip pair_grip(const ViscousParts& parts, const Array<double>& share) {
    const double h = parts.constants.support;
    const double line = parts.options.viscosity.form == ViscosityForm::pairwise ? parts.constants.dimensions + 2 : 0;
    return {share, 0.01 * h * h, line};
}
} // namespace

ViscousOperator::ViscousOperator(LiquidParticles& liquid, const std::vector<double>& slip_lengths) : slip_(slip_lengths) {
    const char* names[3] = {"viscous_stress_x", "viscous_stress_y", "viscous_stress_z"};
    for (int k = 0; k < 3; ++k) stress_[k] = liquid.store.add<Array3>(names[k], "m2/s", FieldRole::work);
    share_ = liquid.store.add<Array<double>>("viscous_share", "m2", FieldRole::work);
}

ViscousWalls ViscousOperator::walls(const ViscousParts& parts, Walls which) const {
    return {pairs(parts.neighbours.solid, parts.liquid.store, parts.solid.store),
            parts.solid.volume(),
            parts.solid.body(),
            parts.solid.normal(),
            parts.friction,
            parts.motion,
            parts.points,
            parts.constants.wall_grip,
            parts.constants.wall_depth,
            least_height * parts.constants.spacing,
            which == Walls::resting};
}

double ViscousOperator::prepare(const ViscousParts& parts, double dt) {
    dt_ = dt;
    const auto& constants = parts.constants;
    const auto& viscosity = parts.options.viscosity;
    auto& liquid = parts.liquid;
    const int n = liquid.store.owned();
    damping_ = viscosity.form == ViscosityForm::corrected ? viscosity.checkerboard_damping : 0;
    const auto share = liquid.store.get<Array<double>>(share_);
    const double scale = dt / constants.mass * constants.rest_volume;
    double most = 0;
    if (parts.forces.by_particle) {
        most = write_own_shares(liquid.viscosity(), scale, n, share);
    } else {
        with_liquids(constants.mixture, liquid.liquid(), parts.forces.viscosity,
                     [&](const auto& liquids) { most = write_shares(liquids, scale, n, share); });
    }
    most = parts.comm.max(most);
    if (most == 0) return 0;
    if (slip_.any()) slip_.prepare(parts, parts.points, share);
    parts.halo.gather(liquid.store, {share_});
    if (!parts.forces.rheology.empty()) reserve(rate_, static_cast<std::size_t>(n));
    for (auto* array : {&correction_, &span_, &block_}) reserve(*array, static_cast<std::size_t>(n));
    for (auto& array : packed_) reserve(array, static_cast<std::size_t>(liquid.store.total()));
    write_places(liquid, share);
    const auto fluid = gather_fluid(constants, liquid, parts.solid, parts.neighbours);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        Kokkos::parallel_for("treacle::viscous_prepare", n,
                             PrepareLoop<Kernel>{{kernel, fluid, walls(parts, Walls::resting), constants.rest_volume},
                                                 viscosity.form, damping_, relative_density(constants, liquid), share,
                                                 slip_.any(), slip_.drag(), correction_, span_, block_});
    });
    return most;
}

void ViscousOperator::multiply(const ViscousParts& parts, int u_field, Walls which, const Array3& product) {
    auto& liquid = parts.liquid;
    const auto& constants = parts.constants;
    const ViscosityForm form = parts.options.viscosity.form;
    const auto share = liquid.store.get<Array<double>>(share_);
    parts.halo.gather(liquid.store, {u_field});
    pack_motion(liquid, liquid.store.get<Array3>(u_field));
    const auto fluid = gather_fluid(constants, liquid, parts.solid, parts.neighbours);
    const auto relative = relative_density(constants, liquid);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const ViscousLoop<Kernel> base{kernel, fluid, walls(parts, which), constants.rest_volume};
        if (!by_gradients(form)) {
            Kokkos::parallel_for("treacle::viscous_pairs", fluid.count,
                                 PairForceLoop<Kernel>{base, relative, pair_grip(parts, share), product});
            return;
        }
        const auto& store = liquid.store;
        const Array3 rows[3] = {store.get<Array3>(stress_[0]), store.get<Array3>(stress_[1]), store.get<Array3>(stress_[2])};
        Kokkos::parallel_for("treacle::viscous_stress", fluid.count,
                             StressLoop<Kernel>{base, damping_, share, correction_, span_, {rows[0], rows[1], rows[2]},
                                                {packed_[0], packed_[1], packed_[2]},
                                                !parts.forces.rheology.empty(), rate_});
        parts.halo.gather(store, {stress_[0], stress_[1], stress_[2]});
        pack_ghosts(store, rows, packed_, share, damping_);
        Kokkos::parallel_for("treacle::viscous_forces", fluid.count,
                             StressForceLoop<Kernel>{base, relative, {packed_[0], packed_[1], packed_[2]}, product});
    });
    if (!slip_.any()) return;
    if (which == Walls::resting) slip_.add(parts, product);
    else slip_.add(parts, parts.motion, product);
}

void ViscousOperator::precondition(const LiquidParticles& liquid, const Array3& r, const Array3& z) const {
    const auto block = block_;
    Kokkos::parallel_for("treacle::viscous_precondition", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
        const double from[3] = {r(i, 0), r(i, 1), r(i, 2)};
        double to[3];
        read_symmetric(block, i).times(from, to);
        for (int k = 0; k < 3; ++k) z(i, k) = to[k];
    });
}

namespace {
bool any_grips(const ViscousParts& parts) {
    const auto& friction = parts.forces.friction;
    return parts.neighbours.solid.size > 0 && std::ranges::any_of(friction, [](double f) { return f > 0; });
}
} // namespace

BodyLoads ViscousOperator::loads(const ViscousParts& parts) const {
    const auto& constants = parts.constants;
    BodyLoads out(static_cast<std::size_t>(6 * parts.points.count), 0.0);
    const auto fluid = gather_fluid(constants, parts.liquid, parts.solid, parts.neighbours);
    const double scale = constants.mass / dt_;
    if (slip_.any()) slip_.add_loads(parts, parts.motion, scale, out);
    if (!any_grips(parts)) return out;
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const ViscousLoop<Kernel> base{kernel, fluid, walls(parts, Walls::moving), constants.rest_volume};
        const auto sum = [&](const auto& grip) {
            using Grip = std::decay_t<decltype(grip)>;
            BodyLoads sums(out.size(), 0.0);
            Kokkos::parallel_reduce("treacle::viscous_loads", fluid.count,
                                    ViscousLoadLoop<Kernel, Grip>{base, {sums.size()}, grip, scale}, host_sums(sums));
            for (std::size_t k = 0; k < out.size(); ++k) out[k] += sums[k];
        };
        if (by_gradients(parts.options.viscosity.form)) {
            sum(StressGrip{{packed_[0], packed_[1], packed_[2]}});
        } else {
            sum(pair_grip(parts, parts.liquid.store.get<Array<double>>(share_)));
        }
    });
    return out;
}

std::vector<double> ViscousOperator::stiffness(const ViscousParts& parts) const {
    const auto& constants = parts.constants;
    std::vector<double> out(static_cast<std::size_t>(36 * parts.points.count), 0.0);
    const auto share = parts.liquid.store.get<Array<double>>(share_);
    const auto fluid = gather_fluid(constants, parts.liquid, parts.solid, parts.neighbours);
    if (any_grips(parts)) {
        with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
            using Kernel = std::decay_t<decltype(kernel)>;
            const ViscousLoop<Kernel> base{kernel, fluid, walls(parts, Walls::resting), constants.rest_volume};
            Kokkos::parallel_reduce("treacle::viscous_stiffness", fluid.count,
                                    StiffnessLoop<Kernel>{base, {out.size()}, share}, host_sums(out));
        });
    }
    if (slip_.any()) slip_.add_stiffness(parts, out);
    return out;
}

void ViscousOperator::thin(const ViscousParts& parts, const Array<FlowCurve>& curves) const {
    const auto rate = rate_, viscosity = parts.liquid.viscosity();
    const auto liquid = parts.liquid.liquid();
    Kokkos::parallel_for("treacle::thin_by_shear", parts.liquid.store.owned(), KOKKOS_LAMBDA(int i) {
        const FlowCurve& curve = curves(liquid(i));
        if (curve.law != scene::ShearLaw::newtonian) viscosity(i) = curve(rate(i));
    });
}

std::size_t ViscousOperator::bytes() const {
    return 8 * (correction_.span() + span_.span() + block_.span() + packed_[0].span() + packed_[1].span() + packed_[2].span());
}

} // namespace treacle::sph
