#include "sph/surface_tension/surface_lattice.hpp"

#include <cmath>
#include <vector>

namespace treacle::sph {

namespace {
// Sums over a layer of the lattice at a distance of `apart` layers.
struct Layer {
    double value = 0;    // sum W [1/m^D]
    double gradient = 0; // sum of the component of grad W towards it [1/m^(D+1)]
};

std::vector<Layer> layers_of(const SurfaceSetup& setup) {
    const int support_cells = static_cast<int>(std::ceil(setup.support / setup.spacing));
    const int depth = setup.dimensions == 3 ? support_cells : 0;
    std::vector<Layer> out(static_cast<std::size_t>(support_cells) + 1);
    with_kernel(setup.kind, setup.dimensions, setup.support, [&](const auto& kernel) {
        for (int apart = 0; apart <= support_cells; ++apart) {
            auto& layer = out[static_cast<std::size_t>(apart)];
            for (int i = -support_cells; i <= support_cells; ++i) {
                for (int k = -depth; k <= depth; ++k) {
                    const double r = setup.spacing * std::sqrt(double(apart * apart + i * i + k * k));
                    if (r >= setup.support) continue;
                    layer.value += kernel.value(r);
                    if (apart > 0) layer.gradient -= kernel.gradient(r) * apart * setup.spacing;
                }
            }
        }
    });
    return out;
}
} // namespace

double surface_depth(const SurfaceSetup& setup, int passes) {
    const auto layers = layers_of(setup);
    const auto support_cells = static_cast<int>(layers.size()) - 1;
    const auto at = [&](int apart) -> const Layer& { return layers[static_cast<std::size_t>(std::abs(apart))]; };
    const int count = (passes + 2) * support_cells;
    double sum = 0;
    for (int k = -support_cells; k <= support_cells; ++k) sum += at(k).value;
    std::vector<double> normal(static_cast<std::size_t>(count), 0.0);
    for (int k = 0; k < support_cells; ++k) { // the layers below that have none above to balance them
        for (int apart = k + 1; apart <= support_cells; ++apart)
            normal[static_cast<std::size_t>(k)] += at(apart).gradient / sum;
    }
    for (int pass = 0; pass < passes; ++pass) {
        const auto from = normal;
        for (int k = 0; k < count; ++k) {
            double weights = 0, total = 0;
            for (int l = std::max(0, k - support_cells); l <= std::min(count - 1, k + support_cells); ++l) {
                weights += at(k - l).value;
                total += at(k - l).value * from[static_cast<std::size_t>(l)];
            }
            normal[static_cast<std::size_t>(k)] = total / weights;
        }
    }
    double weights = 0, moment = 0;
    for (int k = 0; k < count; ++k) {
        const double n = normal[static_cast<std::size_t>(k)];
        weights += n;
        moment += n * (k + 0.5) * setup.spacing;
    }
    return moment / weights;
}

double cohesion_energy(const SurfaceSetup& setup) {
    constexpr int points = 2000; // of the midpoint rule: 1e-6
    const bool plane = setup.dimensions == 2;
    double moment = 0;
    with_kernel(setup.kind, setup.dimensions, setup.support, [&](const auto& kernel) {
        for (int k = 0; k < points; ++k) {
            const double r = (k + 0.5) / points * setup.support;
            moment += std::pow(r, plane ? 4 : 5) * kernel.value(r);
        }
    });
    return (plane ? 1.0 / 3 : math::pi / 8) * moment * setup.support / points;
}

} // namespace treacle::sph
