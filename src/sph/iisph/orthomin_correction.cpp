#include "sph/iisph/orthomin_correction.hpp"

#include "base/text/clock.hpp"

#include <array>

namespace treacle::sph {

namespace {
// Dot product of a pair of owned arrays, over all ranks.
double dot(const Comm& comm, const Array<double>& a, const Array<double>& b, int count) {
    double sum = 0;
    Kokkos::parallel_reduce(
        "treacle::correction_dot", count, KOKKOS_LAMBDA(int i, double& s) { s += a(i) * b(i); }, sum);
    return comm.sum(count > 0 ? sum : 0.0);
}

// a += factor b
void add(const Array<double>& a, double factor, const Array<double>& b, int count) {
    Kokkos::parallel_for(
        "treacle::correction_add", count, KOKKOS_LAMBDA(int i) { a(i) += factor * b(i); });
}

// out = weight.source b + weight.product A q on the unknowns, 0 elsewhere: others keep their pressures.
struct Weights {
    double source, product;
};
void combine(
    const LiquidParticles& liquid, const Weights& weight, const Array<double>& product, const Array<double>& out) {
    const auto b = liquid.source();
    const auto role = liquid.role();
    Kokkos::parallel_for(
        "treacle::correction_combine", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            out(i) = role(i) == Role::poisson ? weight.source * b(i) + weight.product * product(i) : 0;
        });
}

// 1 / rho^2
struct Specific {
    Array<double> volume;
    double inverse_mass;
    KOKKOS_INLINE_FUNCTION double operator()(int i) const {
        const double specific = volume(i) * inverse_mass;
        return specific * specific;
    }
};

Specific specific_of(const StepContext& step) { return {step.liquid.volume(), 1 / step.constants.mass}; }

// Kernels are functions of their own: device compilers take none in private members.
void divide(const StepContext& step, const Array<double>& q) {
    const auto specific = specific_of(step);
    const auto p = step.liquid.pressure();
    Kokkos::parallel_for(
        "treacle::correction_start", step.liquid.store.owned(), KOKKOS_LAMBDA(int i) { q(i) = p(i) * specific(i); });
}

void write_rows(const LiquidParticles& liquid, const Array<double>& r, int first, const Array<double>& rows) {
    const auto role = liquid.role(), row = liquid.row();
    Kokkos::parallel_for(
        "treacle::correction_rows", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            if (role(i) == Role::poisson) rows(row(i) - first) = r(i);
        });
}

void read_rows(const StepContext& step, const Array<double>& rows, int first, const Array<double>& out) {
    const auto specific = specific_of(step);
    const auto role = step.liquid.role(), row = step.liquid.row();
    Kokkos::parallel_for(
        "treacle::correction_direction", step.liquid.store.owned(),
        KOKKOS_LAMBDA(int i) { out(i) = role(i) == Role::poisson ? rows(row(i) - first) * specific(i) : 0; });
}

void write_pressures(const StepContext& step, const Array<double>& q) {
    const auto specific = specific_of(step);
    const auto p = step.liquid.pressure();
    const auto role = step.liquid.role();
    Kokkos::parallel_for(
        "treacle::corrected_pressures", step.liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            if (role(i) == Role::poisson) p(i) = math::max(0.0, q(i) / specific(i));
        });
}

// The mean of the positive residuals as compression, over the unknowns.
double mean_excess(const StepContext& step, const Array<double>& r, double dt) {
    const auto role = step.liquid.role();
    std::array<double, 2> sums{};
    Kokkos::parallel_reduce(
        "treacle::correction_measure", step.liquid.store.owned(),
        KOKKOS_LAMBDA(int i, double& excess, double& unknowns) {
            excess += math::max(0.0, r(i));
            unknowns += role(i) == Role::poisson ? 1 : 0;
        },
        sums[0], sums[1]);
    if (step.liquid.store.owned() == 0) sums = {};
    step.comm.sum(std::span(sums));
    return sums[1] > 0 ? sums[0] / sums[1] * dt * dt / step.constants.rest_density : 0;
}
} // namespace

void OrthominCorrection::start(const CorrectionParts& parts, Iisph& system, double dt) {
    auto& liquid = parts.step.liquid;
    const auto n = static_cast<std::size_t>(liquid.store.owned());
    reserve(q_, n);
    reserve(residual_, n);
    reserve(rows_, static_cast<std::size_t>(parts.matrix.rows()));
    system.prepare(parts.step, dt);
    divide(parts.step, q_);
    system.multiply(parts.step, q_);
    combine(liquid, {1, -1}, system.product(), residual_);
}

// out = M r / rho^2, by way of the host, where the solver is: 16 bytes a row.
void OrthominCorrection::precondition(const CorrectionParts& parts, const Array<double>& out) {
    const int first = parts.matrix.first_row();
    write_rows(parts.step.liquid, residual_, first, rows_);
    const auto count = static_cast<std::size_t>(parts.matrix.rows());
    const auto host = on_host(rows_);
    preconditioned_.resize(count);
    parts.solver.precondition({host.data(), count}, preconditioned_);
    assign(rows_, preconditioned_);
    read_rows(parts.step, rows_, first, out);
}

void OrthominCorrection::orthogonalise(const Comm& comm, std::size_t number, int count) {
    auto& now = directions_[number];
    for (std::size_t k = 0; k < number; ++k) {
        const auto& before = directions_[k];
        if (!(before.square > 0)) continue;
        const double projection = dot(comm, now.product, before.product, count) / before.square;
        add(now.step, -projection, before.step, count);
        add(now.product, -projection, before.product, count);
    }
    now.square = dot(comm, now.product, now.product, count);
}

void OrthominCorrection::advance(const Comm& comm, const Direction& along, int count) {
    if (!(along.square > 0)) return;
    const double length = dot(comm, residual_, along.product, count) / along.square;
    add(q_, length, along.step, count);
    add(residual_, -length, along.product, count);
}

solve::SolveReport OrthominCorrection::correct(const CorrectionParts& parts, Iisph& system, double dt) {
    const auto began = Clock::now();
    const auto& options = parts.step.options.pressure;
    const auto& comm = parts.step.comm;
    auto& liquid = parts.step.liquid;
    const int n = liquid.store.owned();
    solve::SolveReport out;
    start(parts, system, dt);
    out.error_measure = mean_excess(parts.step, residual_, dt);
    int& done = out.iterations;
    for (; done < options.corrections && out.error_measure >= options.density_tolerance(); ++done) {
        const auto number = static_cast<std::size_t>(done);
        if (directions_.size() <= number) directions_.emplace_back();
        auto& now = directions_[number];
        reserve(now.step, static_cast<std::size_t>(n));
        reserve(now.product, static_cast<std::size_t>(n));
        if (done == 0) parts.solver.set_up(parts.matrix);
        precondition(parts, now.step);
        system.multiply(parts.step, now.step);
        combine(liquid, {0, 1}, system.product(), now.product);
        orthogonalise(comm, number, n);
        advance(comm, now, n);
        out.error_measure = mean_excess(parts.step, residual_, dt);
    }
    if (done > 0) write_pressures(parts.step, q_);
    out.products = done + 1;
    out.iteration_seconds = seconds_since(began);
    return out;
}

std::size_t OrthominCorrection::bytes() const {
    std::size_t total = q_.span() + residual_.span() + rows_.span() + preconditioned_.capacity();
    for (const auto& one : directions_) total += one.step.span() + one.product.span();
    return 8 * total;
}

} // namespace treacle::sph
