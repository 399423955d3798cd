#pragma once
#include "base/text/vec3.hpp"

#include <array>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace treacle::identify {

// Linear field at a point, in the scene's axes.
struct LocalVelocity {
    Vec3 velocity{0, 0, 0};         // [m/s]
    std::array<Vec3, 3> gradient{}; // [1/s] row i is that of velocity i
};

// Velocities between particles: a linear function fitted to those within the support radius, with weights (1 - r^2 / R^2)^2
// (moving least squares, Lancaster & Salkauskas 1981). Exact for linear fields.
class VelocitySampler {
public:
    // positions and velocities [n][3] stay. `spacing` [m] of the particles; `dimensions` 2: all z are alike.
    VelocitySampler(
        std::span<const double> positions, std::span<const double> velocities, double spacing, int dimensions);

    // Nothing where fewer particles are around than at a flat surface: outside of the liquid.
    std::optional<LocalVelocity> at(const Vec3& point) const;

private:
    using Cell = std::array<int, 3>;
    struct CellHash {
        std::size_t operator()(const Cell& c) const {
            return (std::size_t(c[0]) * 73856093u) ^ (std::size_t(c[1]) * 19349663u) ^ (std::size_t(c[2]) * 83492791u);
        }
    };
    Cell cell_of(const double* x) const;

    std::span<const double> positions_, velocities_;
    double radius_ = 0;
    double fewest_ = 0;
    int dimensions_ = 3;
    std::unordered_map<Cell, std::vector<std::size_t>, CellHash> cells_;
};

} // namespace treacle::identify
