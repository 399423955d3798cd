#include "sph/model/immiscible_liquids.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace treacle::sph {

namespace {
double harmonic_mean(double a, double b) { return a + b > 0 ? 2 * a * b / (a + b) : 0; }
} // namespace

ImmiscibleLiquids make_immiscible_liquids(std::span<const LiquidMaterial> liquids, Loads loads) {
    if (liquids.empty()) throw std::invalid_argument("no liquids");
    const std::size_t n = liquids.size();
    ImmiscibleLiquids out;
    out.count = static_cast<int>(n);
    out.time_step_factor = time_step_factor(liquids);
    out.density = Array<double>("treacle::liquid_density", n);
    out.viscosity = Array<double>("treacle::liquid_viscosity", n);
    out.pair = Array<double>("treacle::liquid_pairs", ImmiscibleLiquids::tables * n * n);
    auto density = Kokkos::create_mirror_view(out.density), viscosity = Kokkos::create_mirror_view(out.viscosity);
    auto pair = Kokkos::create_mirror_view(out.pair);
    for (std::size_t i = 0; i < n; ++i) {
        const double s = liquids[i].density / liquids.front().density;
        density(i) = s;
        viscosity(i) = liquids[i].viscosity;
        for (std::size_t j = 0; j < n; ++j) {
            const double other = liquids[j].density / liquids.front().density, mean = 2 / (s + other);
            const auto at = [&](std::size_t table) -> double& { return pair((table * n + i) * n + j); };
            at(ImmiscibleLiquids::inverse_density) = mean;
            at(ImmiscibleLiquids::own_pressure_weight) = loads == Loads::adjoint ? 1 / s : mean * (other / s);
            at(ImmiscibleLiquids::other_pressure_weight) = loads == Loads::adjoint ? 1 / s : mean;
            at(ImmiscibleLiquids::pair_viscosity) = harmonic_mean(liquids[i].viscosity, liquids[j].viscosity) / s;
            at(ImmiscibleLiquids::pair_artificial_viscosity) = mean * other;
        }
    }
    Kokkos::deep_copy(out.density, density);
    Kokkos::deep_copy(out.viscosity, viscosity);
    Kokkos::deep_copy(out.pair, pair);
    return out;
}

bool differ(std::span<const LiquidMaterial> liquids) {
    return std::ranges::any_of(liquids, [&](const LiquidMaterial& one) {
        return one.density != liquids.front().density || one.viscosity != liquids.front().viscosity;
    });
}

double time_step_factor(std::span<const LiquidMaterial> liquids) {
    const auto [light, heavy] = std::ranges::minmax(liquids, {}, &LiquidMaterial::density);
    return std::sqrt(light.density / heavy.density);
}

double largest_kinematic_viscosity(std::span<const LiquidMaterial> liquids) {
    double largest = 0;
    for (const auto& one : liquids) {
        for (const auto& other : liquids) {
            largest = std::max(largest, harmonic_mean(one.viscosity, other.viscosity) / one.density);
        }
    }
    return largest;
}

} // namespace treacle::sph
