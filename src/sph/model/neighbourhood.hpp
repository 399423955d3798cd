#pragma once
#include "kokkos/neighbour_list.hpp"
#include "sph/model/gradient_correction.hpp"
#include "sph/model/immiscible_liquids.hpp"
#include "sph/model/options.hpp"
#include "sph/model/particles.hpp"

namespace treacle::sph {

// The constants of a run that every pair sum needs.
struct Constants {
    double support = 0;               // h [m]
    double spacing = 0;               // d [m]
    double mass = 0;                  // m [kg], [kg/m] in 2D; of the first liquid
    double rest_density = 0;          // rho0 [kg/m3]; of the first liquid
    double rest_volume = 0;           // V0 [m^D]
    double number_density = 0;        // n0
    double laplacian_diagonal = 0;    // sum_j a_ij on the full lattice [1/m2]
    double wall_laplacian_factor = 1; // how many times a_is count as cover (lattice.hpp)
    double wall_pressure_factor = 1;  // how many times Akinci's one-sided pressure of solids acts (lattice.hpp)
    double wall_viscous_factor = 1;   // how many times V_s counts in the viscous sums (lattice.hpp)
    double wall_kernel_sum = 0;       // sum of V0 |W'|/r of the lattice over a particle of a plane wall [1/m2]
    double wall_volume = 0;           // V_s of a plane wall [m^D]
    double wall_packing = 1;          // factor on V_s of solids at rest in all but viscous sums (density.hpp)
    double wall_depth = 0;            // of the layer of solid particles below the surface [m]
    int dimensions = 3;
    ImmiscibleLiquids immiscible; // of several liquids, otherwise empty
    int conveyors = 0; // solids with numbers below it move along themselves: their particles stay, and carry no volume
};

// The neighbours of one step: liquid around liquid, solid around liquid.
struct Neighbourhood {
    NeighbourList liquid;
    NeighbourList solid;
};

// Copies positions and a number of each owned and ghost particle, or velocities and pressures, to where pair sums
// read them.
void pack_positions(LiquidParticles& liquid, const Array<double>& number);
void pack_velocities(LiquidParticles& liquid);

// The liquid particles around one particle, several at a time: for (int k = 0; k < row.count; k += lanes).
struct Row {
    const int* index;
    int count;
    double x, y, z;                // of the particle [m]
    const double* packed_position; // [particles][4], LiquidParticles::packed_position

    // Differences of positions [m], their square [m2].
    struct Near {
        SimdDouble x, y, z, r2; // from the neighbours to the particle
        SimdDouble number;      // the fourth one of `place`
    };
    // Neighbours from the k-th one on.
    KOKKOS_INLINE_FUNCTION Near near(int k) const {
        const Quads q = gather_quads(packed_position, index + k);
        const SimdDouble dx = x - q.x, dy = y - q.y, dz = z - q.z;
        return {dx, dy, dz, dx * dx + dy * dy + dz * dz, q.w};
    }
    // Lanes beyond the end of the row hold some other pair: what is summed must be 0 there.
    KOKKOS_INLINE_FUNCTION SimdDouble within(int k, SimdDouble term) const {
        return select(tail_mask(count - k), term, 0.0);
    }
};

// Pair sums over a list, for kernels: visit(j, dx, dy, dz, r2) with the vector from x_j to x_i.
struct Pairs {
    Array<std::int64_t> offset; // [owned + 1]
    Array<int> index;           // [entries] of `among`
    Array3 of, among;           // [particles][3] positions [m]

    // Number of neighbours of particle i; its row, with the packed positions of the neighbours.
    KOKKOS_INLINE_FUNCTION int count(int i) const { return static_cast<int>(offset(i + 1) - offset(i)); }
    KOKKOS_INLINE_FUNCTION Row row(int i, const Array4& packed_position) const {
        return {index.data() + offset(i), count(i), of(i, 0), of(i, 1), of(i, 2), packed_position.data()};
    }

    // Calls visit(j, dx, dy, dz, r2) for each neighbour, in the order of the list: differences [m], their square [m2].
    template <class Visit>
    KOKKOS_INLINE_FUNCTION void each(int i, const Visit& visit) const {
        const double x = of(i, 0), y = of(i, 1), z = of(i, 2);
        const std::int64_t last = offset(i + 1);
        for (std::int64_t k = offset(i); k < last; ++k) {
            const int j = index(k);
            const double dx = x - among(j, 0), dy = y - among(j, 1), dz = z - among(j, 2);
            visit(j, dx, dy, dz, dx * dx + dy * dy + dz * dz);
        }
    }
};

// Ratio of each particle's rest density to the first liquid's; shares the fields.
inline RelativeDensity relative_density(const Constants& constants, const LiquidParticles& liquid) {
    return {constants.immiscible.several(), liquid.liquid(), constants.immiscible.density};
}

// Pairs of the list from the particles `of` to those `among`; shares its arrays and their positions.
inline Pairs pairs(const NeighbourList& list, const ParticleStore& of, const ParticleStore& among) {
    return {list.offset, list.index, of.position(), among.position()};
}

// Everything a loop over the liquid reads, gathered once per step.
struct Fluid {
    Constants constants;
    Pairs liquid, solid;
    Array4 packed_position, motion;       // [particles][4] LiquidParticles::packed_position, motion
    Array3 velocity;                      // [particles][3] [m/s]
    Array<double> pressure, volume, load; // [particles] [Pa], [m^D], p/rho^2 [Pa m6/kg2]
    Array3 solid_velocity;                // [solids][3] [m/s]
    Array<double> solid_volume;           // [solids] V_s [m^D]
    Array<int> solid_body;                // [solids] number of the body, 0: walls of the domain
    GradientCorrection correction;        // of the gradients of pressures
    int count;                            // owned liquid particles

    // True when the velocity of a solid particle is that of its place.
    KOKKOS_INLINE_FUNCTION bool carries(int s) const {
        return constants.conveyors == 0 || solid_body(s) >= constants.conveyors;
    }
    KOKKOS_INLINE_FUNCTION Row row(int i) const { return liquid.row(i, packed_position); }
    KOKKOS_INLINE_FUNCTION Quads motions(const Row& row, int k) const {
        return gather_quads(motion.data(), row.index + k);
    }
};

// Views of the corrections, or none.
inline GradientCorrection view_correction(const LiquidParticles& liquid, const SolidParticles& solid) {
    if (!liquid.has_gradient_correction()) return {};
    return {liquid.correction_diagonal(), liquid.correction_off_diagonal(), liquid.correction_weight(), solid.normal()};
}

// Views of all that, without a copy.
inline Fluid make_views(const Constants& constants, const LiquidParticles& liquid, const SolidParticles& solid,
    const Neighbourhood& neighbours) {
    return {constants, pairs(neighbours.liquid, liquid.store, liquid.store),
        pairs(neighbours.solid, liquid.store, solid.store), liquid.packed_position, liquid.motion, liquid.velocity(),
        liquid.pressure(), liquid.volume(), liquid.load(), solid.velocity(), solid.volume(), solid.body(),
        view_correction(liquid, solid), liquid.store.owned()};
}

} // namespace treacle::sph
