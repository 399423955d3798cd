#include "grid/surface_tension/tension.hpp"

#include "grid/transport/apic.hpp"

#include <algorithm>

namespace treacle::grid {

namespace {
struct TensionLoop {
    CellBox window, owned;
    int dimensions;
    Array<double> mass, weighted_sum, out;
    double otherwise; // [N/m]

    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int c[3];
        owned.cell(n, c);
        const int i = window.index(c[0], c[1], c[2]);
        double m = mass(i), sum = weighted_sum(i);
        for (int a = 0, stride = 1; a < dimensions && !(mass(i) > 0); ++a) {
            m += mass(i - stride) + mass(i + stride);
            sum += weighted_sum(i - stride) + weighted_sum(i + stride);
            stride *= window.hi[a] - window.lo[a];
        }
        out(i) = m > 0 ? sum / m : otherwise;
    }
};
} // namespace

SurfaceTensions::SurfaceTensions(std::vector<double> of_liquids) : of_liquids_(std::move(of_liquids)) {
    if (of_liquids_.empty()) return;
    const auto [least, most] = std::ranges::minmax(of_liquids_);
    differ_ = least < most;
    largest_ = most;
}

void SurfaceTensions::find(const MacGrid& grid, CellHalo& halo, const GridParticles& particles, const CellList& cells,
    const Array<double>& particle_mass) {
    reserve(weighted_mass_, of_liquids_.size());
    auto host = Kokkos::create_mirror_view(weighted_mass_);
    const auto mass = on_host(particle_mass);
    for (std::size_t l = 0; l < of_liquids_.size(); ++l) host(l) = mass(l) * of_liquids_[l];
    Kokkos::deep_copy(weighted_mass_, host);
    fluidity_sums(grid, {particles, cells, particle_mass}, halo.window(), 0, {mass_, scratch_});
    fluidity_sums(grid, {particles, cells, weighted_mass_}, halo.window(), 0, {weighted_sum_, scratch_});
    halo.gather({mass_, weighted_sum_});
    reserve(tension_, static_cast<std::size_t>(halo.window().size()));
    const CellBox owned = halo.owned();
    Kokkos::parallel_for("treacle::surface_tensions", static_cast<int>(owned.size()),
        TensionLoop{halo.window(), owned, grid.dimensions, mass_, weighted_sum_, tension_, largest_});
    halo.gather({tension_});
}

} // namespace treacle::grid
