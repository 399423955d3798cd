#include "sph/implicit_viscosity.hpp"

#include "base/clock.hpp"
#include "sph/bodies.hpp"

#include <array>
#include <cmath>

namespace treacle::sph {

namespace {
double sum_squares(const Array3& a, int n, const RelativeDensity& weight) {
    double sum = 0;
    Kokkos::parallel_reduce("treacle::viscous_norm", n, KOKKOS_LAMBDA(int i, double& out) {
        const double w = weight(i);
        for (int k = 0; k < 3; ++k) out += w * w * a(i, k) * a(i, k);
    }, sum);
    return n > 0 ? sum : 0;
}

// r = M u - product; returns r.r.
double subtract(const Array3& u, const RelativeDensity& inertia, const Array3& product, int n, const Array3& r) {
    double sum = 0;
    Kokkos::parallel_reduce("treacle::viscous_residual", n, KOKKOS_LAMBDA(int i, double& out) {
        const double m = inertia(i);
        for (int k = 0; k < 3; ++k) {
            r(i, k) = m * u(i, k) - product(i, k);
            out += r(i, k) * r(i, k);
        }
    }, sum);
    return n > 0 ? sum : 0;
}

double dot(const Array3& a, const Array3& b, int n) {
    double sum = 0;
    Kokkos::parallel_reduce("treacle::viscous_dot", n, KOKKOS_LAMBDA(int i, double& out) {
        for (int k = 0; k < 3; ++k) out += a(i, k) * b(i, k);
    }, sum);
    return n > 0 ? sum : 0;
}

// u += alpha p, r -= alpha q; returns r.r.
double step(double alpha, const Array3& p, const Array3& q, int n, const Array3& u, const Array3& r) {
    double sum = 0;
    Kokkos::parallel_reduce("treacle::viscous_step", n, KOKKOS_LAMBDA(int i, double& out) {
        for (int k = 0; k < 3; ++k) {
            u(i, k) += alpha * p(i, k);
            r(i, k) -= alpha * q(i, k);
            out += r(i, k) * r(i, k);
        }
    }, sum);
    return n > 0 ? sum : 0;
}

// p = z + beta p; with beta = 0 whatever p was.
void turn(double beta, const Array3& z, int n, const Array3& p) {
    Kokkos::parallel_for("treacle::viscous_turn", n, KOKKOS_LAMBDA(int i) {
        for (int k = 0; k < 3; ++k) p(i, k) = z(i, k) + (beta != 0 ? beta * p(i, k) : 0);
    });
}

// a -= b.
void subtract(const Array3& b, int n, const Array3& a) {
    Kokkos::parallel_for("treacle::viscous_difference", n, KOKKOS_LAMBDA(int i) {
        for (int k = 0; k < 3; ++k) a(i, k) -= b(i, k);
    });
}

void copy(const Array3& from, int n, const Array3& to) {
    Kokkos::parallel_for("treacle::viscous_copy", n, KOKKOS_LAMBDA(int i) {
        for (int k = 0; k < 3; ++k) to(i, k) = from(i, k);
    });
}

// u = u* + (M u* - product) / M.
void step_freely(const RelativeDensity& inertia, const Array3& product, int n, const Array3& u) {
    Kokkos::parallel_for("treacle::viscous_explicit", n, KOKKOS_LAMBDA(int i) {
        for (int k = 0; k < 3; ++k) u(i, k) += u(i, k) - product(i, k) / inertia(i);
    });
}

// True when it has broken down.
bool breaks_down(double product, solve::Outcome indefinite, solve::SolveReport& report) {
    if (std::isfinite(product) && product > 0) return false;
    report.outcome = std::isfinite(product) ? indefinite : solve::Outcome::non_finite;
    report.reason = std::isfinite(product) ? "the viscous system is not positive definite"
                                           : "the velocities are no longer finite";
    return true;
}
} // namespace

ImplicitViscosity::ImplicitViscosity(const Comm& comm, LiquidParticles& liquid, const ViscosityOptions& options,
                                     const CellGrid& grid, const std::vector<double>& friction)
    : operator_(liquid), friction_(upload(friction)),
      direction_(liquid.store.add<Array3>("viscous_direction", "m/s", FieldRole::work)) {
    if (options.integration == ViscosityIntegration::explicit_form) return;
    const bool keeps_rotations = options.form != ViscosityForm::laplacian;
    if (options.preconditioner == ViscosityPreconditioner::rigid_blocks && keeps_rotations) {
        blocks_ = std::make_unique<RigidBlocks>(comm, liquid, grid);
    }
    if (options.assembled) matrix_.emplace(comm, liquid, options);
    if (options.guess == ViscosityGuess::last_change) {
        last_change_ = liquid.store.add<Array3>("viscous_change", "m/s", FieldRole::state);
    }
}

void ImplicitViscosity::start(const LiquidParticles& liquid) {
    if (last_change_ >= 0) Kokkos::deep_copy(liquid.store.get<Array3>(last_change_), 0.0);
}

std::size_t ImplicitViscosity::bytes() const {
    std::size_t out = operator_.bytes();
    if (blocks_) out += blocks_->bytes();
    if (matrix_) out += matrix_->bytes();
    for (const auto* array : {&residual_, &scaled_, &product_}) out += sizeof(double) * array->span();
    return out;
}

void ImplicitViscosity::upload_motion(const Bodies& bodies) {
    const auto count = static_cast<std::size_t>(bodies.load_points().count);
    reserve(motion_, 6 * count);
    auto host = Kokkos::create_mirror_view(motion_);
    for (std::size_t k = 0; k < motion_.extent(0); ++k) host(k) = 0;
    for (std::size_t b = 0; b < bodies.rigid.size(); ++b) {
        if (!bodies.rigid.moves(b)) continue;
        const auto row = 6 * (static_cast<std::size_t>(bodies.first()) + b);
        const auto spin = bodies.rigid.spin(b);
        for (std::size_t k = 0; k < 3; ++k) {
            host(row + k) = bodies.rigid.velocity(b)[k];
            host(row + 3 + k) = spin[k];
        }
    }
    Kokkos::deep_copy(motion_, host);
}

ImplicitViscosity::Result ImplicitViscosity::solve(const ViscousScene& scene, const Bodies& bodies, double dt) {
    const auto start = Clock::now();
    upload_motion(bodies);
    auto& liquid = scene.liquid;
    const ViscousParts parts{scene, bodies.load_points(), friction_, motion_};
    Result out;
    if (operator_.prepare(parts, dt) == 0) return out;
    const bool freely = scene.options.viscosity.integration == ViscosityIntegration::explicit_form;
    out.solve = freely ? step_explicitly(parts) : solve_implicitly(parts);
    if (out.solve.iterations > 0) { // else the last product was of these velocities, or of those that the forces are of
        operator_.multiply(parts, liquid.velocity_field(), ViscousOperator::Walls::moving, product_);
        ++out.solve.products;
    }
    out.loads = operator_.loads(parts);
    out.solve.iteration_seconds = seconds_since(start);
    return out;
}

// (4.3) and (4.4) at the velocities before.
solve::SolveReport ImplicitViscosity::step_explicitly(const ViscousParts& parts) {
    auto& liquid = parts.liquid;
    const int n = liquid.store.owned();
    reserve(product_, static_cast<std::size_t>(n));
    operator_.multiply(parts, liquid.velocity_field(), ViscousOperator::Walls::moving, product_);
    step_freely(relative_density(parts.constants, liquid), product_, n, liquid.velocity());
    solve::SolveReport report;
    report.products = 1;
    return report;
}

// z = M r.
void ImplicitViscosity::precondition(const LiquidParticles& liquid, const Array3& r, const Array3& z) {
    operator_.precondition(liquid, r, z);
    if (blocks_) blocks_->correct(liquid, r, z);
}

// Whether the solve ends with this r.r of all ranks.
bool ImplicitViscosity::Progress::ended(double square) {
    report.relative_residual = norm > 0 ? std::sqrt(square) / norm : 0;
    report.error_measure = std::sqrt(square);
    if (!std::isfinite(square)) return breaks_down(square, solve::Outcome::non_finite, report);
    return report.relative_residual <= parts.options.viscosity.residual;
}

solve::SolveReport ImplicitViscosity::solve_implicitly(const ViscousParts& parts) {
    auto& liquid = parts.liquid;
    const int n = liquid.store.owned();
    for (auto* array : {&residual_, &scaled_, &product_}) reserve(*array, static_cast<std::size_t>(n));
    const auto inertia = relative_density(parts.constants, liquid);
    const auto u = liquid.velocity();
    Progress progress{parts};
    // r = M u* - (C u* - walls), b = M u* + walls
    operator_.multiply(parts, liquid.velocity_field(), ViscousOperator::Walls::moving, product_);
    ++progress.report.products;
    std::array<double, 2> sums{subtract(u, inertia, product_, n, residual_), sum_squares(u, n, inertia)};
    parts.comm.sum(std::span(sums));
    // A liquid at rest between walls that move: what these add counts.
    progress.norm = std::sqrt(std::max(sums[0], sums[1]));
    const bool guessing = last_change_ >= 0;
    if (guessing) {
        reserve(before_, static_cast<std::size_t>(n));
        copy(u, n, before_);
    }
    if (!progress.ended(sums[0]) && !(guessing && start_from_last_change(progress, sums[0]))) {
        set_up(progress);
        matrix_ ? solve_assembled(progress) : iterate(progress);
    }
    if (guessing) keep_change(liquid);
    return progress.report;
}

void ImplicitViscosity::keep_change(const LiquidParticles& liquid) {
    const int n = liquid.store.owned();
    const auto change = liquid.store.get<Array3>(last_change_);
    copy(liquid.velocity(), n, change);
    subtract(before_, n, change);
}

// The preconditioner's coarse part, and the matrix.
void ImplicitViscosity::set_up(Progress& progress) {
    const auto start = Clock::now();
    const auto& parts = progress.parts;
    if (blocks_) blocks_->set_up(parts, operator_.walls(parts, ViscousOperator::Walls::resting), operator_.share(parts.liquid));
    if (matrix_) matrix_->assemble(parts, operator_);
    progress.report.set_up_seconds = seconds_since(start);
}

// u += a p with the last change p, a for the least error in the norm of C: never worse than u*. Whether that is enough.
bool ImplicitViscosity::start_from_last_change(Progress& progress, double square) {
    const auto& parts = progress.parts;
    const int n = parts.liquid.store.owned();
    const auto p = parts.liquid.store.get<Array3>(last_change_);
    operator_.multiply(parts, last_change_, ViscousOperator::Walls::resting, product_);
    ++progress.report.products;
    std::array<double, 2> sums{dot(p, product_, n), dot(p, residual_, n)};
    parts.comm.sum(std::span(sums));
    if (!(sums[0] > 0)) return progress.ended(square);
    ++progress.report.iterations;
    return progress.ended(parts.comm.sum(step(sums[1] / sums[0], p, product_, n, parts.liquid.velocity(), residual_)));
}

void ImplicitViscosity::solve_assembled(Progress& progress) {
    const auto& liquid = progress.parts.liquid;
    const auto& viscosity = progress.parts.options.viscosity;
    const bool own = viscosity.preconditioner == ViscosityPreconditioner::jacobi ||
                     viscosity.preconditioner == ViscosityPreconditioner::rigid_blocks;
    ViscousMatrix::Preconditioner ours;
    if (own) ours = [&](const Array3& r, const Array3& z) { precondition(liquid, r, z); };
    const double start = progress.report.error_measure;
    auto report = matrix_->solve(liquid, residual_, scaled_, viscosity.residual * progress.norm, ours, product_);
    turn(1, product_, liquid.store.owned(), liquid.velocity());
    report.iterations += progress.report.iterations;
    report.products += progress.report.products;
    report.set_up_seconds += progress.report.set_up_seconds;
    report.relative_residual *= start / progress.norm;
    if (report.outcome == solve::Outcome::indefinite_matrix) {
        report.reason = "the viscous matrix is not positive definite, as that of the printed form may be";
    }
    progress.report = report;
}

// Preconditioned conjugate gradients (Saad 2003, algorithm 9.1).
void ImplicitViscosity::iterate(Progress& progress) {
    const auto& parts = progress.parts;
    const auto& comm = parts.comm;
    auto& report = progress.report;
    auto& liquid = parts.liquid;
    const int n = liquid.store.owned();
    const auto u = liquid.velocity(), p = liquid.store.get<Array3>(direction_);
    precondition(liquid, residual_, scaled_);
    double rz = comm.sum(dot(residual_, scaled_, n));
    turn(0, scaled_, n, p);
    while (report.iterations < parts.options.viscosity.max_iterations) {
        if (breaks_down(rz, solve::Outcome::indefinite_preconditioner, report)) return;
        operator_.multiply(parts, direction_, ViscousOperator::Walls::resting, product_);
        ++report.products;
        const double pq = comm.sum(dot(p, product_, n));
        if (breaks_down(pq, solve::Outcome::indefinite_matrix, report)) return;
        ++report.iterations;
        const double square = step(rz / pq, p, product_, n, u, residual_);
        precondition(liquid, residual_, scaled_);
        std::array<double, 2> next{square, dot(residual_, scaled_, n)};
        comm.sum(std::span(next));
        if (progress.ended(next[0])) return;
        turn(next[1] / rz, scaled_, n, p);
        rz = next[1];
    }
    report.outcome = solve::Outcome::iteration_limit;
    report.reason = "not converged within " + std::to_string(parts.options.viscosity.max_iterations) + " iterations";
}

} // namespace treacle::sph
