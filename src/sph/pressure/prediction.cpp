#include "sph/pressure/prediction.hpp"

#include "sph/pressure/laplacian.hpp"
#include "sph/pressure/surface.hpp"

namespace treacle::sph {

namespace {
// Without pressures of a last step, particles predicted to keep their density are unknowns, up to this share of it:
// a liquid at rest has its hydrostatic pressure from the first step on.
constexpr double start_slack = 1e-4;

// Pair sums of one liquid particle that its row of the pressure system is made of.
struct RowSums {
    double divergence = 0;               // sum m (u_i - u_j).grad W + rho0 sum V_s (u_i - u_s).grad W [kg/m3/s]
    double weights = 0;                  // sum_j a_ij [1/m2]
    double weighted = 0;                 // sum_j a_ij p_j [Pa/m2]
    double solid_weights = 0;            // sum_s a_is [1/m2]
    double cover = 0;                    // of the full lattice's sum_j a_ij, what is there, all at rest volumes [1/m2]
    double liquid_vector[3] = {0, 0, 0}; // sum_j V_ij grad W [1/m]
    double wall_vector[3] = {0, 0, 0};   // sum_s V_s grad W [1/m]

    KOKKOS_INLINE_FUNCTION double wall_square() const {
        return wall_vector[0] * wall_vector[0] + wall_vector[1] * wall_vector[1] + wall_vector[2] * wall_vector[2];
    }
    // -b_i of Eq. 2.10: negative where the liquid is off the wall, which would make the matrix indefinite.
    KOKKOS_INLINE_FUNCTION double decomposed() const {
        double sum = wall_square();
        for (int k = 0; k < 3; ++k) sum += liquid_vector[k] * wall_vector[k];
        return math::max(sum, 0.0);
    }
};

template <class Kernel, class Liquids>
struct PredictionLoop {
    LaplacianWeight<Kernel> laplacian;
    Liquids liquids;
    Fluid fluid;
    PressureOptions options;
    LastPressures pressures;
    double dt;
    BodyCoupling coupling;
    Array<double> response;
    Array<double> blended, source, diagonal, wall_term;
    Array<int> role;

    KOKKOS_INLINE_FUNCTION RowSums sums(int i) const {
        const Constants& c = fluid.constants;
        const auto& u = fluid.velocity;
        const auto& v = fluid.solid_velocity;
        const double volume = laplacian.volume(i);
        const double ux = u(i, 0), uy = u(i, 1), uz = u(i, 2);
        const bool decomposed = options.solid_term == SolidTerm::decomposed && fluid.solid.count(i) > 0;
        RowSums out;
        SimdDouble divergence = 0.0, weights = 0.0, weighted = 0.0;
        const Row row = fluid.row(i);
        const auto partners = liquids.partners(i);
        for (int k = 0; k < row.count; k += lanes) {
            const auto d = row.near(k);
            const auto m = fluid.motions(row, k);
            const auto along = distance(d.r2);
            // W' r is grad r^2 here; the matrix computes its a_ij without the division.
            const SimdDouble gradient = row.within(k, laplacian.kernel.gradient(along.r, along.inverse));
            const SimdDouble a =
                partners.conduct(row.index + k, laplacian.weight_of(volume + d.number, d.r2, gradient * d.r2));
            divergence = divergence + gradient * ((ux - m.x) * d.x + (uy - m.y) * d.y + (uz - m.z) * d.z);
            weights = weights + a;
            weighted = weighted + a * m.w;
        }
        out.divergence = c.mass * sum_lanes(divergence);
        out.weights = sum_lanes(weights);
        out.weighted = sum_lanes(weighted);
        if (decomposed) {
            fluid.liquid.each(i, [&](int j, double dx, double dy, double dz, double r2) {
                const double half = 0.5 * (volume + laplacian.volume(j)) * laplacian.kernel.gradient(math::sqrt(r2));
                out.liquid_vector[0] += half * dx;
                out.liquid_vector[1] += half * dy;
                out.liquid_vector[2] += half * dz;
            });
        }
        if (options.dirichlet == DirichletRule::ghosts) out.cover = cover(i);
        double solid = 0;
        const double weight = liquids.density(i);
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            const double r = math::sqrt(r2);
            const double g = laplacian.kernel.gradient(r);
            const double vg = fluid.solid_volume(s) * g;
            const double factor = fluid.carries(s) ? 1 : 0;
            solid += vg * ((ux - factor * v(s, 0)) * dx + (uy - factor * v(s, 1)) * dy + (uz - factor * v(s, 2)) * dz);
            out.solid_weights += laplacian.weight(volume + fluid.solid_volume(s), r2, r) / weight;
            out.wall_vector[0] += vg * dx;
            out.wall_vector[1] += vg * dy;
            out.wall_vector[2] += vg * dz;
        });
        out.divergence += c.rest_density * solid;
        return out;
    }

    KOKKOS_INLINE_FUNCTION double cover(int i) const {
        const double rest = fluid.constants.rest_volume;
        double sum = 0, walls = 0;
        fluid.liquid.each(
            i, [&](int, double, double, double, double r2) { sum += laplacian.weight(2 * rest, r2, math::sqrt(r2)); });
        fluid.solid.each(i, [&](int s, double, double, double, double r2) {
            walls += laplacian.weight(rest + fluid.solid_volume(s), r2, math::sqrt(r2));
        });
        return sum + fluid.constants.wall_laplacian_factor * walls;
    }

    KOKKOS_INLINE_FUNCTION double solid_term(int i, const RowSums& sum) const {
        if (options.solid_term == SolidTerm::none || options.solid_term == SolidTerm::unknowns) return 0;
        // The exact source needs the last pressures; without them only the Neumann problem itself is exact.
        const bool starting = pressures == LastPressures::none && options.solid_term == SolidTerm::exact;
        if (starting && sum.weights > 0) return 0;
        if (options.solid_term == SolidTerm::decomposed) return sum.decomposed() / liquids.density(i);
        const double ratio = fluid.constants.rest_density / fluid.constants.mass * fluid.volume(i);
        return fluid.constants.wall_pressure_factor * ratio * ratio * sum.wall_square() /
               liquids.density(i); // alpha_i of Eq. 3.2
    }

    // Addition to the diagonal by neighbours at zero pressure in the place of those that lack (src/sph/theory.md).
    KOKKOS_INLINE_FUNCTION double ghost_term(int i, const RowSums& sum) const {
        if (options.dirichlet != DirichletRule::ghosts) return 0;
        return math::max(0.0, fluid.constants.laplacian_diagonal - sum.cover) / liquids.density(i);
    }

    // `weights` are those of the system without walls.
    KOKKOS_INLINE_FUNCTION double right_hand_side(
        int i, const RowSums& sum, double b, double alpha, double weights, double answered) const {
        if (alpha == 0 || sum.weights == 0) return b;
        const double gain = math::min(options.amplification_limit - 1, alpha / weights);
        const double amplified = b + gain * b;
        if (options.solid_term == SolidTerm::amplified) return amplified + alpha * fluid.pressure(i); // (3.3)
        // Without p_i = p_j: the fixed point is that of the system without alpha. The bodies' response is a source as
        // b is, and bounded as that: a particle at a body may have hardly a neighbour.
        if (options.solid_term == SolidTerm::exact) return amplified - gain * answered + alpha * sum.weighted / weights;
        return b;
    }

    // (S6) True when a particle with neighbours is an unknown.
    KOKKOS_INLINE_FUNCTION bool unknown(int i, const RowSums& sum, double predicted, double answered) const {
        const double rest = fluid.constants.rest_density;
        switch (options.dirichlet) {
        case DirichletRule::ghosts: return true;
        case DirichletRule::surface: return role(i) == Role::poisson; // as mark_surface left it
        case DirichletRule::density: return blended(i) / liquids.density(i) >= options.surface_density * rest;
        case DirichletRule::predicted_density: return predicted >= options.surface_density * rest;
        case DirichletRule::source:
        case DirichletRule::complementarity: // where the search starts
        case DirichletRule::predicted: break;
        }
        double numerator = (predicted - rest) / (dt * dt); // (2.6), times the positive denominator
        if (pressures == LastPressures::none) {
            numerator += start_slack * rest / (dt * dt);
        } else if (options.dirichlet != DirichletRule::source) {
            numerator += options.prediction * (sum.weighted + fluid.pressure(i) * sum.solid_weights - answered);
        }
        return numerator > 0;
    }

    KOKKOS_INLINE_FUNCTION void operator()(int i, int& poissons, int& separates) const {
        const RowSums sum = sums(i);
        const double rest = fluid.constants.rest_density;
        const double excess = liquids.recovered(blended(i) / liquids.density(i) - rest, dt);
        const double predicted = rest + (excess + dt * sum.divergence); // (2.4), over the liquid's share of rest
        double b = (predicted - rest) / (dt * dt);
        const bool pushed = b > 0;
        if (options.clamping == Clamping::sources) b = math::max(b, 0.0);
        const double alpha = solid_term(i, sum);
        const double answered = coupling == BodyCoupling::strong ? response(i) : 0;
        const bool linked = options.solid_term == SolidTerm::unknowns && sum.solid_weights > 0;
        const double ghosts = sum.weights > 0 || linked ? ghost_term(i, sum) : 0;
        const double weights = sum.weights + ghosts;
        wall_term(i) = alpha + ghosts;
        diagonal(i) = weights + alpha + (linked ? sum.solid_weights : 0);
        source(i) = right_hand_side(i, sum, b, alpha, weights, answered);
        if (sum.weights > 0 || linked) {
            role(i) = unknown(i, sum, predicted, answered) ? Role::poisson : Role::dirichlet;
        } else {
            role(i) = alpha > 0 && pushed ? Role::separated : Role::dirichlet;
        }
        poissons += static_cast<int>(role(i) == Role::poisson);
        separates += static_cast<int>(role(i) == Role::separated);
    }
};
} // namespace

RoleCounts predict(const StepContext& parts, LastPressures pressures, double dt, BodyCoupling coupling) {
    const auto& options = parts.options;
    const auto& constants = parts.constants;
    auto& liquid = parts.liquid;
    pack_positions(liquid, liquid.volume());
    pack_velocities(liquid);
    if (options.pressure.dirichlet == DirichletRule::surface)
        mark_surface(constants, liquid, parts.solid, parts.neighbours);
    const auto fluid = make_views(constants, liquid, parts.solid, parts.neighbours);
    int poissons = 0, separates = 0;
    with_kernel(options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        with_liquids(constants.immiscible, liquid.liquid(), 0, [&](const auto& liquids) {
            using Liquids = std::decay_t<decltype(liquids)>;
            Kokkos::parallel_reduce("treacle::predict", fluid.count,
                PredictionLoop<Kernel, Liquids>{laplacian_weight(kernel, constants, liquid), liquids, fluid,
                    options.pressure, pressures, dt, coupling, liquid.response(), liquid.blended_density(),
                    liquid.source(), liquid.diagonal(), liquid.wall_term(), liquid.role()},
                poissons, separates);
        });
    });
    return {poissons, fluid.count - poissons - separates, separates};
}

RoleCounts count_roles(const LiquidParticles& liquid) {
    const auto role = liquid.role();
    const int n = liquid.store.owned();
    int poissons = 0, separates = 0;
    Kokkos::parallel_reduce(
        "treacle::count_roles", n,
        KOKKOS_LAMBDA(int i, int& poisson, int& separate) {
            poisson += static_cast<int>(role(i) == Role::poisson);
            separate += static_cast<int>(role(i) == Role::separated);
        },
        poissons, separates);
    return {poissons, n - poissons - separates, separates};
}

} // namespace treacle::sph
