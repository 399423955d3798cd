#include "base/text/error.hpp"
#include "scene/sampling/sampling.hpp"

#include <cmath>

namespace treacle::scene {

namespace {
using Index = std::array<std::int64_t, 3>;

// A point may stand this much closer than half a spacing to the far side of the domain: its density is then less
// than a per cent too large. Farther points would be pushed out at once.
constexpr double side_tolerance = 0.02;
} // namespace

std::array<std::int64_t, 3> Lattice::size() const {
    Index n{1, 1, 1};
    double total = 1;
    for (int a = 0; a < dimensions; ++a) {
        const double count = std::floor((max[a] - min[a]) / spacing + side_tolerance);
        total *= count;
        if (!(total < 4e18))
            throw InputError({"", "the domain holds more than 4e18 lattice points",
                "particles are numbered with 64 bits", "raise the spacing or shrink the domain"});
        n[a] = static_cast<std::int64_t>(count);
    }
    return n;
}

std::uint64_t Lattice::points() const {
    const Index n = size();
    return static_cast<std::uint64_t>(n[0]) * static_cast<std::uint64_t>(n[1]) * static_cast<std::uint64_t>(n[2]);
}

Vec3 Lattice::position(const Index& index) const {
    Vec3 x{0, 0, 0};
    for (int a = 0; a < dimensions; ++a) x[a] = min[a] + (static_cast<double>(index[a]) + 0.5) * spacing;
    return x;
}

bool Lattice::fits(int axis) const {
    const double count = (max[axis] - min[axis]) / spacing;
    return std::abs(count - std::round(count)) < 1e-6;
}

} // namespace treacle::scene
