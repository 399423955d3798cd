#include "sph/iisph/iisph.hpp"

#include "base/text/clock.hpp"
#include "sph/iisph/correct_gradients.hpp"
#include "sph/iisph/iisph_loops.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::sph {

namespace {
// Share of the last pressures that an iteration starts from (Ihmsen et al. 2014).
constexpr double warm_start = 0.5;
// Particles with fewer neighbours than that share of the lattice's need not be free of divergence: about the 20 of 30 that
// SPlisHSPlasH requires.
constexpr double least_neighbours = 2.0 / 3;
// As published: without them a step may end before a pressure wave has started.
constexpr int least_iterations = 2;
// Liquid thinner than at rest by less than that many times `density_error` counts as full: compression and gaps that a solve leaves
// would let a tank fall freely in one step and hold it twice as hard in the next.
constexpr double slack_factor = 5;
// Diagonals added to A for the shift: an excess that is everywhere, as in a box that is too full, gives no shift.
constexpr double shift_compliance = 0.1;
// Liquid that something else than gravity drives may be compressed by `density_error` while it moves by a spacing in a liquid of so
// many spacings across, in inverse proportion in a wider one: what a lid or an inlet brings into one corner of the liquid is little
// of the mean, and what is let in there does not turn the rest.
constexpr double narrow = 6;
// Jacobi takes that many times the iterations of spectral gradients.
constexpr int jacobi_patience = 20;

void write_loads(LiquidParticles& liquid, const Array<double>& q) {
    const auto load = liquid.load();
    Kokkos::parallel_for(
        "treacle::iisph_loads", liquid.store.owned(), KOKKOS_LAMBDA(int i) { load(i) = q(i); });
}

void write_ghost_accelerations(LiquidParticles& liquid) {
    const auto a = liquid.acceleration();
    const auto to = liquid.motion;
    using Range = Kokkos::RangePolicy<Execution>;
    Kokkos::parallel_for(
        "treacle::iisph_ghosts", Range(liquid.store.owned(), liquid.store.total()), KOKKOS_LAMBDA(int i) {
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
SumDensity sum_density(const StepContext& parts) { return {parts.liquid.volume(), parts.constants.mass}; }

struct Guess {
    Array<double> pressure; // [owned] of the last solve [Pa]
    double factor;          // on it
};

// Writes the guess as q; returns how many b > 0.
double write_guess(
    const StepContext& parts, const Guess& guess, const Array<double>& q, const Array<double>& diagonal) {
    const auto rho = sum_density(parts);
    const auto p = guess.pressure, b = parts.liquid.source();
    const double factor = guess.factor;
    const int n = parts.liquid.store.owned();
    double compressed = 0;
    Kokkos::parallel_reduce(
        "treacle::iisph_start", n,
        KOKKOS_LAMBDA(int i, double& count) {
            q(i) = diagonal(i) > 0 ? factor * math::max(0.0, p(i)) / rho.square(i) : 0;
            if (b(i) > 0 && diagonal(i) > 0) count += 1;
        },
        compressed);
    return parts.comm.sum(n > 0 ? compressed : 0.0);
}

// The norm of the watched residual without pressures: `gradient` is -b then.
double reference_norm(const StepContext& parts, const BoundedProblem& problem, const Array<double>& gradient) {
    const auto b = problem.right_hand_side;
    Kokkos::parallel_for(
        "treacle::iisph_reference", problem.rows, KOKKOS_LAMBDA(int i) { gradient(i) = -b(i); });
    return std::sqrt(watched_square(parts.comm, problem, gradient));
}

// product += compliance D q
void add_compliance(
    int rows, double compliance, const Array<double>& diagonal, const Array<double>& q, const Array<double>& product) {
    Kokkos::parallel_for(
        "treacle::iisph_compliance", rows, KOKKOS_LAMBDA(int i) { product(i) += compliance * diagonal(i) * q(i); });
}

// scaled = rho q: rows of RigidCouplingTerm have 1 / rho.
void multiply_by_density(const StepContext& parts, const Array<double>& q, const Array<double>& scaled) {
    const auto rho = sum_density(parts);
    Kokkos::parallel_for(
        "treacle::iisph_pressed", parts.liquid.store.owned(), KOKKOS_LAMBDA(int i) { scaled(i) = q(i) * rho(i); });
}

// product += rho response
void add_response(const StepContext& parts, const Array<double>& response, const Array<double>& product) {
    const auto rho = sum_density(parts);
    Kokkos::parallel_for(
        "treacle::iisph_answer", parts.liquid.store.owned(),
        KOKKOS_LAMBDA(int i) { product(i) += response(i) * rho(i); });
}

RoleCounts write_pressures(const StepContext& parts, const Array<double>& q) {
    const auto rho = sum_density(parts);
    const auto p = parts.liquid.pressure();
    const auto role = parts.liquid.role();
    const int n = parts.liquid.store.owned();
    int pressed = 0;
    Kokkos::parallel_reduce(
        "treacle::iisph_pressures", n,
        KOKKOS_LAMBDA(int i, int& count) {
            p(i) = q(i) * rho.square(i);
            role(i) = q(i) > 0 ? Role::poisson : Role::dirichlet;
            count += static_cast<int>(q(i) > 0);
        },
        pressed);
    return {pressed, n - pressed, 0};
}

// Collective. The mean compression at which a solve for velocities stops; gravity_drives: rows above solids that bear them are watched.
double driven_tolerance(const StepContext& parts, bool gravity_drives) {
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
StoppingTest goal_of(const SphOptions& options, const Constants& constants, double dt, const Tolerances& tolerances) {
    const auto& pressure = options.pressure;
    const double reference = tolerances.reference;
    StoppingTest goal;
    const bool jacobi = pressure.solver != PressureSolver::iisph;
    goal.least_iterations = jacobi ? least_iterations : 0;
    goal.max_iterations = (jacobi ? jacobi_patience : 1) * pressure.max_iterations;
    if (pressure.stop == StoppingRule::residual) {
        goal.met = [=, to = pressure.residual](
                       const BoundedResidual& r) { return std::sqrt(r.square) <= to * reference; };
    } else {
        const double scale = dt * dt / constants.rest_density;
        goal.met = [=, to = tolerances.density, largest = pressure.residual_tolerance()](const BoundedResidual& r) {
            const bool dense = r.excess * scale < to * std::max(1.0, r.count);
            return dense && (reference == 0 || std::sqrt(r.square) <= largest * reference);
        };
    }
    return goal;
}

// Goal of the divergence-free solve: b dt^2 / rho0 is the compression that the velocity has in a step.
StoppingTest divergence_goal(const SphOptions& options, const Constants& constants, double dt) {
    const double scale = dt * dt / constants.rest_density;
    const auto met = [=, to = options.pressure.divergence_error](
                         const BoundedResidual& r) { return r.excess * scale < to * std::max(1.0, r.count); };
    return {met, 1, jacobi_patience * options.pressure.max_iterations};
}

} // namespace

void Iisph::prepare(const StepContext& parts, double dt, Aim aim) {
    prepare_pairs(parts);
    write_source(parts, dt, aim);
}

namespace {
// Pressures of surface tension compress far less in a step than the density's rule lets through: all rows are watched, each by itself.
bool tension_drives(const StepContext& parts) {
    return parts.options.surface_tension.model != SurfaceTensionModel::none;
}
} // namespace

void Iisph::prepare_pairs(const StepContext& parts) {
    auto& liquid = parts.liquid;
    pack_positions(liquid, liquid.volume());
    const auto n = static_cast<std::size_t>(liquid.store.owned());
    reserve(q_, n);
    reserve(product_, n);
    reserve(diagonal_, n);
    reserve(watched_, n);
    if (response_ != nullptr) reserve(pressed_, n), reserve(answered_, n);
    reserve(own_, n);
    if (parts.constants.wall_pressure_factor == 1)
        force_ = own_;
    else
        reserve(force_, n);
    const auto entries = static_cast<std::size_t>(parts.neighbours.liquid.size);
    for (auto& one : gradient_) {
        reserve(one, entries + NeighbourList::padding);
        // Lanes beyond the last row: numbers, whatever they are.
        Kokkos::deep_copy(Kokkos::subview(one, Kokkos::make_pair(entries, entries + NeighbourList::padding)), 0.0f);
    }
    const auto fluid = make_views(parts.constants, liquid, parts.solid, parts.neighbours);
    const auto& options = parts.options.pressure;
    const bool bearing =
        options.recovers_positions() && options.stop == StoppingRule::density_error && !tension_drives(parts);
    with_kernel(parts.options.kernel, parts.constants.dimensions, parts.constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        Kokkos::parallel_for("treacle::iisph_pairs", fluid.count,
            PairLoop<Kernel>{kernel, fluid, bearing, {gravity_[0], gravity_[1], gravity_[2]},
                relative_density(parts.constants, liquid), {gradient_[0], gradient_[1], gradient_[2]}, diagonal_,
                watched_, own_, force_});
    });
    if (options.corrects_gradients()) return correct(parts);
    std::ranges::copy(gradient_, adjoint_);
}

void Iisph::correct(const StepContext& parts) {
    for (auto& one : adjoint_) reserve(one, gradient_[0].extent(0));
    correct_gradients(
        parts, {{gradient_[0], gradient_[1], gradient_[2]}, {adjoint_[0], adjoint_[1], adjoint_[2]}, own_, diagonal_});
}

void Iisph::write_source(const StepContext& parts, double dt, Aim aim) {
    auto& liquid = parts.liquid;
    pack_velocities(liquid);
    const auto fluid = make_views(parts.constants, liquid, parts.solid, parts.neighbours);
    const double needed = least_neighbours * lattice_neighbours(parts.constants);
    const auto& options = parts.options.pressure;
    // The corrections have the same target as the pressure system.
    const auto density = options.solver == PressureSolver::isph ? liquid.blended_density() : liquid.density();
    const double slack = slack_factor * options.density_tolerance() * parts.constants.rest_density;
    with_kernel(parts.options.kernel, parts.constants.dimensions, parts.constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        Kokkos::parallel_for("treacle::iisph_source", fluid.count,
            SourceLoop<Kernel>{kernel, fluid, dt, aim, needed, slack, relative_density(parts.constants, liquid),
                {gradient_[0], gradient_[1], gradient_[2]}, density, liquid.source(), diagonal_});
    });
}

void Iisph::multiply(const StepContext& parts, const Array<double>& q) {
    auto& liquid = parts.liquid;
    write_loads(liquid, q);
    parts.halo.gather(liquid.store, {liquid.load_field()});
    const auto fluid = make_views(parts.constants, liquid, parts.solid, parts.neighbours);
    const auto inlet = liquid.has_inlets() ? liquid.inlet() : Array<int>();
    const Gradients gradients{gradient_[0], gradient_[1], gradient_[2]};
    Kokkos::parallel_for("treacle::iisph_accelerations", fluid.count,
        AccelerationLoop{fluid, relative_density(parts.constants, liquid), inlet,
            {adjoint_[0], adjoint_[1], adjoint_[2]}, force_, liquid.acceleration()});
    parts.halo.gather(liquid.store, {liquid.acceleration_field()});
    write_ghost_accelerations(liquid);
    Kokkos::parallel_for(
        "treacle::iisph_density_changes", fluid.count, DensityChangeLoop{fluid, gradients, own_, product_});
    if (response_ == nullptr) return;
    multiply_by_density(parts, q, pressed_);
    response_->apply(parts.comm, liquid.store.owned(), pressed_, answered_);
    add_response(parts, answered_, product_);
}

namespace {
BoundedGuess guess_of(Iisph::Aim aim) {
    switch (aim) {
    case Iisph::Aim::positions: return BoundedGuess::zero;         // the excess differs from step to step
    case Iisph::Aim::approach: return BoundedGuess::best_multiple; // so that no energy comes with it
    case Iisph::Aim::density:
    case Iisph::Aim::divergence: break;
    }
    return BoundedGuess::given;
}
} // namespace

solve::SolveReport Iisph::iterate(const StepContext& parts, Aim aim, double dt, const Array<double>& last) {
    const auto& options = parts.options.pressure;
    const auto guess = guess_of(aim);
    // The published IISPH starts from a part of the last pressures; without the excess they change little from step to step.
    const double factor = guess == BoundedGuess::zero                                      ? 0
                          : aim == Aim::density && options.solver != PressureSolver::dfsph ? warm_start
                                                                                           : 1;
    solve::SolveReport out;
    if (write_guess(parts, {last, factor}, q_, diagonal_) == 0) { // q = 0 is the solution
        Kokkos::deep_copy(q_, 0.0);
        return out;
    }
    if (weight_ == 0) weight_ = iisph_weight(parts.options, parts.constants);
    const bool divergence = aim == Aim::divergence;
    const bool loose = aim == Aim::positions && options.stop == StoppingRule::density_error;
    const int rows = parts.liquid.store.owned();
    const auto product = [&](const Array<double>& q) {
        multiply(parts, q);
        if (aim == Aim::positions) add_compliance(rows, shift_compliance, diagonal_, q, product_);
    };
    const auto& cells = parts.cells;
    const RowGroups groups = aim == Aim::approach ? RowGroups{cells.begin, cells.end,
                                                        static_cast<int>(cells.window.size()), !tension_drives(parts)}
                                                  : RowGroups{};
    const BoundedProblem problem{
        rows, product, product_, diagonal_, parts.liquid.source(), q_, guess, watched_, groups};
    const double reference = reference_norm(parts, problem, product_);
    const double density = aim == Aim::approach ? driven_tolerance(parts, reference > 0) : options.density_tolerance();
    const auto goal = divergence ? divergence_goal(parts.options, parts.constants, dt)
                                 : goal_of(parts.options, parts.constants, dt, {density, loose ? 0 : reference});
    const auto report = options.solver == PressureSolver::iisph ? spectral_.solve(parts.comm, problem, weight_, goal)
                                                                : bounded_jacobi(parts.comm, problem, weight_, goal);
    out = report.solve;
    out.relative_residual = reference > 0 ? std::sqrt(report.residual.square) / reference : 0;
    out.error_measure =
        options.stop == StoppingRule::residual && !divergence
            ? std::sqrt(report.residual.square)
            : report.residual.excess * dt * dt / parts.constants.rest_density / std::max(1.0, report.residual.count);
    return out;
}

solve::SolveReport Iisph::solve(const StepContext& parts, double dt, RoleCounts& roles) {
    const auto start = Clock::now();
    const Aim aim = parts.options.pressure.recovers_positions() ? Aim::approach : Aim::density;
    write_source(parts, dt, aim);
    auto out = iterate(parts, aim, dt, parts.liquid.pressure());
    roles = write_pressures(parts, q_);
    if (parts.options.pressure.corrects_gradients()) {
        multiply(parts, q_);
        ++out.products;
    }
    out.iteration_seconds = seconds_since(start);
    return out;
}

solve::SolveReport Iisph::shift(const StepContext& parts, double dt) {
    const auto start = Clock::now();
    write_source(parts, dt, Aim::positions);
    auto& liquid = parts.liquid;
    auto out = iterate(parts, Aim::positions, dt, liquid.pressure());
    const auto shift = liquid.acceleration();
    if (out.products == 0) { // q = 0
        Kokkos::deep_copy(shift, 0.0);
    } else {
        multiply(parts, q_);
        ++out.products;
        Kokkos::parallel_for(
            "treacle::iisph_shift", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
                for (int k = 0; k < 3; ++k) shift(i, k) *= dt;
            });
    }
    out.iteration_seconds = seconds_since(start);
    return out;
}

solve::SolveReport Iisph::solve_divergence(const StepContext& parts, double dt, const Array<double>& last) {
    const auto start = Clock::now();
    prepare(parts, dt, Aim::divergence);
    auto& liquid = parts.liquid;
    auto out = iterate(parts, Aim::divergence, dt, last);
    const auto rho = sum_density(parts);
    const auto q = q_;
    Kokkos::parallel_for(
        "treacle::dfsph_pressures", liquid.store.owned(), KOKKOS_LAMBDA(int i) { last(i) = q(i) * rho.square(i); });
    write_loads(liquid, q_);
    parts.halo.gather(liquid.store, {liquid.load_field()});
    out.iteration_seconds = seconds_since(start);
    return out;
}

std::size_t Iisph::bytes() const {
    return 8 * (q_.span() + product_.span() + diagonal_.span() + own_.span() +
                   (force_.data() == own_.data() ? 0 : force_.span()) + watched_.span() + pressed_.span() +
                   answered_.span()) +
           (adjoint_[0].data() == gradient_[0].data() ? 12 : 24) * gradient_[0].span() + spectral_.bytes();
}

} // namespace treacle::sph
