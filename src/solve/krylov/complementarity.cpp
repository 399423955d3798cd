#include "solve/krylov/complementarity.hpp"

#include "base/text/clock.hpp"
#include "base/text/contract.hpp"
#include "base/text/error.hpp"
#include "solve/krylov/iteration.hpp"
#include "solve/rows/vectors.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace treacle::solve {

namespace {
// Squared norm of the violated conditions over that of the free rows' residual, above which the set changes.
constexpr double set_change_ratio = 1.0;
// A curvature below this share of what the diagonal alone would give is that of a singular matrix.
constexpr double least_curvature = 1e-12;

struct Run : Iteration {
    std::span<RowState> states;
    // A x - b; the free rows' residual; M r; direction; product; diagonal, 0 in fixed rows.
    std::span<double> gradient, r, z, p, q, diagonal;
    std::span<const unsigned char> smoothed; // rows that the caller's preconditioner serves
    int set_changes = 0;

    void find_diagonal();
    bool begin();
    void iterate();

private:
    bool free(std::size_t i) const { return states[i] == RowState::free; }
    void take_gradient();
    void precondition();
    bool renew_set();
    bool judge();
    struct Standing {
        double free = 0, wrong = 0, measured = 0; // squared norms, and the caller's measure of the free rows
    };
    Standing step(double length);
    bool change_set();
};

void Run::find_diagonal() {
    const auto& blocks = matrix.blocks();
    for (Index i = 0; i < matrix.rows(); ++i) {
        const Index* const first = blocks.diagonal_columns + blocks.diagonal_offsets[i];
        const Index* const last = blocks.diagonal_columns + blocks.diagonal_offsets[i + 1];
        const auto at = std::lower_bound(first, last, i) - blocks.diagonal_columns;
        const auto row = static_cast<std::size_t>(i);
        diagonal[row] = states[row] == RowState::fixed ? 0 : blocks.diagonal_values[at];
    }
}

void Run::take_gradient() {
    multiply(x, q);
    for (std::size_t i = 0; i < x.size(); ++i) gradient[i] = q[i] - b[i];
}

// z = M r on the free rows
void Run::precondition() {
    if (preconditioner.is_identity()) {
        std::copy(r.begin(), r.end(), z.begin());
        return;
    }
    preconditioner.apply(r, z);
    for (std::size_t i = 0; i < z.size(); ++i) {
        if (!free(i)) {
            z[i] = 0;
        } else if (options.user && smoothed[i] == 0) {
            z[i] = r[i] / diagonal[i];
        }
    }
}

// Binds and frees rows as one step of Jacobi predicts, and cuts x at zero. True when a row changed or was cut.
bool Run::renew_set() {
    std::int64_t changes = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (states[i] == RowState::fixed) continue;
        const bool was = free(i), is = diagonal[i] * x[i] - gradient[i] > 0;
        const double value = is ? std::max(0.0, x[i]) : 0.0;
        changes += static_cast<std::int64_t>(was != is || value != x[i]);
        states[i] = is ? RowState::free : RowState::bound;
        x[i] = value;
    }
    return comm.sum(changes) > 0;
}

// Evaluates the test for x >= 0 and its gradient.
bool Run::judge() {
    double square = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const bool counts = states[i] != RowState::fixed && (x[i] > 0 || gradient[i] < 0);
        r[i] = counts ? -gradient[i] : 0;
        square += r[i] * r[i];
    }
    std::array<double, 2> sums{square, measure(r)};
    comm.sum(sums);
    const double norm = std::sqrt(sums[0]);
    report.error_measure = test.local ? sums[1] : norm;
    report.relative_residual = norm_b > 0 ? norm / norm_b : norm;
    if (!std::isfinite(norm)) return end(Outcome::non_finite);
    if (passes(norm, sums[1])) return end(Outcome::converged);
    return norm == 0 && end(Outcome::stagnated);
}

bool Run::begin() {
    double square = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        x[i] = free(i) ? std::max(0.0, x[i]) : 0.0;
        if (free(i)) square += b[i] * b[i];
    }
    norm_b = std::sqrt(comm.sum(square));
    take_gradient();
    return judge();
}

// x += length p, and the gradient with it.
Run::Standing Run::step(double length) {
    double square = 0, wrong = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        x[i] += length * p[i];
        gradient[i] += length * q[i];
        r[i] = free(i) ? -gradient[i] : 0;
        square += r[i] * r[i];
        const double below =
            free(i) ? std::min(0.0, diagonal[i] * x[i]) : (diagonal[i] > 0 ? std::min(0.0, gradient[i]) : 0.0);
        wrong += below * below;
    }
    std::array<double, 3> sums{square, wrong, measure(r)};
    comm.sum(sums);
    return {sums[0], sums[1], sums[2]};
}

// True when the new set's x passes the test, or nothing can be done.
bool Run::change_set() {
    if (renew_set()) {
        ++set_changes;
        take_gradient();
    }
    return judge();
}

void Run::iterate() {
    for (std::size_t i = 0; i < x.size(); ++i) r[i] = free(i) ? -gradient[i] : 0;
    double last_rz = 0;
    while (report.iterations < options.max_iterations) {
        precondition();
        const double rz = comm.sum(dot(r, z));
        if (!std::isfinite(rz)) return void(end(Outcome::non_finite));
        if (rz < 0) return void(end(Outcome::indefinite_preconditioner));
        if (rz == 0) { // no free row has a residual
            if (change_set()) return;
            for (std::size_t i = 0; i < x.size(); ++i) r[i] = free(i) ? -gradient[i] : 0;
            last_rz = 0;
            ++report.iterations;
            continue;
        }
        if (last_rz == 0) {
            std::copy(z.begin(), z.end(), p.begin());
        } else {
            turn(rz / last_rz, z, p);
        }
        last_rz = rz;
        multiply(p, q);
        double curvature = 0, scale = 0;
        for (std::size_t i = 0; i < p.size(); ++i) {
            curvature += p[i] * q[i];
            scale += diagonal[i] * p[i] * p[i];
        }
        std::array<double, 2> sums{curvature, scale};
        comm.sum(sums);
        if (!std::isfinite(sums[0])) return void(end(Outcome::non_finite));
        if (sums[0] <= least_curvature * sums[1]) return void(end(Outcome::indefinite_matrix));
        const auto now = step(rz / sums[0]);
        ++report.iterations;
        if (!std::isfinite(now.free)) return void(end(Outcome::non_finite));
        if (!passes(std::sqrt(now.free), now.measured) && now.wrong <= set_change_ratio * now.free) continue;
        if (change_set()) return;
        for (std::size_t i = 0; i < x.size(); ++i) r[i] = free(i) ? -gradient[i] : 0;
        last_rz = 0;
    }
    end(Outcome::iteration_limit);
}
} // namespace

struct ComplementaritySolver::State {
    BuiltPreconditioner preconditioner;
    std::vector<double> gradient, r, z, p, q, diagonal;
    std::vector<unsigned char> smoothed;
    std::int64_t revision = 0; // of the matrix that `smoothed` belongs to
};

ComplementaritySolver::ComplementaritySolver(const Comm& comm, std::string prefix, KrylovOptions options)
    : comm_(comm), prefix_(std::move(prefix)), options_(std::move(options)), state_(std::make_unique<State>()) {}
ComplementaritySolver::~ComplementaritySolver() = default;
ComplementaritySolver::ComplementaritySolver(ComplementaritySolver&&) noexcept = default;
ComplementaritySolver& ComplementaritySolver::operator=(ComplementaritySolver&&) noexcept = default;

std::span<const double> ComplementaritySolver::gradient() const { return state_->gradient; }

ComplementarityReport ComplementaritySolver::solve(Matrix& matrix, std::span<const double> b, std::span<double> x,
    std::span<RowState> states, const ConvergenceTest& test) {
    const auto rows = static_cast<std::size_t>(matrix.rows());
    TREACLE_EXPECT(b.size() == rows && x.size() == rows && states.size() == rows);
    auto& s = *state_;
    for (auto* vector : {&s.gradient, &s.r, &s.z, &s.p, &s.q, &s.diagonal}) vector->resize(rows);
    s.smoothed.resize(rows);
    Run run{{comm_, matrix, options_, test, s.preconditioner, b, x}, states, s.gradient, s.r, s.z, s.p, s.q, s.diagonal,
        s.smoothed};
    auto& out = run.report;
    const auto start = Clock::now();
    if (matrix.global_rows() > 0) {
        run.find_diagonal();
        if (!run.begin()) {
            const auto set_up_start = Clock::now();
            if (s.revision != matrix.revision()) {
                for (std::size_t i = 0; i < rows; ++i) s.smoothed[i] = states[i] == RowState::free;
                s.revision = matrix.revision();
            }
            const bool ready = s.preconditioner.set_up(matrix, prefix_, options_);
            out.set_up_seconds = seconds_since(set_up_start);
            if (ready) {
                run.iterate();
            } else {
                out.outcome = Outcome::preconditioner_failed;
            }
        }
    }
    out.reason = out.outcome == Outcome::indefinite_matrix ? "the matrix is singular on the rows that are free"
                                                           : sentence(out.outcome, options_);
    out.iteration_seconds = seconds_since(start) - out.set_up_seconds;
    return {out, run.set_changes};
}

} // namespace treacle::solve
