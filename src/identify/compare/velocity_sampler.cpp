#include "identify/compare/velocity_sampler.hpp"

#include <Eigen/Dense>

#include <cmath>
#include <numbers>

namespace treacle::identify {

namespace {
constexpr double support = 2.2; // radius in spacings: 44 particles in 3D, 15 in 2D
constexpr double surface_fraction =
    0.4; // of the particles around a point in the bulk; at a flat surface there are half of them
} // namespace

VelocitySampler::VelocitySampler(
    std::span<const double> positions, std::span<const double> velocities, double spacing, int dimensions)
    : positions_(positions), velocities_(velocities), radius_(support * spacing), dimensions_(dimensions) {
    const double bulk =
        dimensions == 2 ? std::numbers::pi * support * support : 4 * std::numbers::pi / 3 * support * support * support;
    fewest_ = surface_fraction * bulk;
    for (std::size_t i = 0; 3 * i < positions.size(); ++i) cells_[cell_of(positions.data() + 3 * i)].push_back(i);
}

VelocitySampler::Cell VelocitySampler::cell_of(const double* x) const {
    return {int(std::floor(x[0] / radius_)), int(std::floor(x[1] / radius_)), int(std::floor(x[2] / radius_))};
}

std::optional<LocalVelocity> VelocitySampler::at(const Vec3& point) const {
    const auto centre = cell_of(point.data());
    const int deep = dimensions_ == 2 ? 0 : 1;
    Eigen::Matrix4d sums = Eigen::Matrix4d::Zero();
    Eigen::Matrix<double, 4, 3> values = Eigen::Matrix<double, 4, 3>::Zero();
    int count = 0;
    for (int k = -deep; k <= deep; ++k) {
        for (int j = -1; j <= 1; ++j) {
            for (int i = -1; i <= 1; ++i) {
                const auto cell = cells_.find({centre[0] + i, centre[1] + j, centre[2] + k});
                if (cell == cells_.end()) continue;
                for (const auto particle : cell->second) {
                    const double* x = positions_.data() + 3 * particle;
                    const Eigen::Vector4d basis{1, (x[0] - point[0]) / radius_, (x[1] - point[1]) / radius_,
                        dimensions_ == 2 ? 0 : (x[2] - point[2]) / radius_};
                    const double square = basis.tail<3>().squaredNorm();
                    if (square >= 1) continue;
                    const double weight = (1 - square) * (1 - square);
                    sums += weight * basis * basis.transpose();
                    values += weight * basis * Eigen::Map<const Eigen::RowVector3d>(velocities_.data() + 3 * particle);
                    ++count;
                }
            }
        }
    }
    if (count < fewest_) return {};
    if (dimensions_ == 2) sums(3, 3) = 1;
    const Eigen::Matrix<double, 4, 3> fit = sums.ldlt().solve(values);
    LocalVelocity out;
    for (int c = 0; c < 3; ++c) {
        out.velocity[std::size_t(c)] = fit(0, c);
        for (int axis = 0; axis < 3; ++axis)
            out.gradient[std::size_t(c)][std::size_t(axis)] = fit(1 + axis, c) / radius_;
    }
    return out;
}

} // namespace treacle::identify
