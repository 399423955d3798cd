#include "sph/solids/slip_lattice.hpp"

#include <cmath>

namespace treacle::sph {

void measure_slip(const WallSetup& wall, const DensityOptions& density, double viscous_support, Constants& constants) {
    const double gap = equilibrium_wall_distance(wall, density), d = wall.spacing;
    const auto lattice = compute_lattice_sums(wall.kind, wall.dimensions, wall.support, d);
    constants.wall_volume = compute_wall_sums(wall, gap).wall_volume;
    const int support_cells = static_cast<int>(std::ceil(viscous_support / d)),
              depth = wall.dimensions == 3 ? support_cells : 0;
    double wetting = 0;
    with_kernel(wall.kind, wall.dimensions, viscous_support, [&](const auto& kernel) {
        for (int k = -depth; k <= depth; ++k) {
            for (int i = -support_cells; i <= support_cells; ++i) {
                for (int j = 0; j < support_cells; ++j) {
                    const double y = gap + j * d, r = std::sqrt(d * d * double(i * i + k * k) + y * y);
                    if (r < viscous_support) wetting -= lattice.volume * kernel.gradient(r);
                }
            }
        }
    });
    constants.wall_kernel_sum = wetting;
}

} // namespace treacle::sph
