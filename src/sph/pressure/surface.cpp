#include "sph/pressure/surface.hpp"

#include <cmath>

namespace treacle::sph {

namespace {
struct CoverLoop {
    Pairs liquid, solid;
    Array<int> role;
    double direction[26][3];
    int directions = 0;

    // Clears the bits of the directions that a neighbour covers.
    KOKKOS_INLINE_FUNCTION void cover(unsigned& open, double dx, double dy, double dz, double r2) const {
        const double needed = math::sqrt(0.5 * r2);
        for (int k = 0; k < directions; ++k) {
            const double* n = direction[k];
            if (-(dx * n[0] + dy * n[1] + dz * n[2]) > needed) open &= ~(1u << k);
        }
    }
    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        unsigned open = (1u << directions) - 1;
        const auto visit = [&](int, double dx, double dy, double dz, double r2) {
            if (open != 0) cover(open, dx, dy, dz, r2);
        };
        liquid.each(i, visit);
        solid.each(i, visit);
        role(i) = open != 0 ? Role::dirichlet : Role::poisson;
    }
};
} // namespace

void mark_surface(
    const Constants& constants, LiquidParticles& liquid, const SolidParticles& solid, const Neighbourhood& neighbours) {
    CoverLoop loop{pairs(neighbours.liquid, liquid.store, liquid.store),
        pairs(neighbours.solid, liquid.store, solid.store), liquid.role(), {}, 0};
    const int depth = constants.dimensions == 3 ? 1 : 0;
    for (int z = -depth; z <= depth; ++z) {
        for (int y = -1; y <= 1; ++y) {
            for (int x = -1; x <= 1; ++x) {
                const double length = std::sqrt(double(x * x + y * y + z * z));
                if (length == 0) continue;
                double* n = loop.direction[loop.directions++];
                n[0] = x / length;
                n[1] = y / length;
                n[2] = z / length;
            }
        }
    }
    Kokkos::parallel_for("treacle::mark_surface", liquid.store.owned(), loop);
}

} // namespace treacle::sph
