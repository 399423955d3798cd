#include "sph/viscosity/operator/viscous_operator.hpp"

#include "sph/viscosity/operator/viscous_loops.hpp"
#include "sph/viscosity/operator/viscous_prepare.hpp"
#include "sph/viscosity/operator/viscous_product.hpp"

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

double write_own_coefficients(
    const Array<double>& viscosity, double scale, int n, const Array<double>& viscous_coefficient) {
    double most = 0;
    Kokkos::parallel_reduce(
        "treacle::own_viscous_coefficients", n,
        KOKKOS_LAMBDA(int i, double& largest) {
            viscous_coefficient(i) = scale * viscosity(i);
            largest = math::max(largest, viscous_coefficient(i));
        },
        Kokkos::Max<double>(most));
    return n > 0 ? most : 0;
}

template <class Liquids>
double write_coefficients(const Liquids& liquids, double scale, int n, const Array<double>& viscous_coefficient) {
    double most = 0;
    Kokkos::parallel_reduce(
        "treacle::viscous_coefficients", n,
        KOKKOS_LAMBDA(int i, double& largest) {
            viscous_coefficient(i) = scale * liquids.viscosity(i);
            largest = math::max(largest, viscous_coefficient(i));
        },
        Kokkos::Max<double>(most));
    return n > 0 ? most : 0;
}

// m/rho in place of the lattice's V on both sides (equations 4.5 and 4.6).
void scale_by_volumes(
    const Array<double>& volume, double rest_volume, int n, const Array<double>& viscous_coefficient) {
    Kokkos::parallel_for(
        "treacle::viscous_volumes", n, KOKKOS_LAMBDA(int i) {
            const double ratio = volume(i) / rest_volume;
            viscous_coefficient(i) *= ratio * ratio;
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
    viscous_coefficient_ = liquid.store.add<Array<double>>("viscous_share", "m2", FieldRole::work);
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
    const auto viscous_coefficient = liquid.store.get<Array<double>>(viscous_coefficient_);
    const double scale = dt / constants.mass * constants.rest_volume;
    double most = 0;
    if (parts.forces.by_particle) {
        most = write_own_coefficients(liquid.viscosity(), scale, n, viscous_coefficient);
    } else {
        with_liquids(constants.immiscible, liquid.liquid(), parts.forces.viscosity,
            [&](const auto& liquids) { most = write_coefficients(liquids, scale, n, viscous_coefficient); });
    }
    most = parts.comm.max(most);
    max_viscous_coefficient_ = most;
    if (most == 0) return 0;
    tiles_are_packed_ = false;
    if (viscosity.form == ViscosityForm::as_published)
        scale_by_volumes(liquid.volume(), constants.rest_volume, n, viscous_coefficient);
    if (slip_.any()) slip_.prepare(parts, parts.points, viscous_coefficient);
    parts.halo.gather(liquid.store, {viscous_coefficient_});
    if (!parts.forces.rheology.empty() || tension_ >= 0) reserve(rate_, static_cast<std::size_t>(n));
    reserve(correction_, static_cast<std::size_t>(n));
    reserve(block_, static_cast<std::size_t>(n));
    for (auto* array : {&inertia_and_wall_diagonal_, &smoothed_viscous_coefficient_})
        reserve(*array, static_cast<std::size_t>(n));
    if (by_gradients(viscosity.form)) reserve(wall_sums_, static_cast<std::size_t>(n));
    const auto inlet = liquid.has_inlets() ? liquid.inlet() : Array<int>();
    if (tension_ >= 0) find_stretched(liquid, viscosity.bulk);
    pack_positions(liquid, viscous_coefficient);
    const auto fluid = make_views(constants, liquid, parts.solid, parts.neighbours);
    // Rows are read several entries at a time, beyond their ends.
    reserve(weights_, static_cast<std::size_t>(parts.neighbours.liquid.size + NeighbourList::padding));
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const ViscousLoop<Kernel> base{kernel, fluid, walls(parts, Walls::resting), weights_, wall_sums_};
        Kokkos::parallel_for("treacle::viscous_prepare", n,
            PrepareLoop<Kernel>{base, viscosity.form, constants.rest_volume, damping_,
                relative_density(constants, liquid), viscous_coefficient, slip_.any(), slip_.drag(),
                liquid.has_inlets(), inlet, bulk_, correction_, block_, inertia_and_wall_diagonal_,
                smoothed_viscous_coefficient_});
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
            const double kept = kept_tension * (tension(i) + static_cast<double>(bulk(i)) * trace(i));
            const bool stays = bulk(i) > 0 && kept > stretched_until * rate(i);
            tension(i) = stays ? kept : trace(i) > stretched_from * rate(i) ? first_tension : 0;
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
    const auto viscous_coefficient = liquid.store.get<Array<double>>(viscous_coefficient_);
    parts.halo.gather(liquid.store, {u_field});
    pack_velocity(liquid, u_field, constants);
    const auto fluid = make_views(constants, liquid, parts.solid, parts.neighbours);
    const auto relative = relative_density(constants, liquid);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const ViscousLoop<Kernel> base{kernel, fluid, walls(parts, which), weights_, wall_sums_};
        if (!by_gradients(form)) {
            Kokkos::parallel_for("treacle::viscous_pairs", fluid.count,
                PairForceLoop<Kernel>{base, relative, wall_pair_force(parts, viscous_coefficient), product});
            return;
        }
        const auto& store = liquid.store;
        const Array3 rows[3] = {
            store.get<Array3>(stress_[0]), store.get<Array3>(stress_[1]), store.get<Array3>(stress_[2])};
        Kokkos::parallel_for("treacle::viscous_stress", row_blocks(fluid.count),
            StressLoop<Kernel>{base, damping_, form == ViscosityForm::as_published, viscous_coefficient, correction_,
                {rows[0], rows[1], rows[2]}, !parts.forces.rheology.empty(), rate_, bulk_, tension(liquid), trace_});
        const Stresses stress{{rows[0], rows[1], rows[2]}};
        stress_interface(parts, which, u_field, stress);
        parts.halo.gather(store, {stress_[0], stress_[1], stress_[2]});
        Kokkos::parallel_for("treacle::viscous_forces", row_blocks(fluid.count),
            StressForceLoop<Kernel>{
                base, damping_, relative, viscous_coefficient, {rows[0], rows[1], rows[2]}, product});
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
