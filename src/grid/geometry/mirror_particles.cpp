#include "grid/geometry/mirror_particles.hpp"

namespace treacle::grid {

void MirrorParticles::find(const GridParticles& particles, const DistanceSampler& solid, const Array<int>& number,
    MirroredIn which, double cutoff) {
    const auto x = particles.position(), image = particles.image();
    const bool all = which == MirroredIn::all_solids;
    Kokkos::parallel_for(
        "treacle::images", particles.store.total(), KOKKOS_LAMBDA(int i) {
            const double p[3] = {x(i, 0), x(i, 1), x(i, 2)};
            const double distance = solid.at(p);
            double gradient[3] = {0, 0, 0};
            if (distance < cutoff) solid.gradient(p, gradient);
            const double square = gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2];
            // No side at the middle of thin solids.
            const bool near = distance < cutoff && square > 0.01 && (all || number(solid.nearest(p)) >= 0);
            for (int k = 0; k < 3; ++k) image(i, k) = near ? p[k] - 2 * distance * gradient[k] / square : none;
        });
}

} // namespace treacle::grid
