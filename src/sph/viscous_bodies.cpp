#include "sph/viscous_bodies.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::sph {

namespace {
// What is left of a diagonal entry, over the entry, when others say the same already.
constexpr double redundant = 1e-12;

// Columns of L with L L^T = a, symmetric and positive semidefinite, n x n: Cholesky with the largest pivot
// first, rows scaled to a unit diagonal, up to the rank.
std::vector<std::vector<double>> factor_semidefinite(const std::vector<double>& a, std::size_t n) {
    std::vector<double> scale(n, 0.0), left(n, 0.0);
    for (std::size_t k = 0; k < n; ++k) {
        if (!(a[n * k + k] > 0)) continue;
        scale[k] = std::sqrt(a[n * k + k]);
        left[k] = 1;
    }
    std::vector<std::vector<double>> columns;
    while (columns.size() < n) {
        const auto p = static_cast<std::size_t>(std::ranges::max_element(left) - left.begin());
        if (left[p] <= redundant) break;
        std::vector<double> column(n, 0.0);
        const double pivot = std::sqrt(left[p]);
        for (std::size_t k = 0; k < n; ++k) {
            if (left[k] <= 0) continue;
            double entry = a[n * k + p] / (scale[k] * scale[p]);
            for (const auto& other : columns) entry -= other[k] / scale[k] * other[p] / scale[p];
            column[k] = entry / pivot;
            left[k] = k == p ? 0 : left[k] - column[k] * column[k];
            column[k] *= scale[k];
        }
        columns.push_back(std::move(column));
    }
    return columns;
}
} // namespace

void ViscousBodies::prepare(const Bodies& bodies, const ViscousScene& scene) {
    columns_.clear();
    if (!bodies.any_dynamic() || scene.options.viscosity.body_coupling != BodyCoupling::implicit) return;
    first_ = static_cast<std::size_t>(bodies.first());
    count_ = static_cast<std::size_t>(bodies.load_points().count);
    const std::size_t n = 6 * bodies.rigid.size();
    const auto mobility = bodies.rigid.mobility();
    std::vector<double> matrix(n * n), impulse(n, 0.0);
    for (std::size_t k = 0; k < n; ++k) {
        impulse[k] = scene.constants.mass;
        const auto velocity = mobility.respond(impulse);
        impulse[k] = 0;
        std::copy(velocity.begin(), velocity.end(), matrix.begin() + static_cast<std::ptrdiff_t>(n * k));
    }
    columns_ = factor_semidefinite(matrix, n);
}

const Array<double>& ViscousBodies::trial(std::span<const double> q) {
    reserve(motion_, 6 * count_);
    auto host = Kokkos::create_mirror_view(motion_);
    Kokkos::deep_copy(host, 0.0);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        for (std::size_t k = 0; k < columns_[c].size(); ++k) host(6 * first_ + k) += columns_[c][k] * q[c];
    }
    Kokkos::deep_copy(motion_, host);
    return motion_;
}

const Array<double>& ViscousBodies::moved(const Bodies& bodies, std::span<const double> q) {
    trial(q);
    const auto own = bodies.motion(), motion = motion_;
    Kokkos::parallel_for(
        "treacle::moved_bodies", 6 * count_, KOKKOS_LAMBDA(std::size_t k) { motion(k) += own(k); });
    return motion_;
}

std::vector<double> ViscousBodies::project(std::span<const double> loads) const {
    std::vector<double> out(columns_.size(), 0.0);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        for (std::size_t k = 0; k < columns_[c].size(); ++k) out[c] += columns_[c][k] * loads[6 * first_ + k];
    }
    return out;
}

void ViscousBodies::factorise(std::span<const double> held) {
    const std::size_t n = columns_.size();
    factor_.assign(n * n, 0.0);
    const auto product = [&](const std::vector<double>& a, const std::vector<double>& b) {
        double sum = 0;
        for (std::size_t body = 0; 6 * body < a.size(); ++body) {
            const auto of = held.subspan(36 * (first_ + body), 36);
            for (std::size_t k = 0; k < 6; ++k) {
                for (std::size_t l = 0; l < 6; ++l) sum += a[6 * body + k] * of[6 * k + l] * b[6 * body + l];
            }
        }
        return sum;
    };
    for (std::size_t r = 0; r < n; ++r) {
        for (std::size_t c = 0; c <= r; ++c) {
            double entry = (r == c ? 1 : 0) + product(columns_[r], columns_[c]);
            for (std::size_t k = 0; k < c; ++k) entry -= factor_[n * r + k] * factor_[n * c + k];
            factor_[n * r + c] = r == c ? std::sqrt(std::max(entry, 1.0)) : entry / factor_[n * c + c];
        }
    }
}

std::vector<double> ViscousBodies::precondition(std::span<const double> r) const {
    const std::size_t n = columns_.size();
    std::vector<double> z(r.begin(), r.end());
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < i; ++k) z[i] -= factor_[n * i + k] * z[k];
        z[i] /= factor_[n * i + i];
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t k = i + 1; k < n; ++k) z[i] -= factor_[n * k + i] * z[k];
        z[i] /= factor_[n * i + i];
    }
    return z;
}

} // namespace treacle::sph
