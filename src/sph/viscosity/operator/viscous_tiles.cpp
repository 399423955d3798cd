#include "kokkos/pair_products.hpp"
#include "sph/viscosity/operator/viscous_loops.hpp"

// Products in single precision. Of a particle its neighbours read a row, for its stress, and then a tile, for the forces. The row:
// its place, from that of the rank's first particle, its share dt/m V mu and its velocity. The tile, one line of the cache: the
// columns of Q, the place behind these, and in the last quad what the particle adds to its own force: Q_i sum w x, and the damping.
namespace treacle::sph {

namespace {
void pack_positions(
    const Array3& x, const Array<double>& viscous_coefficient, int n, const Array8& rows, const Array16& tiles) {
    Kokkos::parallel_for(
        "treacle::pack_tiles", n, KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 16; ++k) tiles(i, k) = 0;
            for (int l = 0; l < 3; ++l) rows(i, l) = tiles(i, 4 * l + 3) = static_cast<float>(x(i, l) - x(0, l));
            rows(i, 3) = static_cast<float>(viscous_coefficient(i));
            rows(i, 7) = 0;
        });
}

// B_i^+, the bulk viscosity over the viscosity, and whether the neighbours spread in all directions: 1, or 0 where the
// span is to be tested.
void write_fits(const Array6& correction, const Array<float>& bulk, int dimensions, int n, const Array8& fits) {
    Kokkos::parallel_for(
        "treacle::float_fits", n, KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 6; ++k) fits(i, k) = static_cast<float>(correction(i, k));
            const Symmetric span = range_projector(read_symmetric(correction, i));
            fits(i, 7) = bulk.size() > 0 ? bulk(i) : 0;
            fits(i, 6) = span.xx + span.yy + span.zz > dimensions - 0.5 ? 1 : 0;
        });
}

void write_velocities(const Array3& u, int n, const Array8& rows) {
    Kokkos::parallel_for(
        "treacle::velocity_rows", n, KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) rows(i, 4 + k) = static_cast<float>(u(i, k));
        });
}

KOKKOS_INLINE_FUNCTION void read_stress(const Array16& tiles, int i, const Stresses& to) {
    for (int l = 0; l < 3; ++l) {
        for (int k = 0; k < 3; ++k) to.column[l](i, k) = tiles(i, 4 * l + k);
    }
}

void read_stresses(const Array16& tiles, int n, const Stresses& to) {
    Kokkos::parallel_for(
        "treacle::stresses_of_tiles", n, KOKKOS_LAMBDA(int i) { read_stress(tiles, i, to); });
}

void read_sent_stresses(const Array16& tiles, const Array<int>& rows, int n, const Stresses& to) {
    Kokkos::parallel_for(
        "treacle::sent_stresses", n, KOKKOS_LAMBDA(int k) { read_stress(tiles, rows(k), to); });
}

void write_stresses(const Stresses& from, int first, int last, const Array16& tiles) {
    Kokkos::parallel_for(
        "treacle::tiles_of_ghosts", last - first, KOKKOS_LAMBDA(int k) {
            const int i = first + k;
            for (int l = 0; l < 3; ++l) {
                for (int row = 0; row < 3; ++row) tiles(i, 4 * l + row) = static_cast<float>(from.column[l](i, row));
            }
        });
}

// The sum of what visit adds for each liquid particle around i, of its tile and of V0 |W'|/r.
template <class Kernel, class Visit>
KOKKOS_INLINE_FUNCTION Float4x4 sum_tiles(
    const ViscousLoop<Kernel>& loop, const Array16& tiles, int i, const Visit& visit) {
    const float *rows = tiles.data(), *weights = loop.weights.data();
    const int* index = loop.fluid.liquid.index.data();
    Float4x4 even = 0.0f, odd = 0.0f;
    loop.each_entry(i, even, odd, [&](Float4x4& sum, std::int64_t k) {
        visit(sum, Float4x4(weights[k]), Float4x4::load(rows + 16 * std::int64_t(index[k])));
    });
    return even + odd;
}

// As StressLoop.
template <class Kernel>
struct TileStressLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    float damping;
    Array8 rows, fits;
    Array6 correction;
    Array3 velocity;
    Array16 tiles;
    Array<double> tension; // s / mu, or empty

    KOKKOS_INLINE_FUNCTION void operator()(int block) const {
        each_row<Float4x4>(
            block, Base::fluid.count, [&](int i) { return sum(i); }, [&](int i, const Float4x4& n) { finish(i, n); });
    }

private:
    // N_i, behind its columns sum w x, and sum w (s_i + s_j) (u_j - u_i).
    KOKKOS_INLINE_FUNCTION Float4x4 sum(int i) const {
        const std::int64_t first = Base::fluid.liquid.offset(i);
        Base::read_ahead(i);
        const Float4x4 liquid = sum_pair_products(rows.data(), i, Base::fluid.liquid.index.data() + first,
            Base::weights.data() + first, Base::fluid.liquid.count(i));
        return Base::walls.pairs.count(i) > 0 ? liquid + walls(i) : liquid;
    }
    KOKKOS_INLINE_FUNCTION void finish(int i, const Float4x4& n) const {
        float* tile = tiles.data() + 16 * std::int64_t(i);
        const Float4x4 q = stress(i, n);
        q.store_vectors(tile);
        const Float4x4 own = q * n.all<3>() - Float4x4(damping) * n.keep_last_row();
        own.sum_quads().store(tile + 12);
    }
    KOKKOS_INLINE_FUNCTION Float4x4 stress(int i, const Float4x4& n) const {
        const float* fit = fits.data() + 8 * std::int64_t(i);
        const Float4x4 inverse[3] = {Float4x4::broadcast_elements<0>(fit), Float4x4::broadcast_elements<1>(fit),
            Float4x4::broadcast_elements<2>(fit)};
        const Float4x4 g = times(n, inverse);
        Float4x4 half = g; // see StressLoop::strain
        if (fit[6] == 0) {
            const Symmetric span = range_projector(read_symmetric(correction, i));
            const double within[6] = {span.xx, span.yy, span.zz, span.xy, span.xz, span.yz};
            half = Float4x4::broadcast_row<0>(within) * g.all<0>();
            half.add(Float4x4::broadcast_row<1>(within), g.all<1>());
            half.add(Float4x4::broadcast_row<2>(within), g.all<2>());
        }
        Float4x4 twice = half + half.transposed();
        if (fit[7] > 0) twice = resist_expansion(i, twice);
        const Float4x4 q = times(twice, inverse);
        return Float4x4(rows(i, 3)) * (q - Float4x4(damping) * g);
    }
    // As StressLoop::resist_expansion, of 2 S.
    KOKKOS_INLINE_FUNCTION Float4x4 resist_expansion(int i, const Float4x4& twice) const {
        const Symmetric span = range_projector(read_symmetric(correction, i));
        const double within[9] = {span.xx, span.xy, span.xz, span.xy, span.yy, span.yz, span.xz, span.yz, span.zz};
        float s[16];
        twice.store(s);
        const float kept = tension.size() > 0 ? static_cast<float>(tension(i)) : 0;
        const float more = 0.5f * fits(i, 7) * (s[0] + s[5] + s[10]) + kept;
        for (int k = 0; k < 9; ++k) s[4 * (k / 3) + k % 3] += more * static_cast<float>(within[k]);
        return Float4x4::load(s);
    }
    // The matrix of columns a times the symmetric one of these rows.
    KOKKOS_INLINE_FUNCTION static Float4x4 times(const Float4x4& a, const Float4x4 rows[3]) {
        Float4x4 out = a.quad<0>() * rows[0];
        out.add(a.quad<1>(), rows[1]);
        out.add(a.quad<2>(), rows[2]);
        return out;
    }
    KOKKOS_INLINE_FUNCTION Float4x4 walls(int i) const {
        const double u[3] = {velocity(i, 0), velocity(i, 1), velocity(i, 2)};
        double n[3][3] = {};
        Base::add_wall_gradients(i, u, n);
        float sum[16] = {};
        for (int l = 0; l < 3; ++l) {
            for (int k = 0; k < 3; ++k) sum[4 * l + k] = static_cast<float>(n[k][l]);
        }
        return Float4x4::load(sum);
    }
};

// As StressForceLoop.
template <class Kernel>
struct TileForceLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    double damping;
    RelativeDensity relative;
    Array<double> viscous_coefficient;
    Array3 velocity;
    Array16 tiles;
    Array3 product;

    KOKKOS_INLINE_FUNCTION void operator()(int block) const {
        each_row<Float4x4>(
            block, Base::fluid.count, [&](int i) { return sum(i); },
            [&](int i, const Float4x4& pairs) { finish(i, pairs); });
    }

private:
    // Over j: w Q_j x.
    KOKKOS_INLINE_FUNCTION Float4x4 sum(int i) const {
        const Float4x4 own = Float4x4::load(tiles.data() + 16 * std::int64_t(i));
        return sum_tiles(*this, tiles, i,
            [&](Float4x4& to, const Float4x4& w, const Float4x4& other) { to.add(w * (own - other).all<3>(), other); });
    }
    KOKKOS_INLINE_FUNCTION void finish(int i, const Float4x4& sum) const {
        float s[16];
        sum.store(s);
        double f[3];
        const double u[3] = {velocity(i, 0), velocity(i, 1), velocity(i, 2)};
        for (int k = 0; k < 3; ++k) f[k] = s[k] + s[4 + k] + s[8 + k] + tiles(i, 12 + k);
        Base::add_wall_stresses(i, WallStressForce<TileStresses>{{tiles}, viscous_coefficient, damping}, u, f);
        const double inertia = relative(i);
        for (int k = 0; k < 3; ++k) product(i, k) = inertia * u[k] + f[k];
    }
};
} // namespace

void ViscousOperator::write_tiles(LiquidParticles& liquid, const Array<double>& viscous_coefficient, int dimensions) {
    const int n = liquid.store.total();
    reserve(rows_, static_cast<std::size_t>(n));
    reserve(tiles_, static_cast<std::size_t>(n));
    reserve(fits_, static_cast<std::size_t>(liquid.store.owned()));
    pack_positions(liquid.store.position(), viscous_coefficient, n, rows_, tiles_);
    write_fits(correction_, bulk_, dimensions, liquid.store.owned(), fits_);
    tiles_are_packed_ = true;
}

// The ghosts' columns of Q go through the fields of the double products; beside moving walls loads() takes all from there.
void ViscousOperator::exchange_tiles(const ViscousContext& parts, Walls which) {
    const auto& store = parts.liquid.store;
    const Stresses stresses{
        {store.get<Array3>(stress_[0]), store.get<Array3>(stress_[1]), store.get<Array3>(stress_[2])}};
    if (which == Walls::moving)
        read_stresses(tiles_, store.owned(), stresses);
    else
        read_sent_stresses(tiles_, parts.halo.rows(), static_cast<int>(parts.halo.sent_rows()), stresses);
    parts.halo.gather(store, {stress_[0], stress_[1], stress_[2]});
    write_stresses(stresses, store.owned(), store.total(), tiles_);
}

void ViscousOperator::multiply_single_precision(
    const ViscousContext& parts, int u_field, Walls which, const Array3& product) {
    auto& liquid = parts.liquid;
    const auto& store = liquid.store;
    const auto& constants = parts.constants;
    const auto viscous_coefficient = store.get<Array<double>>(viscous_coefficient_);
    if (!tiles_are_packed_) write_tiles(liquid, viscous_coefficient, constants.dimensions);
    parts.halo.gather(store, {u_field});
    const auto velocity = store.get<Array3>(u_field);
    if (slip_.any() || which == Walls::moving)
        pack_velocity(liquid, u_field, constants); // slip and loads() read it there
    write_velocities(velocity, store.total(), rows_);
    const auto fluid = make_views(constants, liquid, parts.solid, parts.neighbours);
    const auto relative = relative_density(constants, liquid);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const ViscousLoop<Kernel> base{kernel, fluid, walls(parts, which), weights_, wall_sums_};
        const int blocks = row_blocks(fluid.count);
        Kokkos::parallel_for("treacle::viscous_tile_stress", blocks,
            TileStressLoop<Kernel>{
                base, static_cast<float>(damping_), rows_, fits_, correction_, velocity, tiles_, tension(liquid)});
        stress_interface(parts, which, u_field, TileStresses{tiles_});
        exchange_tiles(parts, which);
        Kokkos::parallel_for("treacle::viscous_tile_forces", blocks,
            TileForceLoop<Kernel>{base, damping_, relative, viscous_coefficient, velocity, tiles_, product});
        force_interface(parts, which, u_field, TileStresses{tiles_}, product);
    });
    add_slip(parts, which, product);
}

} // namespace treacle::sph
