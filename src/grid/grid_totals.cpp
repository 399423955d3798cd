#include "grid/grid_step.hpp"

#include "grid/mac/particle_momentum.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::grid {

namespace {
// Momentum, angular momentum about the origin (particle_momentum.hpp), energies and mass of the particles.
struct TotalsLoop {
    static constexpr int count = 9;
    using value_type = double[];
    using size_type = std::size_t;
    size_type value_count = count;
    MacGrid grid;
    Array3 x, u, c[3];
    Array<int> liquid;
    Array<double> mass;
    double g[3];

    KOKKOS_INLINE_FUNCTION void init(value_type sum) const {
        for (int k = 0; k < count; ++k) sum[k] = 0;
    }
    KOKKOS_INLINE_FUNCTION void join(value_type sum, const value_type other) const {
        for (int k = 0; k < count; ++k) sum[k] += other[k];
    }
    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        const double m = mass(liquid(i));
        const ParticleMotion moves(x, u, c, i);
        for (int a = 0; a < 3; ++a) {
            sum[a] += m * moves.u[a];
            sum[6] += 0.5 * m * moves.u[a] * moves.u[a];
            sum[7] -= m * g[a] * moves.x[a];
        }
        moves.add_angular_momentum(grid, m, sum + 3);
        sum[8] += m;
    }
};
} // namespace

// Over all ranks, with velocities of the middle or of the end of the last step.
std::array<double, 9> GridStep::sums(const Array3& velocity) const {
    const auto& p = particles_;
    TotalsLoop loop;
    loop.grid = grid_;
    loop.x = p.position();
    loop.u = velocity;
    for (int a = 0; a < 3; ++a) {
        loop.c[a] = p.affine(a);
        loop.g[a] = setup_.domain.gravity[static_cast<std::size_t>(a)];
    }
    loop.liquid = p.liquid();
    loop.mass = particle_mass_;
    std::array<double, TotalsLoop::count> sums{};
    Kokkos::parallel_reduce("treacle::grid_totals", p.store.owned(), loop,
        Kokkos::View<double*, Kokkos::HostSpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>>(
            sums.data(), TotalsLoop::count));
    comm_.sum(std::span<double>(sums));
    // 2D scenes: per metre of depth.
    if (grid_.dimensions == 2) std::ranges::for_each(sums, [&](double& sum) { sum /= grid_.dx; });
    return sums;
}

// Sums of a vector of the particles over all ranks.
std::array<double, 3> GridStep::sum_of(const Array3& of) const {
    std::array<double, 3> sum{};
    Kokkos::parallel_reduce(
        "treacle::vector_sum", particles_.store.owned(),
        KOKKOS_LAMBDA(int i, double& x, double& y, double& z) {
            x += of(i, 0);
            y += of(i, 1);
            z += of(i, 2);
        },
        sum[0], sum[1], sum[2]);
    comm_.sum(std::span<double>(sum));
    if (grid_.dimensions == 2) std::ranges::for_each(sum, [&](double& one) { one /= grid_.dx; });
    return sum;
}

EndMotion::Middle GridStep::middle_motion() const {
    EndMotion::Middle out;
    const auto all = sums(particles_.velocity());
    std::copy_n(all.begin(), 6, out.liquid.begin());
    // Angular momenta that were kept are of the middle, before particles were moved.
    if (balances()) std::ranges::copy(sum_of(balance_.kept(particles_)), out.liquid.begin() + 3);
    out.bodies = bodies_.free_momenta();
    return out;
}

LiquidTotals GridStep::totals() const {
    const auto& p = particles_;
    const int n = p.store.owned();
    const auto all = sums(p.end_velocity());
    const auto& momentum = end_motion_.liquid();
    const auto of_bodies = bodies_.moment_of_lead();
    const auto u = p.end_velocity();
    double fastest = 0;
    Kokkos::parallel_reduce(
        "treacle::fastest", n,
        KOKKOS_LAMBDA(
            int i, double& most) { most = math::max(most, u(i, 0) * u(i, 0) + u(i, 1) * u(i, 1) + u(i, 2) * u(i, 2)); },
        Kokkos::Max<double>(fastest));
    LiquidTotals out;
    out.particles = comm_.sum(static_cast<std::int64_t>(n));
    for (std::size_t k = 0; k < 3; ++k) {
        out.momentum[k] = momentum[k];
        out.angular_momentum[k] = momentum[3 + k] - of_bodies[k];
    }
    out.kinetic_energy = all[6];
    out.potential_energy = all[7];
    out.mass = all[8];
    out.max_speed = std::sqrt(comm_.max(n > 0 ? fastest : 0.0));
    return out;
}

std::size_t GridStep::bytes() const {
    std::size_t numbers = distance_.span() + viscosities_.cell.span();
    for (int a = 0; a < 3; ++a) {
        for (const auto* field : {&mass_, &velocity_, &scratch_, &fractions_.face_fluid, &fractions_.face_liquid,
                 &fractions_.face_liquid_clipped, &fractions_.open}) {
            numbers += field->axis[a].span();
        }
        for (const auto* field :
            {&viscosities_.edge, &fractions_.edge_fluid, &fractions_.edge_liquid, &fractions_.edge_liquid_clipped}) {
            numbers += field->axis[a].span();
        }
    }
    numbers += fractions_.cell_fluid.span() + fractions_.cell_liquid.span() + fractions_.cell_liquid_clipped.span();
    numbers += level_set_.distance().span() + 2 * solids_.distance().span();
    return 8 * numbers + particles_.store.bytes() + pressure_.bytes() + viscosity_.bytes() + rheology_.bytes() +
           tensions_.bytes() + curvature_.bytes() + density_relaxation_.bytes() + resting_.bytes() + no_slip_.bytes() +
           resting_pressures_.bytes() + wall_pressures_.bytes() + strains_.bytes() + separation_.bytes() +
           closing_.bytes() + closed_centres_.bytes() + balance_.bytes() + wall_momentum_.bytes();
}

} // namespace treacle::grid
