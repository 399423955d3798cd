#include "rigid/constrained_inverse_mass.hpp"

#include "base/text/contract.hpp"

#include <algorithm>

namespace treacle::rigid {

namespace {
// Fraction of a row's own response that others leave when the row depends on others: the square of how far off
// roundings and gaps put it.
constexpr double redundant = 1e-9;
// Rest of a diagonal entry of the response, over the entry, when it depends on other motions.
constexpr double same_motion = 1e-12;

Vec3 part(std::span<const double> numbers, std::size_t at) { return {numbers[at], numbers[at + 1], numbers[at + 2]}; }

void add(std::vector<double>& numbers, std::size_t at, const Vec3& v) {
    for (std::size_t k = 0; k < 3; ++k) numbers[at + k] += v[k];
}
} // namespace

ConstrainedInverseMass::ConstrainedInverseMass(std::vector<Response> bodies, std::vector<ConstraintRow> rows)
    : bodies_(std::move(bodies)), rows_(std::move(rows)), linked_(bodies_.size(), 0) {
    for (const auto& row : rows_) {
        linked_[row.body] = 1;
        if (row.other >= 0) linked_[static_cast<std::size_t>(row.other)] = 1;
    }
    factorise();
}

double ConstrainedInverseMass::meet(const ConstraintRow& a, const ConstraintRow& b) const {
    const auto through = [&](int body, const Vec3& angular, const Vec3& other_angular) {
        const auto& response = bodies_[static_cast<std::size_t>(body)];
        return dot(a.linear, response.linear * b.linear) + dot(angular, response.angular * other_angular);
    };
    const int first = static_cast<int>(a.body), second = static_cast<int>(b.body);
    double sum = 0;
    if (first == second) sum += through(first, a.angular, b.angular);
    if (first == b.other) sum -= through(first, a.angular, b.other_angular);
    if (a.other >= 0 && a.other == second) sum -= through(second, a.other_angular, b.angular);
    if (a.other >= 0 && a.other == b.other) sum += through(a.other, a.other_angular, b.other_angular);
    return sum;
}

// Response of the row if nothing of its bodies were locked.
double ConstrainedInverseMass::most(const ConstraintRow& row) const {
    const auto bound = [&](std::size_t body, const Vec3& angular) {
        double linear = 0, turn = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            linear = std::max(linear, bodies_[body].linear[k][k]);
            turn = std::max(turn, bodies_[body].angular[k][k]);
        }
        return linear * dot(row.linear, row.linear) + turn * dot(angular, angular);
    };
    const double other = row.other < 0 ? 0 : bound(static_cast<std::size_t>(row.other), row.other_angular);
    return bound(row.body, row.angular) + other;
}

// Cholesky with the largest pivot first, rows scaled to a unit diagonal, up to the rank.
void ConstrainedInverseMass::factorise() {
    const std::size_t n = rows_.size();
    std::vector<std::size_t> open;
    std::vector<double> scale(n, 0.0), left(n, 1.0);
    for (std::size_t i = 0; i < n; ++i) {
        const double own = meet(rows_[i], rows_[i]);
        if (own <= redundant * most(rows_[i])) continue; // held by locked degrees of freedom already
        scale[i] = 1 / std::sqrt(own);
        open.push_back(i);
    }
    std::vector<std::vector<double>> lower(n); // of each row, towards those eliminated before
    while (!open.empty()) {
        const auto next = std::ranges::max_element(open, {}, [&](std::size_t i) { return left[i]; });
        const std::size_t p = *next;
        if (left[p] <= redundant) break;
        open.erase(next);
        const double pivot = std::sqrt(left[p]);
        for (const std::size_t i : open) {
            double entry = meet(rows_[i], rows_[p]) * scale[i] * scale[p];
            for (std::size_t c = 0; c < lower[p].size(); ++c) entry -= lower[i][c] * lower[p][c];
            lower[i].push_back(entry / pivot);
            left[i] -= lower[i].back() * lower[i].back();
        }
        lower[p].push_back(pivot);
        kept_.push_back(p);
        scale_.push_back(scale[p]);
        factor_.push_back(lower[p]);
    }
}

std::vector<double> ConstrainedInverseMass::rates(std::span<const double> velocities) const {
    std::vector<double> out;
    for (const auto& row : rows_) {
        double rate =
            dot(row.linear, part(velocities, 6 * row.body)) + dot(row.angular, part(velocities, 6 * row.body + 3));
        if (row.other >= 0) {
            const std::size_t at = 6 * static_cast<std::size_t>(row.other);
            rate -= dot(row.linear, part(velocities, at)) + dot(row.other_angular, part(velocities, at + 3));
        }
        out.push_back(rate);
    }
    return out;
}

std::vector<double> ConstrainedInverseMass::impulses_for(std::span<const double> changes) const {
    TREACLE_EXPECT(changes.size() == rows_.size());
    const std::size_t n = kept_.size();
    std::vector<double> x(n);
    for (std::size_t i = 0; i < n; ++i) {
        x[i] = scale_[i] * changes[kept_[i]];
        for (std::size_t c = 0; c < i; ++c) x[i] -= factor_[i][c] * x[c];
        x[i] /= factor_[i][i];
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t c = i + 1; c < n; ++c) x[i] -= factor_[c][i] * x[c];
        x[i] /= factor_[i][i];
    }
    std::vector<double> out(6 * bodies_.size(), 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        const auto& row = rows_[kept_[i]];
        const double size = scale_[i] * x[i];
        add(out, 6 * row.body, size * row.linear);
        add(out, 6 * row.body + 3, size * row.angular);
        if (row.other < 0) continue;
        add(out, 6 * static_cast<std::size_t>(row.other), -size * row.linear);
        add(out, 6 * static_cast<std::size_t>(row.other) + 3, -size * row.other_angular);
    }
    return out;
}

std::vector<double> ConstrainedInverseMass::alone(std::span<const double> impulses) const {
    TREACLE_EXPECT(impulses.size() == 6 * bodies_.size());
    std::vector<double> out(impulses.size(), 0.0);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        add(out, 6 * b, bodies_[b].linear * part(impulses, 6 * b));
        add(out, 6 * b + 3, bodies_[b].angular * part(impulses, 6 * b + 3));
    }
    return out;
}

std::vector<double> ConstrainedInverseMass::reaction(std::span<const double> impulses) const {
    if (rows_.empty()) return std::vector<double>(impulses.size(), 0.0);
    auto changes = rates(alone(impulses));
    for (double& change : changes) change = -change;
    return impulses_for(changes);
}

std::vector<double> ConstrainedInverseMass::respond(std::span<const double> impulses) const {
    if (rows_.empty()) return alone(impulses);
    auto all = reaction(impulses);
    for (std::size_t k = 0; k < all.size(); ++k) all[k] += impulses[k];
    return alone(all);
}

bool ConstrainedInverseMass::can_move(std::size_t body) const {
    for (std::size_t k = 0; k < 6; ++k) {
        std::vector<double> impulse(6 * bodies_.size(), 0.0);
        impulse[6 * body + k] = 1;
        if (respond(impulse)[6 * body + k] > redundant * alone(impulse)[6 * body + k]) return true;
    }
    return false;
}

// Cholesky with the largest pivot first, rows scaled to a unit diagonal, up to the rank.
std::vector<std::vector<double>> ConstrainedInverseMass::columns() const {
    const std::size_t n = 6 * bodies_.size();
    std::vector<std::vector<double>> a(n);
    std::vector<double> scale(n, 0.0), left(n, 0.0), impulse(n, 0.0);
    for (std::size_t k = 0; k < n; ++k) {
        impulse[k] = 1;
        a[k] = respond(impulse);
        impulse[k] = 0;
        if (!(a[k][k] > 0)) continue;
        scale[k] = std::sqrt(a[k][k]);
        left[k] = 1;
    }
    std::vector<std::vector<double>> columns;
    while (columns.size() < n) {
        const auto p = static_cast<std::size_t>(std::ranges::max_element(left) - left.begin());
        if (left[p] <= same_motion) break;
        std::vector<double> column(n, 0.0);
        const double pivot = std::sqrt(left[p]);
        for (std::size_t k = 0; k < n; ++k) {
            if (left[k] <= 0) continue;
            double entry = a[p][k] / (scale[k] * scale[p]);
            for (const auto& other : columns) entry -= other[k] / scale[k] * other[p] / scale[p];
            column[k] = entry / pivot;
            left[k] = k == p ? 0 : left[k] - column[k] * column[k];
            column[k] *= scale[k];
        }
        columns.push_back(std::move(column));
    }
    return columns;
}

} // namespace treacle::rigid
