#pragma once
#include "kokkos/simd.hpp"

#include <span>

namespace treacle::sph {

// One of the liquids of a scene.
struct LiquidMaterial {
    double density = 1000; // at rest [kg/m3]
    double viscosity = 0;  // [Pa s]
};

// Several liquids in one scene. Every particle has the same rest volume, so that its density over its rest density,
// the sum of V0 W, does not depend on the masses of the particles around it: no false pressure stands where two liquids
// meet (Solenthaler & Pajarola 2008). In the sums of the pressure system, densities are therefore those of particles
// that all weigh the first liquid's mass; what a particle truly weighs enters where forces become accelerations.
// Formulas: README. Empty for one liquid.
struct ImmiscibleLiquids {
    // Coefficients of liquid i beside liquid j, with their densities s over the first one's and their viscosities.
    enum Table {
        inverse_density,           // 2 / (s_i + s_j): symmetric
        own_pressure_weight,       // 2 s_j / (s_i (s_i + s_j)): of the own pressure in the acceleration, or 1 / s_i
        other_pressure_weight,     // the inverse density: of the neighbour's, or 1 / s_i
        pair_viscosity,            // harmonic mean of the viscosities over s_i [Pa s]
        pair_artificial_viscosity, // 2 s_j / (s_i + s_j)
        tables
    };
    int count = 1;
    // Time in which a compressed particle expands again, when a step is shorter [s]. A light one between a heavy liquid
    // and a wall would take all the speed that expansion within a short step requires, and make the next step shorter.
    double relaxation_time = 0;
    // Factor on the step of one liquid: the root of the lightest over the heaviest density. The pressure that stops a
    // heavy liquid moves a light one faster by its inverse.
    double time_step_factor = 1;
    Array<double> density;   // [count] over Constants::rest_density
    Array<double> viscosity; // [count] [Pa s]
    Array<double> pair;      // [tables][count][count]

    KOKKOS_INLINE_FUNCTION bool several() const { return count > 1; } // false: OneLiquid applies
};

// For liquids whose first one has the density of Constants. Throws std::invalid_argument without liquids. Needs Kokkos.
// With Loads::adjoint forces between liquids do the work that their compression takes, as IISPH requires.
enum class Loads { conducted, adjoint };
ImmiscibleLiquids make_immiscible_liquids(std::span<const LiquidMaterial> liquids, Loads loads = Loads::conducted);

// True when the liquids differ, so that make_immiscible_liquids is needed.
bool differ(std::span<const LiquidMaterial> liquids);

// ImmiscibleLiquids::step_share of the liquids.
double time_step_factor(std::span<const LiquidMaterial> liquids);

// Largest viscosity over density of the less viscous one, over all pairs of liquids [m2/s].
double largest_kinematic_viscosity(std::span<const LiquidMaterial> liquids);

// Rest density of a particle's liquid over the first liquid's.
struct RelativeDensity {
    bool several;          // false: the ratio is 1
    Array<int> liquid;     // [particles] number of the liquid
    Array<double> density; // [liquids] over that of the first [1]

    KOKKOS_INLINE_FUNCTION double operator()(int i) const { return several ? density(liquid(i)) : 1.0; }
};

// Terms of a pair without differing liquids: unchanged.
struct OneLiquid {
    // Terms of one particle's pairs: coefficient of the pressure system; p/rho^2 of both particles; approach times the
    // viscous coefficient, and that of pairs that come nearer times the artificial one.
    struct Partners {
        KOKKOS_INLINE_FUNCTION SimdDouble conduct(const int*, SimdDouble a) const { return a; }
        KOKKOS_INLINE_FUNCTION SimdDouble loads(const int*, double own, SimdDouble other) const { return own + other; }
        KOKKOS_INLINE_FUNCTION SimdDouble drag(
            const int*, double pair_viscosity, double pair_artificial_viscosity, SimdDouble approach) const {
            return pair_viscosity * approach + pair_artificial_viscosity * math::min(approach, SimdDouble(0.0));
        }
    };
    double viscosity_; // [Pa s]

    // Terms of the pairs of particle i; coefficients of a pair (i, j) and of a particle i, 1 with one liquid.
    KOKKOS_INLINE_FUNCTION Partners partners(int) const { return {}; }
    KOKKOS_INLINE_FUNCTION double inverse_density(int, int) const { return 1; }
    KOKKOS_INLINE_FUNCTION double pair_artificial_viscosity(int, int) const { return 1; }
    KOKKOS_INLINE_FUNCTION double density(int) const { return 1; }
    // Viscosity of particle i [Pa s]; excess of density that a step takes back.
    KOKKOS_INLINE_FUNCTION double viscosity(int) const { return viscosity_; }
    KOKKOS_INLINE_FUNCTION double recovered(double excess, double) const { return excess; }
    // Factor of the terms of OneLiquid::Partners::drag that the viscosity enters by.
    KOKKOS_INLINE_FUNCTION double scale() const { return viscosity_; }
};

// The same for several liquids; `index` points at the first of some neighbours in a row of a list.
struct SeveralLiquids {
    // As OneLiquid::Partners, with the entries of the tables that belong to the liquids of each pair.
    struct Partners {
        const int* liquid; // [particles]
        const double* row; // of the first table, for the particle's own liquid
        int stride;        // between tables

        // Entries of one table, one for each neighbour.
        KOKKOS_INLINE_FUNCTION SimdDouble of(ImmiscibleLiquids::Table table, const int* index) const {
            const SimdInt which = gather_ints(liquid, load_ints(index));
            return gather_lanes(row + table * stride, which);
        }

        // Terms as those of OneLiquid::Partners.
        KOKKOS_INLINE_FUNCTION SimdDouble conduct(const int* index, SimdDouble a) const {
            return a * of(ImmiscibleLiquids::inverse_density, index);
        }
        KOKKOS_INLINE_FUNCTION SimdDouble loads(const int* index, double own, SimdDouble other) const {
            return own * of(ImmiscibleLiquids::own_pressure_weight, index) +
                   other * of(ImmiscibleLiquids::other_pressure_weight, index);
        }
        KOKKOS_INLINE_FUNCTION SimdDouble drag(
            const int* index, double pair_viscosity, double pair_artificial_viscosity, SimdDouble approach) const {
            return pair_viscosity * of(ImmiscibleLiquids::pair_viscosity, index) * approach +
                   pair_artificial_viscosity * of(ImmiscibleLiquids::pair_artificial_viscosity, index) *
                       math::min(approach, SimdDouble(0.0));
        }
    };
    ImmiscibleLiquids immiscible; // with its tables
    Array<int> liquid;            // [particles]
    double viscous = 1;           // 0: as if none had a viscosity

    // As in OneLiquid; of() is one entry of the table of pairs.
    KOKKOS_INLINE_FUNCTION Partners partners(int i) const {
        return {
            liquid.data(), immiscible.pair.data() + liquid(i) * immiscible.count, immiscible.count * immiscible.count};
    }
    KOKKOS_INLINE_FUNCTION double of(ImmiscibleLiquids::Table table, int i, int j) const {
        return immiscible.pair((table * immiscible.count + liquid(i)) * immiscible.count + liquid(j));
    }
    KOKKOS_INLINE_FUNCTION double inverse_density(int i, int j) const {
        return of(ImmiscibleLiquids::inverse_density, i, j);
    }
    KOKKOS_INLINE_FUNCTION double pair_artificial_viscosity(int i, int j) const {
        return of(ImmiscibleLiquids::pair_artificial_viscosity, i, j);
    }
    KOKKOS_INLINE_FUNCTION double density(int i) const { return immiscible.density(liquid(i)); }
    KOKKOS_INLINE_FUNCTION double viscosity(int i) const { return viscous * immiscible.viscosity(liquid(i)); }
    // The part of a density beyond the rest density that a step takes back.
    KOKKOS_INLINE_FUNCTION double recovered(double excess, double dt) const {
        return excess > 0 && dt < immiscible.relaxation_time ? excess * (dt / immiscible.relaxation_time) : excess;
    }
    KOKKOS_INLINE_FUNCTION double scale() const { return viscous; }
};

// Calls work(pairing) with a OneLiquid or a SeveralLiquids, so that one liquid costs nothing more. Without a
// viscosity [Pa s] none of several has any.
template <class Work>
void with_liquids(const ImmiscibleLiquids& immiscible, const Array<int>& liquid, double viscosity, const Work& work) {
    if (immiscible.several()) {
        work(SeveralLiquids{immiscible, liquid, viscosity > 0 ? 1.0 : 0.0});
    } else {
        work(OneLiquid{viscosity});
    }
}

} // namespace treacle::sph
