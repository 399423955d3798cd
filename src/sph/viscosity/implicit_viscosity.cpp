#include "sph/viscosity/implicit_viscosity.hpp"

#include "base/text/clock.hpp"
#include "sph/forces/inflow.hpp"
#include "sph/solids/bodies.hpp"
#include "sph/viscosity/operator/viscous_vectors.hpp"

#include <array>
#include <cmath>
#include <numeric>

namespace treacle::sph {

namespace {
double dot(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// a += c b
void add(std::vector<double>& a, double c, const std::vector<double>& b) {
    for (std::size_t k = 0; k < a.size(); ++k) a[k] += c * b[k];
}

// Fraction of the residual that directions must have left to be begun anew in single precision.
constexpr double min_reduction = 0.5;

// True when it has broken down.
bool breaks_down(double product, solve::Outcome indefinite, solve::SolveReport& report) {
    if (std::isfinite(product) && product > 0) return false;
    report.outcome = std::isfinite(product) ? indefinite : solve::Outcome::non_finite;
    report.reason =
        std::isfinite(product) ? "the viscous system is not positive definite" : "the velocities are no longer finite";
    return true;
}

// True of the forms with gradients, in products without a matrix, at the velocities that the solve finds.
bool resists_expansion(const ViscosityOptions& options) {
    return ViscousOperator::has_tiles(options.form) && !options.assembled &&
           options.integration == ViscosityIntegration::implicit;
}
} // namespace

ImplicitViscosity::ImplicitViscosity(const Comm& comm, LiquidParticles& liquid, const ViscosityOptions& options,
    const CellGrid& grid, const std::vector<double>& friction, const std::vector<double>& slip_lengths,
    const std::vector<flow::ViscosityModel>& rheology)
    : operator_(liquid, slip_lengths, resists_expansion(options) ? options.bulk : 0), friction_(upload(friction)),
      rheology_("treacle::viscosity_models", rheology.size()),
      direction_(liquid.store.add<Array3>("viscous_direction", "m/s", FieldRole::work)) {
    auto host = Kokkos::create_mirror_view(rheology_);
    for (std::size_t k = 0; k < rheology.size(); ++k) host(k) = rheology[k];
    Kokkos::deep_copy(rheology_, host);
    if (options.integration == ViscosityIntegration::explicit_form) return;
    if (options.preconditioner == ViscosityPreconditioner::multilevel) multilevel_.emplace(grid);
    if (options.assembled) matrix_.emplace(comm, liquid, options);
    if (options.guess == ViscosityGuess::last_change) {
        last_change_ = liquid.store.add<Array3>("viscous_change", "m/s", FieldRole::state);
    }
}

void ImplicitViscosity::start(const LiquidParticles& liquid) {
    operator_.clear_tension(liquid);
    if (last_change_ >= 0) Kokkos::deep_copy(liquid.store.get<Array3>(last_change_), 0.0);
}

std::size_t ImplicitViscosity::bytes() const {
    std::size_t out = operator_.bytes() + near_.bytes();
    if (multilevel_) out += multilevel_->bytes();
    if (matrix_) out += matrix_->bytes();
    for (const auto* array : {&residual_, &product_, &before_}) out += sizeof(double) * array->span();
    out += body_unknowns_.bytes() + sizeof(double) * friction_.span();
    for (const auto* vector : {&body_.q, &body_.residual, &body_.scaled, &body_.direction})
        out += sizeof(double) * vector->capacity();
    return out;
}

ImplicitViscosity::Result ImplicitViscosity::solve(const ViscousScene& step, const Bodies& bodies, double dt) {
    const auto start = Clock::now();
    dt_ = dt;
    const ViscousScene scene = near_.among(step);
    const ViscousContext parts{scene, bodies.moment_reference_points(), friction_, bodies.motion()};
    Result out;
    if (operator_.prepare(parts, dt) == 0) return out;
    const bool freely = scene.options.viscosity.integration == ViscosityIntegration::explicit_form;
    if (!freely) body_unknowns_.prepare(bodies, scene);
    body_.q.assign(body_unknowns_.unknowns(), 0.0);
    out.solve = freely ? step_explicitly(parts) : solve_implicitly(parts, bodies);
    const ViscousContext after{scene, bodies.moment_reference_points(), friction_, moved(bodies)};
    if (!freely && !last_product_is_of_u_) { // an explicit step's forces are those of its start
        multiply_velocities(after, false);
        ++out.solve.products;
    }
    out.loads = operator_.loads(after);
    operator_.keep_tension(scene.liquid);
    if (rheology_.extent(0) > 0) operator_.thin(after, rheology_);
    out.solve.iteration_seconds = seconds_since(start);
    return out;
}

// Motion of the solids with what the solve has found for the bodies so far.
const Array<double>& ImplicitViscosity::moved(const Bodies& bodies) {
    return body_unknowns_.any() ? body_unknowns_.moved(bodies, body_.q) : bodies.motion();
}

// (4.3) and (4.4) at the velocities before.
solve::SolveReport ImplicitViscosity::step_explicitly(const ViscousContext& parts) {
    auto& liquid = parts.liquid;
    const int n = liquid.store.owned();
    reserve(product_, static_cast<std::size_t>(n));
    operator_.multiply(parts, liquid.velocity_field(), ViscousOperator::Walls::moving, product_);
    const auto inertia = relative_density(parts.constants, liquid);
    constrain_rows(liquid, inertia, liquid.velocity(), product_);
    step_freely(inertia, product_, n, liquid.velocity());
    solve::SolveReport report;
    report.products = 1;
    return report;
}

// z = M r; returns this rank's r.z.
double ImplicitViscosity::precondition(const LiquidParticles& liquid, const Array3& r, const Array3& z) {
    if (multilevel_) return multilevel_->apply(operator_, r, z);
    operator_.precondition(liquid, r, z);
    return dot(r, z, liquid.store.owned());
}

// True when the solve ends with this r.r of all ranks.
bool ImplicitViscosity::Progress::ended(double square) {
    report.relative_residual = norm > 0 ? std::sqrt(square) / norm : 0;
    report.error_measure = std::sqrt(square);
    if (!std::isfinite(square)) return breaks_down(square, solve::Outcome::non_finite, report);
    return report.relative_residual <= std::max(parts.options.viscosity.residual, report.iterations == 0 ? enough : 0);
}

solve::SolveReport ImplicitViscosity::solve_implicitly(const ViscousContext& parts, const Bodies& bodies) {
    auto& liquid = parts.liquid;
    const int n = liquid.store.owned();
    for (auto* array : {&residual_, &product_}) reserve(*array, static_cast<std::size_t>(n));
    const bool guessing = last_change_ >= 0, rated = rheology_.extent(0) > 0;
    const bool verified = multiplies_nearly(parts.options.viscosity);
    if (guessing || rated || verified) {
        reserve(before_, static_cast<std::size_t>(n));
        copy(liquid.velocity(), n, before_);
    }
    const auto& before = guessing || verified ? before_ : liquid.velocity();
    auto report = rated ? solve_by_rates(parts, bodies) : solve_once({parts, bodies, before});
    if (guessing) store_increment(liquid);
    return report;
}

// Fixed point on the viscosities: each solve has those of the velocities of the one before, the first one those of the
// last step.
solve::SolveReport ImplicitViscosity::solve_by_rates(const ViscousContext& parts, const Bodies& bodies) {
    auto& liquid = parts.liquid;
    const auto& options = parts.options.viscosity;
    solve::SolveReport sum;
    for (int k = 0; k < options.max_picard_iterations; ++k) {
        Progress progress{parts, bodies, before_};
        if (k > 0) {
            const ViscousContext now{parts, parts.points, parts.friction, moved(bodies)};
            operator_.multiply(now, liquid.velocity_field(), ViscousOperator::Walls::moving, product_);
            operator_.thin(now, rheology_);
            operator_.prepare(parts, dt_);
            ++sum.products;
            progress.enough = options.picard_residual;
            progress.first = false;
        }
        const auto one = solve_once(progress);
        const auto before = sum;
        sum = one;
        sum.iterations += before.iterations;
        sum.products += before.products;
        sum.set_up_seconds += before.set_up_seconds;
        if (!one.converged() || one.iterations == 0) return sum;
    }
    return sum;
}

// L^T (dt/m) F of the velocities of the last multiply, of which the parts have the motion of the bodies. Collective.
std::vector<double> ImplicitViscosity::pull(const ViscousContext& parts) {
    auto loads = operator_.loads(parts);
    parts.comm.sum(std::span(loads));
    auto out = body_unknowns_.project(loads);
    for (double& entry : out) entry *= dt_ / parts.constants.mass;
    return out;
}

// r = M u* - (C u - walls) of particles and bodies; returns r.r of all ranks.
double ImplicitViscosity::find_residual(Progress& progress, bool nearly) {
    const auto& parts = progress.parts;
    auto& liquid = parts.liquid;
    const auto inertia = relative_density(parts.constants, liquid);
    const ViscousContext now{parts, parts.points, parts.friction, moved(progress.bodies)};
    multiply_velocities(now, nearly);
    constrain_rows(liquid, inertia, liquid.velocity(), product_);
    ++progress.report.products;
    last_product_is_of_u_ = !nearly;
    if (body_unknowns_.any()) {
        body_.residual = pull(now);
        add(body_.residual, -1, body_.q);
    }
    return parts.comm.sum(subtract(progress.before, inertia, product_, liquid.store.owned(), residual_)) +
           dot(body_.residual, body_.residual);
}

// C u = before, from the present velocities on.
solve::SolveReport ImplicitViscosity::solve_once(Progress progress) {
    const auto& parts = progress.parts;
    const int n = parts.liquid.store.owned();
    const bool nearly = multiplies_nearly(parts.options.viscosity);
    if (nearly) round_free(parts.liquid);
    double square = find_residual(progress, nearly);
    // A liquid at rest between walls that move: what these add counts.
    const double right =
        parts.comm.sum(sum_squares(progress.before, n, relative_density(parts.constants, parts.liquid)));
    progress.norm = std::sqrt(std::max(square, right));
    if (nearly && progress.ended(square)) { // the velocities may stay as they came, to the last bit
        if (progress.first) copy(progress.before, n, parts.liquid.velocity());
        square = find_residual(progress, false);
    }
    const bool guessing = last_change_ >= 0 && progress.first;
    if (!progress.ended(square) && !(guessing && start_from_last_change(progress, square))) {
        set_up(progress);
        matrix_ ? solve_assembled(progress) : iterate(progress);
        last_product_is_of_u_ = last_product_is_of_u_ && !matrix_;
    }
    return progress.report;
}

void ImplicitViscosity::store_increment(const LiquidParticles& liquid) {
    const int n = liquid.store.owned();
    const auto change = liquid.store.get<Array3>(last_change_);
    copy(liquid.velocity(), n, change);
    add(-1, before_, n, change);
}

// The preconditioner's coarse part, and the matrix.
void ImplicitViscosity::set_up(Progress& progress) {
    const auto start = Clock::now();
    const auto& parts = progress.parts;
    if (multilevel_) multilevel_->set_up(parts, operator_);
    if (matrix_) matrix_->assemble(parts, operator_);
    if (body_unknowns_.any()) {
        auto stiffness = operator_.stiffness(parts);
        parts.comm.sum(std::span(stiffness));
        body_unknowns_.factorise(stiffness);
    }
    progress.report.set_up_seconds = seconds_since(start);
}

// u += a p with the last change p, a for the least error in the norm of C: never worse than u*. Whether that is enough.
bool ImplicitViscosity::start_from_last_change(Progress& progress, double square) {
    const auto& parts = progress.parts;
    const int n = parts.liquid.store.owned();
    const auto p = parts.liquid.store.get<Array3>(last_change_);
    operator_.multiply(parts, last_change_, ViscousOperator::Walls::resting, product_);
    constrain_rows(parts.liquid, relative_density(parts.constants, parts.liquid), p, product_);
    ++progress.report.products;
    std::array<double, 2> sums{dot(p, product_, n), dot(p, residual_, n)};
    parts.comm.sum(std::span(sums));
    if (!(sums[0] > 0)) return progress.ended(square);
    ++progress.report.iterations;
    last_product_is_of_u_ = false;
    return progress.ended(parts.comm.sum(step(sums[1] / sums[0], p, product_, n, parts.liquid.velocity(), residual_)));
}

void ImplicitViscosity::solve_assembled(Progress& progress) {
    const auto& liquid = progress.parts.liquid;
    const auto& viscosity = progress.parts.options.viscosity;
    const bool own = viscosity.preconditioner == ViscosityPreconditioner::jacobi ||
                     viscosity.preconditioner == ViscosityPreconditioner::multilevel;
    ViscousMatrix::Preconditioner ours;
    if (own) ours = [&](const Array3& r, const Array3& z) { precondition(liquid, r, z); };
    const double start = progress.report.error_measure;
    auto report = matrix_->solve(liquid, residual_, viscosity.residual * progress.norm, ours, product_);
    add(1, product_, liquid.store.owned(), liquid.velocity());
    report.iterations += progress.report.iterations;
    report.products += progress.report.products;
    report.set_up_seconds += progress.report.set_up_seconds;
    report.relative_residual *= start / progress.norm;
    if (report.outcome == solve::Outcome::indefinite_matrix) {
        report.reason = "the viscous matrix is not positive definite, as that of the published form may be";
    }
    progress.report = report;
}

bool ImplicitViscosity::multiplies_nearly(const ViscosityOptions& options) const {
    return options.precision == ViscosityPrecision::mixed && ViscousOperator::has_tiles(options.form) && !matrix_;
}

// Into product_.
void ImplicitViscosity::multiply(const ViscousContext& parts, int u_field, ViscousOperator::Walls walls, bool nearly) {
    if (nearly)
        operator_.multiply_single_precision(parts, u_field, walls, product_);
    else
        operator_.multiply(parts, u_field, walls, product_);
}

// The product with the liquid's velocities, beside what does not depend on them: walls that move, and the tension.
void ImplicitViscosity::multiply_velocities(const ViscousContext& parts, bool nearly) {
    operator_.let_tension_act(true);
    multiply(parts, parts.liquid.velocity_field(), ViscousOperator::Walls::moving, nearly);
    operator_.let_tension_act(false);
}

// Products with the directions; returns p.C p of all ranks.
double ImplicitViscosity::multiply_directions(
    const ViscousContext& parts, bool nearly, std::vector<double>& body_product) {
    using Walls = ViscousOperator::Walls;
    const auto p = parts.liquid.store.get<Array3>(direction_);
    const auto inertia = relative_density(parts.constants, parts.liquid);
    const int n = parts.liquid.store.owned();
    if (!body_unknowns_.any()) {
        multiply(parts, direction_, Walls::resting, nearly);
        constrain_rows(parts.liquid, inertia, p, product_);
        return parts.comm.sum(dot(p, product_, n));
    }
    const ViscousContext trial{parts, parts.points, parts.friction, body_unknowns_.trial(body_.direction)};
    multiply(trial, direction_, Walls::moving, nearly);
    constrain_rows(parts.liquid, inertia, p, product_);
    body_product = body_.direction;
    add(body_product, -1, pull(trial));
    return parts.comm.sum(dot(p, product_, n)) + dot(body_.direction, body_product);
}

// z = M r of particles and bodies, where C p was, which is in r by now; returns this rank's r.z of the particles.
double ImplicitViscosity::precondition(const LiquidParticles& liquid) {
    const double product = precondition(liquid, residual_, product_); // buffer particles have no residual
    clear_prescribed(liquid, product_);
    if (body_unknowns_.any()) body_.scaled = body_unknowns_.precondition(body_.residual);
    return product;
}

// The residual of the recurrence drifts from that of the velocities by some 1e-6 of the first one where products are in
// single precision: the directions are begun anew from the true residual until that is small enough, and go on in
// double precision when single precision stagnates.
void ImplicitViscosity::iterate(Progress& progress) {
    auto& report = progress.report;
    bool nearly = multiplies_nearly(progress.parts.options.viscosity);
    for (;;) {
        const double before = report.error_measure;
        iterate_cg(progress, nearly);
        const bool broken = report.outcome == solve::Outcome::indefinite_matrix ||
                            report.outcome == solve::Outcome::indefinite_preconditioner;
        if (!nearly || (!report.converged() && !broken)) return;
        report.outcome = solve::Outcome::converged;
        report.reason.clear();
        if (progress.ended(find_residual(progress, false))) return;
        nearly = !broken && report.error_measure < min_reduction * before;
    }
}

// Preconditioned conjugate gradients (Saad 2003, algorithm 9.1).
void ImplicitViscosity::iterate_cg(Progress& progress, bool nearly) {
    const auto& parts = progress.parts;
    const auto& comm = parts.comm;
    auto& report = progress.report;
    auto& liquid = parts.liquid;
    const int n = liquid.store.owned();
    const auto u = liquid.velocity(), p = liquid.store.get<Array3>(direction_);
    double rz = comm.sum(precondition(liquid)) + dot(body_.residual, body_.scaled);
    turn(0, product_, n, nearly, p);
    body_.direction = body_.scaled;
    std::vector<double> body_product;
    while (report.iterations < parts.options.viscosity.max_iterations) {
        if (breaks_down(rz, solve::Outcome::indefinite_preconditioner, report)) return;
        const double pq = multiply_directions(parts, nearly, body_product);
        ++report.products;
        if (breaks_down(pq, solve::Outcome::indefinite_matrix, report)) return;
        ++report.iterations;
        last_product_is_of_u_ = false;
        const double square = step(rz / pq, p, product_, n, u, residual_);
        add(body_.q, rz / pq, body_.direction);
        add(body_.residual, -rz / pq, body_product);
        std::array<double, 2> next{square, precondition(liquid)};
        comm.sum(std::span(next));
        next[0] += dot(body_.residual, body_.residual);
        next[1] += dot(body_.residual, body_.scaled);
        if (progress.ended(next[0])) return;
        turn(next[1] / rz, product_, n, nearly, p);
        for (std::size_t k = 0; k < body_.q.size(); ++k)
            body_.direction[k] = body_.scaled[k] + next[1] / rz * body_.direction[k];
        rz = next[1];
    }
    report.outcome = solve::Outcome::iteration_limit;
    report.reason = "not converged within " + std::to_string(parts.options.viscosity.max_iterations) + " iterations";
}

} // namespace treacle::sph
