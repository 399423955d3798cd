#include "sph/implicit_viscosity.hpp"

#include "base/clock.hpp"
#include "sph/bodies.hpp"

#include <array>
#include <cmath>
#include <numeric>

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

double dot(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// a += c b
void add(std::vector<double>& a, double c, const std::vector<double>& b) {
    for (std::size_t k = 0; k < a.size(); ++k) a[k] += c * b[k];
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
                                     const CellGrid& grid, const std::vector<double>& friction,
                                     const std::vector<double>& slip_lengths, const std::vector<FlowCurve>& rheology)
    : operator_(liquid, slip_lengths), friction_(upload(friction)), rheology_("treacle::flow_curves", rheology.size()),
      direction_(liquid.store.add<Array3>("viscous_direction", "m/s", FieldRole::work)) {
    const bool keeps_rotations = options.form != ViscosityForm::laplacian;
    if (options.preconditioner == ViscosityPreconditioner::rigid_blocks && keeps_rotations) {
        blocks_ = std::make_unique<RigidBlocks>(comm, liquid, grid);
    }
    auto host = Kokkos::create_mirror_view(rheology_);
    for (std::size_t k = 0; k < rheology.size(); ++k) host(k) = rheology[k];
    Kokkos::deep_copy(rheology_, host);
}

ImplicitViscosity::Result ImplicitViscosity::solve(const ViscousScene& scene, const Bodies& bodies, double dt) {
    const auto start = Clock::now();
    dt_ = dt;
    const ViscousParts parts{scene, bodies.load_points(), friction_, bodies.motion()};
    Result out;
    if (operator_.prepare(parts, dt) == 0) return out;
    movers_.prepare(bodies, scene);
    body_.q.assign(movers_.unknowns(), 0.0);
    if (rheology_.extent(0) == 0) {
        out.solve = iterate(parts, bodies, scene.liquid.velocity(), 0);
    } else {
        solve_by_rates(parts, bodies, dt, out);
    }
    const ViscousParts after{scene, bodies.load_points(), friction_, movers_.any() ? movers_.moved(bodies, body_.q) : bodies.motion()};
    if (out.solve.iterations > 0) { // else the last product was of these velocities
        operator_.multiply(after, scene.liquid.velocity_field(), ViscousOperator::Walls::moving, product_);
        ++out.solve.products;
    }
    out.loads = operator_.loads(after);
    if (rheology_.extent(0) > 0) operator_.thin(after, rheology_);
    out.solve.iteration_seconds = seconds_since(start);
    return out;
}

// Fixed point on the viscosities: each solve has those of the velocities of the one before, the first one those of the
// last step.
void ImplicitViscosity::solve_by_rates(const ViscousParts& parts, const Bodies& bodies, double dt, Result& result) {
    auto& liquid = parts.liquid;
    const auto& options = parts.options.viscosity;
    const auto rows = Kokkos::make_pair(0, liquid.store.owned());
    reserve(before_, static_cast<std::size_t>(liquid.store.owned()));
    Kokkos::deep_copy(Kokkos::subview(before_, rows, Kokkos::ALL()), Kokkos::subview(liquid.velocity(), rows, Kokkos::ALL()));
    auto& sum = result.solve;
    for (int k = 0; k < options.rheology_solves; ++k) {
        if (k > 0) {
            const ViscousParts now{parts, parts.points, parts.friction,
                                   movers_.any() ? movers_.moved(bodies, body_.q) : bodies.motion()};
            operator_.multiply(now, liquid.velocity_field(), ViscousOperator::Walls::moving, product_);
            operator_.thin(now, rheology_);
            operator_.prepare(parts, dt);
            ++sum.products;
        }
        const auto one = iterate(parts, bodies, before_, k > 0 ? options.rheology_residual : 0);
        const int iterations = sum.iterations + one.iterations, products = sum.products + one.products;
        const double set_up = sum.set_up_seconds + one.set_up_seconds;
        sum = one;
        sum.iterations = iterations;
        sum.products = products;
        sum.set_up_seconds = set_up;
        if (!one.converged() || one.iterations == 0) return;
    }
}

// L^T (dt/m) F of the velocities of the last multiply, of which the parts have the motion of the bodies. Collective.
std::vector<double> ImplicitViscosity::pull(const ViscousParts& parts) {
    auto loads = operator_.loads(parts);
    parts.comm.sum(std::span(loads));
    auto out = movers_.project(loads);
    for (double& entry : out) entry *= dt_ / parts.constants.mass;
    return out;
}

// Products with the directions; returns p.C p of all ranks.
double ImplicitViscosity::multiply(const ViscousParts& parts, std::vector<double>& body_product) {
    using Walls = ViscousOperator::Walls;
    const auto p = parts.liquid.store.get<Array3>(direction_);
    const int n = parts.liquid.store.owned();
    if (!movers_.any()) {
        operator_.multiply(parts, direction_, Walls::resting, product_);
        return parts.comm.sum(dot(p, product_, n));
    }
    const ViscousParts trial{parts, parts.points, parts.friction, movers_.trial(body_.direction)};
    operator_.multiply(trial, direction_, Walls::moving, product_);
    body_product = body_.direction;
    add(body_product, -1, pull(trial));
    return parts.comm.sum(dot(p, product_, n)) + dot(body_.direction, body_product);
}

// z = M r; returns this rank's r.z of the particles.
double ImplicitViscosity::precondition(const LiquidParticles& liquid) {
    operator_.precondition(liquid, residual_, scaled_);
    if (blocks_) blocks_->correct(liquid, residual_, scaled_);
    if (movers_.any()) body_.scaled = movers_.precondition(body_.residual);
    return dot(residual_, scaled_, liquid.store.owned());
}

// Preconditioned conjugate gradients (Saad 2003, algorithm 9.1) for C u = before, from the present velocities on. Not a
// single iteration when these leave no larger a relative residual than `enough`.
solve::SolveReport ImplicitViscosity::iterate(const ViscousParts& parts, const Bodies& bodies, const Array3& before,
                                              double enough) {
    using Walls = ViscousOperator::Walls;
    const auto& comm = parts.comm;
    auto& liquid = parts.liquid;
    const int n = liquid.store.owned();
    for (auto* array : {&residual_, &scaled_, &product_}) reserve(*array, static_cast<std::size_t>(n));
    const auto inertia = relative_density(parts.constants, liquid);
    const auto u = liquid.velocity(), p = liquid.store.get<Array3>(direction_);
    solve::SolveReport report;
    // r = M u* - (C u - walls), b = M u* + walls
    const ViscousParts first{parts, parts.points, parts.friction,
                             movers_.any() ? movers_.moved(bodies, body_.q) : parts.motion};
    operator_.multiply(first, liquid.velocity_field(), Walls::moving, product_);
    ++report.products;
    if (movers_.any()) {
        body_.residual = pull(first);
        add(body_.residual, -1, body_.q);
    }
    std::array<double, 2> sums{subtract(before, inertia, product_, n, residual_), sum_squares(before, n, inertia)};
    comm.sum(std::span(sums));
    sums[0] += dot(body_.residual, body_.residual);
    // A liquid at rest between walls that move: what these add counts.
    const double norm = std::sqrt(std::max(sums[0], sums[1]));
    const auto ended = [&](double square) {
        report.relative_residual = norm > 0 ? std::sqrt(square) / norm : 0;
        report.error_measure = std::sqrt(square);
        if (!std::isfinite(square)) return breaks_down(square, solve::Outcome::non_finite, report);
        return report.relative_residual <= std::max(parts.options.viscosity.residual, report.iterations == 0 ? enough : 0);
    };
    if (ended(sums[0])) return report;
    if (blocks_) {
        const auto start = Clock::now();
        blocks_->set_up(parts, operator_.walls(parts, Walls::resting), operator_.share(liquid), operator_.slip());
        report.set_up_seconds = seconds_since(start);
    }
    if (movers_.any()) {
        auto held = operator_.stiffness(parts);
        comm.sum(std::span(held));
        movers_.factorise(held);
    }
    double rz = comm.sum(precondition(liquid)) + dot(body_.residual, body_.scaled);
    turn(0, scaled_, n, p);
    body_.direction = body_.scaled;
    std::vector<double> body_product;
    while (report.iterations < parts.options.viscosity.max_iterations) {
        if (breaks_down(rz, solve::Outcome::indefinite_preconditioner, report)) return report;
        const double pq = multiply(parts, body_product);
        ++report.products;
        if (breaks_down(pq, solve::Outcome::indefinite_matrix, report)) return report;
        ++report.iterations;
        const double square = step(rz / pq, p, product_, n, u, residual_);
        add(body_.q, rz / pq, body_.direction);
        add(body_.residual, -rz / pq, body_product);
        std::array<double, 2> next{square, precondition(liquid)};
        comm.sum(std::span(next));
        next[0] += dot(body_.residual, body_.residual);
        next[1] += dot(body_.residual, body_.scaled);
        if (ended(next[0])) return report;
        turn(next[1] / rz, scaled_, n, p);
        for (std::size_t k = 0; k < body_.q.size(); ++k) body_.direction[k] = body_.scaled[k] + next[1] / rz * body_.direction[k];
        rz = next[1];
    }
    report.outcome = solve::Outcome::iteration_limit;
    report.reason = "not converged within " + std::to_string(parts.options.viscosity.max_iterations) + " iterations";
    return report;
}

} // namespace treacle::sph
