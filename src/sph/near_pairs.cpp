#include "sph/near_pairs.hpp"

#include "kokkos/scan.hpp"

#include <algorithm>

namespace treacle::sph {

namespace {
void keep_near(const NeighbourList& all, const ParticleStore& of, const ParticleStore& among, double support, NeighbourList& near) {
    const int n = of.owned();
    const Pairs from = pairs(all, of, among);
    const double square = support * support;
    reserve(near.offset, static_cast<std::size_t>(n) + 1);
    const auto offset = near.offset;
    Kokkos::parallel_for("treacle::count_near_pairs", n, KOKKOS_LAMBDA(int i) {
        int count = 0;
        from.each(i, [&](int, double, double, double, double r2) { count += r2 < square ? 1 : 0; });
        offset(i) = count;
    });
    near.size = counts_to_offsets(offset, n);
    reserve(near.index, static_cast<std::size_t>(near.size) + NeighbourList::spare);
    const auto index = near.index;
    Kokkos::parallel_for("treacle::write_near_pairs", n, KOKKOS_LAMBDA(int i) {
        std::int64_t to = offset(i);
        from.each(i, [&](int j, double, double, double, double r2) {
            if (r2 < square) index(to++) = j;
        });
    });
    const auto entries = near.size;
    Kokkos::parallel_for("treacle::spare_near_pairs", NeighbourList::spare, KOKKOS_LAMBDA(int k) { index(entries + k) = 0; });
}
} // namespace

double viscous_support(const SphOptions& options, double spacing) {
    const double ratio = options.viscosity.form == ViscosityForm::corrected
                             ? std::min(options.viscosity.support_ratio, options.support_ratio)
                             : options.support_ratio;
    return ratio * spacing;
}

ViscousScene NearPairs::among(const ViscousScene& scene) {
    const double support = viscous_support(scene.options, scene.constants.spacing);
    if (support >= scene.constants.support) return scene;
    constants_ = scene.constants;
    constants_.support = support;
    keep_near(scene.neighbours.liquid, scene.liquid.store, scene.liquid.store, support, near_.liquid);
    keep_near(scene.neighbours.solid, scene.liquid.store, scene.solid.store, support, near_.solid);
    return {{scene.options, constants_, scene.comm, scene.liquid, scene.solid, near_, scene.halo}, scene.forces, scene.solid_halo};
}

std::size_t NearPairs::bytes() const { return near_.liquid.bytes() + near_.solid.bytes(); }

} // namespace treacle::sph
