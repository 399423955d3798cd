#include "sph/viscosity/operator/viscous_bodies.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::sph {

void ViscousBodies::prepare(const Bodies& bodies, const ViscousScene& scene) {
    columns_.clear();
    if (!bodies.any_dynamic() || scene.options.viscosity.coupling != BodyCoupling::strong) return;
    first_ = static_cast<std::size_t>(bodies.first());
    count_ = static_cast<std::size_t>(bodies.moment_reference_points().count);
    columns_ = bodies.rigid.mobility().columns();
    for (auto& column : columns_) {
        for (double& entry : column) entry *= std::sqrt(scene.constants.mass);
    }
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

void ViscousBodies::factorise(std::span<const double> stiffness) {
    const std::size_t n = columns_.size();
    factor_.assign(n * n, 0.0);
    const auto product = [&](const std::vector<double>& a, const std::vector<double>& b) {
        double sum = 0;
        for (std::size_t body = 0; 6 * body < a.size(); ++body) {
            const auto of = stiffness.subspan(36 * (first_ + body), 36);
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
