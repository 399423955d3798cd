#include "sph/implicit_viscosity.hpp"

#include "base/clock.hpp"
#include "sph/bodies.hpp"
#include "sph/inflow.hpp"

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

// The rows of particles that an inlet holds are M u = M u*: that velocity is prescribed.
void hold_rows(const LiquidParticles& liquid, const RelativeDensity& inertia, const Array3& u, const Array3& product) {
    if (!liquid.has_inlets()) return;
    const auto inlet = liquid.inlet();
    Kokkos::parallel_for("treacle::viscous_held", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
        if (inlet(i) == 0) return;
        for (int k = 0; k < 3; ++k) product(i, k) = inertia(i) * u(i, k);
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
    const bool keeps_rotations = options.form != ViscosityForm::laplacian;
    if (options.preconditioner == ViscosityPreconditioner::rigid_blocks && keeps_rotations) {
        blocks_ = std::make_unique<RigidBlocks>(comm, liquid, grid);
    }
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
    out.solve = iterate(parts);
    if (out.solve.iterations > 0) { // else the last product was of these velocities
        operator_.multiply(parts, liquid.velocity_field(), ViscousOperator::Walls::moving, product_);
        ++out.solve.products;
    }
    out.loads = operator_.loads(parts);
    out.solve.iteration_seconds = seconds_since(start);
    return out;
}

// z = M r; returns this rank's r.z.
double ImplicitViscosity::precondition(const LiquidParticles& liquid) {
    operator_.precondition(liquid, residual_, scaled_);
    if (blocks_) blocks_->correct(liquid, residual_, scaled_);
    clear_held(liquid, scaled_);
    return dot(residual_, scaled_, liquid.store.owned());
}

// Preconditioned conjugate gradients (Saad 2003, algorithm 9.1).
solve::SolveReport ImplicitViscosity::iterate(const ViscousParts& parts) {
    using Walls = ViscousOperator::Walls;
    const auto& comm = parts.comm;
    auto& liquid = parts.liquid;
    const int n = liquid.store.owned();
    for (auto* array : {&residual_, &scaled_, &product_}) reserve(*array, static_cast<std::size_t>(n));
    const auto inertia = relative_density(parts.constants, liquid);
    const auto u = liquid.velocity(), p = liquid.store.get<Array3>(direction_);
    solve::SolveReport report;
    // r = M u* - (C u* - walls), b = M u* + walls
    operator_.multiply(parts, liquid.velocity_field(), Walls::moving, product_);
    hold_rows(liquid, inertia, u, product_);
    ++report.products;
    std::array<double, 2> sums{subtract(u, inertia, product_, n, residual_), sum_squares(u, n, inertia)};
    comm.sum(std::span(sums));
    // A liquid at rest between walls that move: what these add counts.
    const double norm = std::sqrt(std::max(sums[0], sums[1]));
    const auto ended = [&](double square) {
        report.relative_residual = norm > 0 ? std::sqrt(square) / norm : 0;
        report.error_measure = std::sqrt(square);
        if (!std::isfinite(square)) return breaks_down(square, solve::Outcome::non_finite, report);
        return report.relative_residual <= parts.options.viscosity.residual;
    };
    if (ended(sums[0])) return report;
    if (blocks_) {
        const auto start = Clock::now();
        blocks_->set_up(parts, operator_.walls(parts, Walls::resting), operator_.share(liquid));
        report.set_up_seconds = seconds_since(start);
    }
    double rz = comm.sum(precondition(liquid));
    turn(0, scaled_, n, p);
    while (report.iterations < parts.options.viscosity.max_iterations) {
        if (breaks_down(rz, solve::Outcome::indefinite_preconditioner, report)) return report;
        operator_.multiply(parts, direction_, Walls::resting, product_);
        hold_rows(liquid, inertia, p, product_);
        ++report.products;
        const double pq = comm.sum(dot(p, product_, n));
        if (breaks_down(pq, solve::Outcome::indefinite_matrix, report)) return report;
        ++report.iterations;
        const double square = step(rz / pq, p, product_, n, u, residual_);
        std::array<double, 2> next{square, precondition(liquid)};
        comm.sum(std::span(next));
        if (ended(next[0])) return report;
        turn(next[1] / rz, scaled_, n, p);
        rz = next[1];
    }
    report.outcome = solve::Outcome::iteration_limit;
    report.reason = "not converged within " + std::to_string(parts.options.viscosity.max_iterations) + " iterations";
    return report;
}

} // namespace treacle::sph
