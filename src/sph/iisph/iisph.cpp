#include "sph/iisph/iisph.hpp"

#include "base/text/clock.hpp"
#include "kokkos/quad.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace treacle::sph {

namespace {
// Weight of the Jacobi iteration, and share of the last pressures that it starts from (Ihmsen et al. 2014).
constexpr double published_weight = 0.5;
constexpr double warm_start = 0.5;
// Particles with fewer neighbours than that share of the lattice's need not be free of divergence: about the 20 of 30 that
// SPlisHSPlasH asks for.
constexpr double least_neighbours = 2.0 / 3;
// Weight times largest eigenvalue on the lattice: disorder raises eigenvalues by a quarter, and 2 diverges.
constexpr double stable_product = 1.5;
// As published: without them a step may end before a pressure wave has started.
constexpr int least_iterations = 2;
// Liquid thinner than at rest by less than that many times `density_error` counts as full: compression and gaps that a solve leaves
// would let a tank fall freely in one step and hold it twice as hard in the next.
constexpr double slack_factor = 5;
// Diagonals added to A for the shift: an excess that is everywhere, as in a box that is too full, gives no shift.
constexpr double shift_softness = 0.1;
// Liquid that something else than gravity drives may be compressed by `density_error` while it moves by a spacing in a liquid of so
// many spacings across, in inverse proportion in a wider one: what a lid or an inlet brings into one corner of the liquid is little
// of the mean, and what is let in there does not turn the rest.
constexpr double narrow = 6;
// A solid bears liquid if its normal is nearer to the vertical than this sine away from the horizontal.
constexpr double least_slope = 0.2;
// Jacobi takes that many times the iterations of spectral gradients.
constexpr int jacobi_patience = 20;

// m grad W of the pairs, in single precision: a product reads 16 bytes a pair and is as long as these take to come.
struct Gradients {
    Array<float> x, y, z;

    struct Near {
        Lanes x, y, z;
    };
    // Gradients of the pairs from entry k of the list on; lanes beyond the end of the row hold others.
    KOKKOS_INLINE_FUNCTION Near near(std::int64_t k) const {
        return {load_lanes(x.data() + k), load_lanes(y.data() + k), load_lanes(z.data() + k)};
    }
};

// g, the diagonal, which rows are watched, the gradients.
template <class Kernel>
struct PairLoop {
    Kernel kernel;
    Fluid fluid;
    bool bearing; // only rows above solids are watched
    double gravity[3];
    RelativeDensity relative;
    Gradients gradients;
    Array<double> diagonal, watched;
    Array3 own, force;

    // True when solids, whose part of g is g - liquid, are below.
    KOKKOS_INLINE_FUNCTION bool bears(const double g[3], const double liquid[3]) const {
        double along = 0, square = 0, pull = 0;
        for (int k = 0; k < 3; ++k) {
            const double wall = g[k] - liquid[k];
            along += gravity[k] * wall;
            square += wall * wall;
            pull += gravity[k] * gravity[k];
        }
        return along > 0 && along * along > least_slope * least_slope * square * pull;
    }

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const Constants& c = fluid.constants;
        const Row row = fluid.row(i);
        const std::int64_t first = fluid.liquid.offset(i);
        Lanes square = 0.0, gx = 0.0, gy = 0.0, gz = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const auto d = row.near(k);
            const auto along = distance(d.r2);
            const Lanes gradient = row.within(k, c.mass * kernel.gradient(along.r, along.inverse));
            const Lanes x = rounded(gradient * d.x), y = rounded(gradient * d.y), z = rounded(gradient * d.z);
            store_floats(x, row.count - k, gradients.x.data() + first + k);
            store_floats(y, row.count - k, gradients.y.data() + first + k);
            store_floats(z, row.count - k, gradients.z.data() + first + k);
            square = square + (x * x + y * y + z * z);
            gx = gx + x;
            gy = gy + y;
            gz = gz + z;
        }
        const double liquid[3] = {sum_lanes(gx), sum_lanes(gy), sum_lanes(gz)};
        double g[3] = {liquid[0], liquid[1], liquid[2]};
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            const double gradient = c.rest_density * fluid.solid_volume(s) * kernel.gradient(math::sqrt(r2));
            g[0] += gradient * dx;
            g[1] += gradient * dy;
            g[2] += gradient * dz;
        });
        for (int k = 0; k < 3; ++k) {
            own(i, k) = g[k];
            force(i, k) = liquid[k] + c.wall_push * (g[k] - liquid[k]);
        }
        watched(i) = !bearing || bears(g, liquid) ? 1 : 0;
        diagonal(i) = (sum_lanes(square) + g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) / relative(i);
    }
};

template <class Kernel>
struct SourceLoop {
    Kernel kernel;
    Fluid fluid;
    double dt;
    Iisph::Aim aim;
    double needed; // neighbours
    double slack;  // [kg/m3] of Aim::approach
    RelativeDensity relative;
    Gradients gradients;
    Array<double> density, source, diagonal;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const Constants& c = fluid.constants;
        const auto &u = fluid.velocity, &v = fluid.solid_velocity;
        const double ux = u(i, 0), uy = u(i, 1), uz = u(i, 2);
        const Row row = fluid.row(i);
        const std::int64_t first = fluid.liquid.offset(i);
        Lanes divergence = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const auto w = fluid.motions(row, k);
            const auto g = gradients.near(first + k);
            divergence = divergence + row.within(k, g.x * (ux - w.x) + g.y * (uy - w.y) + g.z * (uz - w.z));
        }
        double change = sum_lanes(divergence);
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            const double gradient = c.rest_density * fluid.solid_volume(s) * kernel.gradient(math::sqrt(r2));
            const double share = fluid.carries(s) ? 1 : 0;
            change += gradient * ((ux - share * v(s, 0)) * dx + (uy - share * v(s, 1)) * dy + (uz - share * v(s, 2)) * dz);
        });
        if (aim != Iisph::Aim::divergence) {
            const double excess = density(i) / relative(i) - c.rest_density;
            source(i) = ((aim == Iisph::Aim::approach ? math::min(excess + slack, 0.0) : excess) + dt * change) / (dt * dt); // (2.4)
        } else {
            source(i) = change / dt;
            if (row.count + fluid.solid.count(i) < needed) diagonal(i) = 0;
        }
    }
};

// q -> a, of the owned and ghost particles' `load`.
struct AccelerationLoop {
    Fluid fluid;
    RelativeDensity relative;
    Array<int> inlet; // of each particle, or empty
    Gradients gradients;
    Array3 force, acceleration;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const Row row = fluid.row(i);
        const std::int64_t first = fluid.liquid.offset(i);
        Lanes fx = 0.0, fy = 0.0, fz = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const Lanes q = row.within(k, gather_lanes(fluid.load.data(), load_ints(row.index + k)));
            const auto g = gradients.near(first + k);
            fx = fx + q * g.x;
            fy = fy + q * g.y;
            fz = fz + q * g.z;
        }
        const double q = fluid.load(i);
        const double sum[3] = {sum_lanes(fx), sum_lanes(fy), sum_lanes(fz)};
        const bool prescribed = inlet.size() > 0 && inlet(i) > 0;
        const double inverse_density = prescribed ? 0 : 1 / relative(i);
        for (int k = 0; k < 3; ++k) {
            const double a = inverse_density * (-q * force(i, k) - sum[k]);
            acceleration(i, k) = a;
            fluid.motion(i, k) = a;
        }
    }
};

// a -> A q; a_j is `motion`.
struct DensityChangeLoop {
    Fluid fluid;
    Gradients gradients;
    Array3 own;
    Array<double> product;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const Row row = fluid.row(i);
        const std::int64_t first = fluid.liquid.offset(i);
        Lanes sum = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const auto a = fluid.motions(row, k);
            const auto g = gradients.near(first + k);
            sum = sum + row.within(k, a.x * g.x + a.y * g.y + a.z * g.z);
        }
        double out = sum_lanes(sum);
        for (int k = 0; k < 3; ++k) out -= fluid.motion(i, k) * own(i, k);
        product(i) = out;
    }
};

void write_loads(LiquidParticles& liquid, const Array<double>& q) {
    const auto load = liquid.load();
    Kokkos::parallel_for("treacle::iisph_loads", liquid.store.owned(), KOKKOS_LAMBDA(int i) { load(i) = q(i); });
}

void write_ghost_accelerations(LiquidParticles& liquid) {
    const auto a = liquid.acceleration();
    const auto to = liquid.motion;
    using Range = Kokkos::RangePolicy<Execution>;
    Kokkos::parallel_for("treacle::iisph_ghosts", Range(liquid.store.owned(), liquid.store.total()),
                         KOKKOS_LAMBDA(int i) {
                             for (int k = 0; k < 3; ++k) to(i, k) = a(i, k);
                         });
}

// Density of the pair sums: m over the volume, of whatever liquid.
struct SumDensity {
    Array<double> volume;
    double mass;
    KOKKOS_INLINE_FUNCTION double operator()(int i) const { return mass / volume(i); }
    KOKKOS_INLINE_FUNCTION double square(int i) const { return (*this)(i) * (*this)(i); }
};
SumDensity sum_density(const StepParts& parts) { return {parts.liquid.volume(), parts.constants.mass}; }

struct Guess {
    Array<double> pressure; // [owned] of the last solve [Pa]
    double factor;          // on it
};

// Writes the guess as q; returns how many b > 0.
double write_guess(const StepParts& parts, const Guess& guess, const Array<double>& q, const Array<double>& diagonal) {
    const auto rho = sum_density(parts);
    const auto p = guess.pressure, b = parts.liquid.source();
    const double factor = guess.factor;
    const int n = parts.liquid.store.owned();
    double compressed = 0;
    Kokkos::parallel_reduce("treacle::iisph_start", n, KOKKOS_LAMBDA(int i, double& count) {
        q(i) = diagonal(i) > 0 ? factor * math::max(0.0, p(i)) / rho.square(i) : 0;
        if (b(i) > 0 && diagonal(i) > 0) count += 1;
    }, compressed);
    return parts.comm.sum(n > 0 ? compressed : 0.0);
}

// The norm of the watched residual without pressures: `gradient` is -b then.
double reference_norm(const StepParts& parts, const BoundedProblem& problem, const Array<double>& gradient) {
    const auto b = problem.right_hand_side;
    Kokkos::parallel_for("treacle::iisph_reference", problem.rows, KOKKOS_LAMBDA(int i) { gradient(i) = -b(i); });
    return std::sqrt(watched_square(parts.comm, problem, gradient));
}

// product += softness D q
void add_softness(int rows, double softness, const Array<double>& diagonal, const Array<double>& q, const Array<double>& product) {
    Kokkos::parallel_for("treacle::iisph_softness", rows, KOKKOS_LAMBDA(int i) { product(i) += softness * diagonal(i) * q(i); });
}

// scaled = rho q: rows of BodyResponse have 1 / rho.
void multiply_by_density(const StepParts& parts, const Array<double>& q, const Array<double>& scaled) {
    const auto rho = sum_density(parts);
    Kokkos::parallel_for("treacle::iisph_pressed", parts.liquid.store.owned(), KOKKOS_LAMBDA(int i) { scaled(i) = q(i) * rho(i); });
}

// product += rho response
void add_response(const StepParts& parts, const Array<double>& response, const Array<double>& product) {
    const auto rho = sum_density(parts);
    Kokkos::parallel_for("treacle::iisph_answer", parts.liquid.store.owned(), KOKKOS_LAMBDA(int i) { product(i) += response(i) * rho(i); });
}

RoleCounts write_pressures(const StepParts& parts, const Array<double>& q) {
    const auto rho = sum_density(parts);
    const auto p = parts.liquid.pressure();
    const auto role = parts.liquid.role();
    const int n = parts.liquid.store.owned();
    int pressed = 0;
    Kokkos::parallel_reduce("treacle::iisph_pressures", n, KOKKOS_LAMBDA(int i, int& count) {
        p(i) = q(i) * rho.square(i);
        role(i) = q(i) > 0 ? Role::poisson : Role::dirichlet;
        count += static_cast<int>(q(i) > 0);
    }, pressed);
    return {pressed, n - pressed, 0};
}

// Collective. The mean compression at which a solve for velocities stops; gravity_drives: rows above solids that bear them are watched.
double driven_tolerance(const StepParts& parts, bool gravity_drives) {
    const auto& options = parts.options.pressure;
    if (options.density_error > 0) return options.density_error;
    if (gravity_drives && !parts.driven) return options.density_tolerance();
    const auto particles = parts.comm.sum(static_cast<std::int64_t>(parts.liquid.store.owned()));
    const double across = std::pow(static_cast<double>(particles), 1.0 / parts.constants.dimensions);
    return options.density_tolerance() * std::min(1.0, narrow / across);
}

struct Tolerances {
    double density;   // mean compression
    double reference; // the watched residual without pressures, 0 where the density's rule is enough
};

// The stopping rules of the pressure solve.
BoundedGoal goal_of(const SphOptions& options, const Constants& constants, double dt, const Tolerances& tolerances) {
    const auto& pressure = options.pressure;
    const double reference = tolerances.reference;
    BoundedGoal goal;
    const bool jacobi = pressure.solver != PressureSolver::iisph;
    goal.least_iterations = jacobi ? least_iterations : 0;
    goal.max_iterations = (jacobi ? jacobi_patience : 1) * pressure.max_iterations;
    if (pressure.stop == StoppingRule::residual) {
        goal.met = [=, to = pressure.residual](const BoundedResidual& r) { return std::sqrt(r.square) <= to * reference; };
    } else {
        const double scale = dt * dt / constants.rest_density;
        goal.met = [=, to = tolerances.density, largest = pressure.residual_tolerance()](const BoundedResidual& r) {
            const bool dense = r.excess * scale < to * std::max(1.0, r.count);
            return dense && (reference == 0 || std::sqrt(r.square) <= largest * reference);
        };
    }
    return goal;
}

// Of the divergence-free solve: b dt^2 / rho0 is the compression that the velocity has in a step.
BoundedGoal divergence_goal(const SphOptions& options, const Constants& constants, double dt) {
    const double scale = dt * dt / constants.rest_density;
    const auto met = [=, to = options.pressure.divergence_error](const BoundedResidual& r) {
        return r.excess * scale < to * std::max(1.0, r.count);
    };
    return {met, 1, jacobi_patience * options.pressure.max_iterations};
}

int lattice_neighbours(const Constants& constants) {
    const int reach = static_cast<int>(constants.support / constants.spacing);
    const int third = constants.dimensions == 3 ? reach : 0;
    int count = -1; // itself
    for (int z = -third; z <= third; ++z) {
        for (int y = -reach; y <= reach; ++y) {
            for (int x = -reach; x <= reach; ++x) {
                count += constants.spacing * std::sqrt(double(x * x + y * y + z * z)) < constants.support ? 1 : 0;
            }
        }
    }
    return count;
}

// Largest eigenvalue of A scaled by its diagonal in an endless lattice: for wave numbers k,
// |sum_j grad W_j sin(k.x_j)|^2 / sum_j |grad W_j|^2.
template <class Kernel>
double lattice_eigenvalue(const Kernel& kernel, const Constants& constants) {
    constexpr int waves = 12;
    const double d = constants.spacing;
    const int reach = static_cast<int>(constants.support / d);
    const int third = Kernel::dimensions == 3 ? 1 : 0;
    std::vector<std::array<double, 6>> around; // place over spacing, gradient
    double square = 0;
    for (int z = -reach * third; z <= reach * third; ++z) {
        for (int y = -reach; y <= reach; ++y) {
            for (int x = -reach; x <= reach; ++x) {
                const double r = d * std::sqrt(double(x * x + y * y + z * z));
                if (r == 0 || r >= constants.support) continue;
                const double g = kernel.gradient(r) * d;
                around.push_back({double(x), double(y), double(z), g * x, g * y, g * z});
                square += g * g * (x * x + y * y + z * z);
            }
        }
    }
    double largest = 0;
    for (int kz = 0; kz <= waves * third; ++kz) {
        for (int ky = 0; ky <= waves; ++ky) {
            for (int kx = 0; kx <= waves; ++kx) {
                double sum[3] = {0, 0, 0};
                for (const auto& j : around) {
                    const double wave = std::sin(math::pi / waves * (kx * j[0] + ky * j[1] + kz * j[2]));
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += wave * j[3 + c];
                }
                largest = std::max(largest, (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / square);
            }
        }
    }
    return largest;
}
} // namespace

double iisph_weight(const SphOptions& options, const Constants& constants) {
    if (options.pressure.jacobi_weight > 0) return options.pressure.jacobi_weight;
    double largest = 0;
    with_kernel(options.kernel, constants.dimensions, constants.support,
                [&](const auto& kernel) { largest = lattice_eigenvalue(kernel, constants); });
    return std::min(published_weight, stable_product / largest);
}

void Iisph::prepare(const StepParts& parts, double dt, Aim aim) {
    prepare_pairs(parts);
    write_source(parts, dt, aim);
}

void Iisph::prepare_pairs(const StepParts& parts) {
    auto& liquid = parts.liquid;
    write_places(liquid, liquid.volume());
    const auto n = static_cast<std::size_t>(liquid.store.owned());
    reserve(q_, n);
    reserve(product_, n);
    reserve(diagonal_, n);
    reserve(watched_, n);
    if (response_ != nullptr) reserve(pressed_, n), reserve(answered_, n);
    reserve(own_, n);
    if (parts.constants.wall_push == 1) force_ = own_;
    else reserve(force_, n);
    const auto entries = static_cast<std::size_t>(parts.neighbours.liquid.size);
    for (auto& one : gradient_) {
        reserve(one, entries + NeighbourList::spare);
        // Lanes beyond the last row: numbers, whatever they are.
        Kokkos::deep_copy(Kokkos::subview(one, Kokkos::make_pair(entries, entries + NeighbourList::spare)), 0.0f);
    }
    const auto fluid = gather_fluid(parts.constants, liquid, parts.solid, parts.neighbours);
    const auto& options = parts.options.pressure;
    const bool bearing = options.recovers_places() && options.stop == StoppingRule::density_error;
    with_kernel(parts.options.kernel, parts.constants.dimensions, parts.constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        Kokkos::parallel_for("treacle::iisph_pairs", fluid.count,
                             PairLoop<Kernel>{kernel, fluid, bearing, {gravity_[0], gravity_[1], gravity_[2]},
                                              relative_density(parts.constants, liquid), {gradient_[0], gradient_[1], gradient_[2]},
                                              diagonal_, watched_, own_, force_});
    });
}

void Iisph::write_source(const StepParts& parts, double dt, Aim aim) {
    auto& liquid = parts.liquid;
    write_motions(liquid);
    const auto fluid = gather_fluid(parts.constants, liquid, parts.solid, parts.neighbours);
    const double needed = least_neighbours * lattice_neighbours(parts.constants);
    const auto& options = parts.options.pressure;
    // The corrections ask for what the pressure system asked for.
    const auto density = options.solver == PressureSolver::isph ? liquid.blended_density() : liquid.density();
    const double slack = slack_factor * options.density_tolerance() * parts.constants.rest_density;
    with_kernel(parts.options.kernel, parts.constants.dimensions, parts.constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        Kokkos::parallel_for("treacle::iisph_source", fluid.count,
                             SourceLoop<Kernel>{kernel, fluid, dt, aim, needed, slack, relative_density(parts.constants, liquid),
                                                {gradient_[0], gradient_[1], gradient_[2]}, density, liquid.source(), diagonal_});
    });
}

void Iisph::multiply(const StepParts& parts, const Array<double>& q) {
    auto& liquid = parts.liquid;
    write_loads(liquid, q);
    parts.halo.gather(liquid.store, {liquid.load_field()});
    const auto fluid = gather_fluid(parts.constants, liquid, parts.solid, parts.neighbours);
    const auto inlet = liquid.has_inlets() ? liquid.inlet() : Array<int>();
    const Gradients gradients{gradient_[0], gradient_[1], gradient_[2]};
    Kokkos::parallel_for("treacle::iisph_accelerations", fluid.count,
                         AccelerationLoop{fluid, relative_density(parts.constants, liquid), inlet, gradients, force_, liquid.acceleration()});
    parts.halo.gather(liquid.store, {liquid.acceleration_field()});
    write_ghost_accelerations(liquid);
    Kokkos::parallel_for("treacle::iisph_density_changes", fluid.count, DensityChangeLoop{fluid, gradients, own_, product_});
    if (response_ == nullptr) return;
    multiply_by_density(parts, q, pressed_);
    response_->apply(parts.comm, liquid.store.owned(), pressed_, answered_);
    add_response(parts, answered_, product_);
}

namespace {
BoundedGuess guess_of(Iisph::Aim aim) {
    switch (aim) {
    case Iisph::Aim::places: return BoundedGuess::zero;            // the excess differs from step to step
    case Iisph::Aim::approach: return BoundedGuess::best_multiple; // so that no energy comes with it
    case Iisph::Aim::density:
    case Iisph::Aim::divergence: break;
    }
    return BoundedGuess::given;
}
} // namespace

solve::SolveReport Iisph::iterate(const StepParts& parts, Aim aim, double dt, const Array<double>& last) {
    const auto& options = parts.options.pressure;
    const auto guess = guess_of(aim);
    // The published IISPH starts from a part of the last pressures; without the excess they change little from step to step.
    const double factor = guess == BoundedGuess::zero ? 0 : aim == Aim::density && options.solver != PressureSolver::dfsph ? warm_start : 1;
    solve::SolveReport out;
    if (write_guess(parts, {last, factor}, q_, diagonal_) == 0) { // q = 0 is the solution
        Kokkos::deep_copy(q_, 0.0);
        return out;
    }
    if (weight_ == 0) weight_ = iisph_weight(parts.options, parts.constants);
    const bool divergence = aim == Aim::divergence;
    const bool loose = aim == Aim::places && options.stop == StoppingRule::density_error;
    const int rows = parts.liquid.store.owned();
    const auto product = [&](const Array<double>& q) {
        multiply(parts, q);
        if (aim == Aim::places) add_softness(rows, shift_softness, diagonal_, q, product_);
    };
    const auto& cells = parts.cells;
    const RowGroups groups = aim == Aim::approach ? RowGroups{cells.begin, cells.end, static_cast<int>(cells.window.size()), true} : RowGroups{};
    const BoundedProblem problem{rows, product, product_, diagonal_, parts.liquid.source(), q_, guess, watched_, groups};
    const double reference = reference_norm(parts, problem, product_);
    const double density = aim == Aim::approach ? driven_tolerance(parts, reference > 0) : options.density_tolerance();
    const auto goal = divergence ? divergence_goal(parts.options, parts.constants, dt)
                                 : goal_of(parts.options, parts.constants, dt, {density, loose ? 0 : reference});
    const auto report = options.solver == PressureSolver::iisph ? spectral_.solve(parts.comm, problem, weight_, goal)
                                                                   : bounded_jacobi(parts.comm, problem, weight_, goal);
    out = report.solve;
    out.relative_residual = reference > 0 ? std::sqrt(report.residual.square) / reference : 0;
    out.error_measure = options.stop == StoppingRule::residual && !divergence
                            ? std::sqrt(report.residual.square)
                            : report.residual.excess * dt * dt / parts.constants.rest_density /
                                  std::max(1.0, report.residual.count);
    return out;
}

solve::SolveReport Iisph::solve(const StepParts& parts, double dt, RoleCounts& roles) {
    const auto start = Clock::now();
    const Aim aim = parts.options.pressure.recovers_places() ? Aim::approach : Aim::density;
    prepare(parts, dt, aim);
    auto out = iterate(parts, aim, dt, parts.liquid.pressure());
    roles = write_pressures(parts, q_);
    out.iteration_seconds = seconds_since(start);
    return out;
}

solve::SolveReport Iisph::shift(const StepParts& parts, double dt) {
    const auto start = Clock::now();
    write_source(parts, dt, Aim::places);
    auto& liquid = parts.liquid;
    auto out = iterate(parts, Aim::places, dt, liquid.pressure());
    const auto shift = liquid.acceleration();
    if (out.products == 0) { // q = 0
        Kokkos::deep_copy(shift, 0.0);
    } else {
        multiply(parts, q_);
        ++out.products;
        Kokkos::parallel_for("treacle::iisph_shift", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) shift(i, k) *= dt;
        });
    }
    out.iteration_seconds = seconds_since(start);
    return out;
}

solve::SolveReport Iisph::solve_divergence(const StepParts& parts, double dt, const Array<double>& last) {
    const auto start = Clock::now();
    prepare(parts, dt, Aim::divergence);
    auto& liquid = parts.liquid;
    auto out = iterate(parts, Aim::divergence, dt, last);
    const auto rho = sum_density(parts);
    const auto q = q_;
    Kokkos::parallel_for("treacle::dfsph_pressures", liquid.store.owned(), KOKKOS_LAMBDA(int i) { last(i) = q(i) * rho.square(i); });
    write_loads(liquid, q_);
    parts.halo.gather(liquid.store, {liquid.load_field()});
    out.iteration_seconds = seconds_since(start);
    return out;
}

std::size_t Iisph::bytes() const {
    return 8 * (q_.span() + product_.span() + diagonal_.span() + own_.span() +
                (force_.data() == own_.data() ? 0 : force_.span()) + watched_.span() + pressed_.span() + answered_.span()) +
           12 * gradient_[0].span() + spectral_.bytes();
}

} // namespace treacle::sph
