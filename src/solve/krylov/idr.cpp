#include "solve/krylov/idr.hpp"

#include "base/text/clock.hpp"
#include "base/text/contract.hpp"
#include "solve/rows/vectors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace treacle::solve {

namespace {
// A cycle that takes less than this off of the residual has come to its end; the next one has other shadows.
constexpr double least_gain = 0.02;
constexpr int max_stagnant_cycles = 2;
// Rounding ends what the recurrences can do: near a breakdown of M they lose accuracy, stop far above the target and would
// grow from there. A cycle without a new least residual for so many steps to the next space ends; it ends sooner where it
// has fallen so far below its largest that this is the likely reason.
constexpr int most_vain_rounds = 20, most_vain_rounds_far_down = 4;
constexpr double deep_residual_drop = 1e-6;
// x is kept whenever its residual is this much less than that of the x kept before.
constexpr double best_iterate_ratio = 0.1;
// Below this cosine between a residual and its product the step is longer than what makes the residual least, so that the
// recurrences keep their accuracy (Sleijpen & van der Vorst 1995).
constexpr double least_cosine = 0.7;
// Rows that are processed with all vectors before the next ones: what they have of one vector stays in the cache.
constexpr std::size_t block_rows = 1024;
constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();

// Evenly in [-1, 1), by number (Steele et al. 2014).
double noise(std::uint64_t n) {
    n += 0x9e3779b97f4a7c15ULL;
    n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9ULL;
    n = (n ^ (n >> 27)) * 0x94d049bb133111ebULL;
    return static_cast<double>((n ^ (n >> 31)) >> 11) * 0x1p-52 - 1;
}

// A part of all vectors.
struct Block {
    std::size_t from, rows;
    std::span<const double> of(std::span<const double> vector) const { return vector.subspan(from, rows); }
    std::span<double> of(std::span<double> vector) const { return vector.subspan(from, rows); }
    std::span<double> of(std::vector<double>& vector) const { return std::span(vector).subspan(from, rows); }
    std::span<const double> of(const std::vector<double>& vector) const {
        return std::span(vector).subspan(from, rows);
    }
};

template <class Work>
void each_block(std::size_t rows, const Work& work) {
    for (std::size_t from = 0; from < rows; from += block_rows) work(Block{from, std::min(block_rows, rows - from)});
}
} // namespace

// Projections on the shadow space: M = P^T G, lower triangular, f = P^T r.
struct Idr::Small {
    std::size_t s;
    std::vector<double> m, f, c, along, alpha;
    double omega = 1;

    explicit Small(std::size_t shadow_space_dimension)
        : s(shadow_space_dimension), m(s * s, 0.0), f(s, 0.0), c(s, 0.0), along(s, 0.0), alpha(s, 0.0) {
        for (std::size_t k = 0; k < s; ++k) m[k * s + k] = 1;
    }
    // The part [from, to) of M x = right.
    void solve(std::size_t from, std::size_t to, const std::vector<double>& right, std::vector<double>& x) const {
        for (std::size_t i = from; i < to; ++i) {
            double sum = right[i];
            for (std::size_t j = from; j < i; ++j) sum -= m[i * s + j] * x[j];
            x[i] = sum / m[i * s + i];
        }
    }
    // Column k of M for a direction with the products `along`, after it has lost its part along those before it, by alpha.
    void take(std::size_t k) {
        solve(0, k, along, alpha);
        for (std::size_t i = k; i < s; ++i) {
            double sum = along[i];
            for (std::size_t j = 0; j < k; ++j) sum -= alpha[j] * m[i * s + j];
            m[i * s + k] = sum;
        }
    }
};

double Idr::norm(const Operator& a, std::span<const double> r) const {
    return std::sqrt(comm_.sum(weighted(a.weights, r, r)));
}

void Idr::draw_shadows(const Operator& a, std::uint64_t cycle) {
    const std::size_t rows = a.weights.size();
    const auto rank = static_cast<std::uint64_t>(comm_.rank());
    for (std::size_t k = 0; k < shadows_.size(); ++k) {
        shadows_[k].resize(rows);
        const std::uint64_t stream = (cycle << 52) ^ ((rank * shadows_.size() + k) << 32);
        for (std::size_t i = 0; i < rows; ++i) shadows_[k][i] = std::sqrt(a.weights[i]) * noise(stream + i);
    }
}

void Idr::begin_cycle() {
    for (auto* vectors : {&u_, &g_}) {
        for (auto& vector : *vectors) vector.assign(r_.size(), 0.0);
    }
}

void Idr::project_residual(Small& small) const {
    for (std::size_t k = 0; k < small.s; ++k) small.f[k] = dot(shadows_[k], r_);
    comm_.sum(std::span(small.f));
}

// u_k = omega M v + U c and g_k = A u_k, with v = r - G c orthogonal to the shadow vectors from k on.
void Idr::find_direction(const Operator& a, Small& small, std::size_t k) {
    const auto& c = small.c;
    small.solve(k, small.s, small.f, small.c);
    each_block(r_.size(), [&](const Block& block) {
        const auto v = block.of(v_);
        std::copy_n(block.of(r_).begin(), block.rows, v.begin());
        for (std::size_t i = k; i < small.s; ++i) add(-c[i], block.of(g_[i]), v);
    });
    a.precondition(v_, z_);
    each_block(r_.size(), [&](const Block& block) {
        const auto z = block.of(z_);
        for (double& value : z) value *= small.omega;
        for (std::size_t i = k; i < small.s; ++i) add(c[i], block.of(u_[i]), z);
    });
    std::swap(u_[k], z_);
    a.multiply(u_[k], g_[k]);
}

// g_k and u_k become orthogonal to the first k shadow vectors; r, then orthogonal to vector k, and x follow. Returns
// |r|, or no number where the step would lead nowhere; x is as it was then.
double Idr::step_along(const Operator& a, Small& small, std::size_t k, std::span<double> x) {
    std::fill(small.along.begin(), small.along.end(), 0.0);
    each_block(r_.size(), [&](const Block& block) {
        for (std::size_t i = 0; i < small.s; ++i) small.along[i] += dot(block.of(shadows_[i]), block.of(g_[k]));
    });
    comm_.sum(std::span(small.along));
    small.take(k);
    const double beta = small.f[k] / small.m[k * small.s + k];
    if (!std::isfinite(beta)) return nowhere;
    double square = 0;
    each_block(r_.size(), [&](const Block& block) {
        const auto g = block.of(g_[k]), u = block.of(u_[k]), r = block.of(r_);
        for (std::size_t j = 0; j < k; ++j) {
            add(-small.alpha[j], block.of(g_[j]), g);
            add(-small.alpha[j], block.of(u_[j]), u);
        }
        add(-beta, g, r);
        add(beta, u, block.of(x));
        square += weighted(block.of(a.weights), r, r);
    });
    for (std::size_t i = k + 1; i < small.s; ++i) small.f[i] -= beta * small.m[i * small.s + k];
    return std::sqrt(comm_.sum(square));
}

// The step to the next space: r -= omega A M r. Returns as step_along() does.
double Idr::reduce(const Operator& a, Small& small, std::span<double> x, double residual) {
    a.precondition(r_, z_);
    a.multiply(z_, v_);
    double products[2] = {weighted(a.weights, v_, r_), weighted(a.weights, v_, v_)};
    comm_.sum(std::span<double>(products));
    const double cosine = std::fabs(products[0]) / (std::sqrt(products[1]) * residual);
    small.omega = products[0] / products[1] * std::max(1.0, least_cosine / cosine);
    if (!std::isfinite(small.omega)) return nowhere;
    double square = 0;
    each_block(r_.size(), [&](const Block& block) {
        const auto r = block.of(r_);
        add(small.omega, block.of(z_), block.of(x));
        add(-small.omega, block.of(v_), r);
        square += weighted(block.of(a.weights), r, r);
    });
    return std::sqrt(comm_.sum(square));
}

// Until the residual of the recurrence is at the target, or is no number, or falls no more, or the iterations are spent. x is
// then the last one, or the one that was kept if that one's residual is less.
void Idr::run_cycle(const Operator& a, std::span<double> x, double residual, double target, SolveReport& report) {
    Small small(shadows_.size());
    double least = residual, largest = residual, kept = residual;
    int vain_rounds = 0;
    const auto keep = [&] {
        std::copy(x.begin(), x.end(), kept_.begin());
        kept = residual;
    };
    const auto goes_on = [&] {
        return residual > target && std::isfinite(residual) && report.iterations < options_.max_iterations;
    };
    const auto falls = [&] {
        return vain_rounds < (least < deep_residual_drop * largest ? most_vain_rounds_far_down : most_vain_rounds);
    };
    begin_cycle();
    keep();
    while (goes_on() && falls()) {
        project_residual(small);
        for (std::size_t k = 0; k < small.s && goes_on(); ++k) {
            find_direction(a, small, k);
            residual = step_along(a, small, k, x);
            largest = std::max(largest, residual);
            ++report.iterations;
        }
        if (!goes_on()) break;
        residual = reduce(a, small, x, residual);
        ++report.iterations;
        vain_rounds = residual < least ? 0 : vain_rounds + 1;
        least = std::min(least, residual);
        if (residual < best_iterate_ratio * kept) keep();
    }
    if (!(residual <= kept)) std::copy(kept_.begin(), kept_.end(), x.begin());
}

SolveReport Idr::solve(const Operator& a, std::span<const double> b, std::span<double> x, double relative) {
    TREACLE_EXPECT(x.size() == b.size() && relative > 0);
    const auto start = Clock::now();
    SolveReport report;
    const double norm_b = norm(a, b), target = relative * norm_b;
    for (auto* vectors : {&shadows_, &u_, &g_})
        vectors->resize(static_cast<std::size_t>(options_.shadow_space_dimension));
    for (auto* vector : {&r_, &v_, &z_, &kept_}) vector->resize(b.size());
    const auto end = [&](Outcome outcome, const char* reason) {
        report.outcome = outcome;
        report.reason = reason;
    };
    double before = 0;
    int vain = 0;
    for (std::uint64_t cycle = 0;; ++cycle) {
        a.multiply(x, r_);
        for (std::size_t i = 0; i < r_.size(); ++i) r_[i] = b[i] - r_[i];
        const double residual = norm(a, r_);
        report.error_measure = residual;
        report.relative_residual = norm_b > 0 ? residual / norm_b : residual;
        report.products = report.iterations + static_cast<int>(cycle) + 1;
        vain = cycle > 0 && residual > (1 - least_gain) * before ? vain + 1 : 0;
        before = residual;
        if (!std::isfinite(residual)) end(Outcome::non_finite, "the system or an iterate is not finite");
        // Rounding lets the residual of the recurrence be smaller than that of x.
        else if (residual <= (cycle == 0 ? 1.0 : 1.01) * target || residual == 0)
            end(Outcome::converged, "converged");
        else if (report.iterations >= options_.max_iterations)
            end(Outcome::iteration_limit, "not converged within the limit of iterations");
        else if (vain == max_stagnant_cycles)
            end(Outcome::stagnated, "the residual does not fall any more");
        else {
            draw_shadows(a, cycle);
            run_cycle(a, x, residual, target, report);
            continue;
        }
        break;
    }
    report.iteration_seconds = seconds_since(start);
    return report;
}

std::size_t Idr::bytes() const {
    std::size_t total = r_.capacity() + v_.capacity() + z_.capacity() + kept_.capacity();
    for (const auto* vectors : {&shadows_, &u_, &g_}) {
        for (const auto& vector : *vectors) total += vector.capacity();
    }
    return 8 * total;
}

} // namespace treacle::solve
