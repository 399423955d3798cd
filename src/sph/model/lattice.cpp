#include "sph/model/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace treacle::sph {

namespace {
// Lattice points at exactly the support radius carry no weight and are no neighbours.
constexpr double edge = 1 - 1e-9;

template <class Visit>
void for_lattice(int dimensions, int support_cells, const Visit& visit) {
    const int depth = dimensions == 3 ? support_cells : 0;
    for (int k = -depth; k <= depth; ++k) {
        for (int j = -support_cells; j <= support_cells; ++j) {
            for (int i = -support_cells; i <= support_cells; ++i) visit(i, j, k);
        }
    }
}
} // namespace

Lattice compute_lattice_sums(KernelKind kind, int dimensions, double support, double spacing) {
    Lattice out;
    const NumberKernel number(support, spacing);
    with_kernel(kind, dimensions, support, [&](const auto& kernel) {
        const int support_cells = static_cast<int>(std::ceil(support / spacing));
        double gradient = 0, laplacian = 0, diagonal = 0;
        for_lattice(dimensions, support_cells, [&](int i, int j, int k) {
            const double r = spacing * std::sqrt(double(i * i + j * j + k * k));
            if (r >= support * edge) return;
            out.kernel_sum += kernel.value(r);
            if (r == 0) return;
            ++out.neighbours;
            out.number_density += number.value(r);
            const double x = i * spacing, f = kernel.gradient(r);
            gradient += (x - 0) * f * (-x);
            const double a = 2 * r * r * f / (r * r + 0.01 * support * support);
            laplacian -= a * x * x;
            diagonal -= a;
        });
        out.volume = 1 / out.kernel_sum;
        out.gradient_factor = out.volume * gradient;
        out.laplacian_factor = out.volume * laplacian / 2;
        out.laplacian_diagonal = out.volume * diagonal;
    });
    return out;
}

namespace {
template <class Kernel>
PlanarWall measure_at(const Kernel& kernel, const WallSetup& setup, double gap, double u, double v) {
    const NumberKernel number(setup.support, setup.spacing);
    const auto lattice = compute_lattice_sums(setup.kind, setup.dimensions, setup.support, setup.spacing);
    const bool plane = setup.dimensions == 2;
    const double d = setup.spacing, s = setup.wall_spacing;
    PlanarWall out;
    const int wall_support_cells = static_cast<int>(std::ceil(setup.support / s)) + 1;
    const int depth = plane ? 0 : wall_support_cells;
    double wall_sum = 0;
    for (int k = -depth; k <= depth; ++k) {
        for (int i = -wall_support_cells; i <= wall_support_cells; ++i) {
            const double r = s * std::sqrt(double(i * i + k * k));
            if (r < setup.support * edge) wall_sum += kernel.value(r);
        }
    }
    out.wall_volume = 1 / wall_sum;
    double wall_w = 0, wall_n = 0;
    for (int k = -depth; k <= depth; ++k) {
        for (int i = -wall_support_cells; i <= wall_support_cells; ++i) {
            const double x = i * s + u, z = k * s + v;
            const double r = std::sqrt(x * x + gap * gap + (plane ? 0 : z * z));
            if (r >= setup.support * edge) continue;
            wall_w += kernel.value(r);
            wall_n += number.value(r);
            out.laplacian -= (lattice.volume + out.wall_volume) * r * r * kernel.gradient(r) /
                             (r * r + 0.01 * setup.support * setup.support);
            out.wall_vector += out.wall_volume * kernel.gradient(r) * gap;
            out.wall_neighbours += 1;
        }
    }
    double liquid_w = 0, liquid_n = 0;
    out.missing = lattice.laplacian_diagonal;
    for_lattice(setup.dimensions, static_cast<int>(std::ceil(setup.support / d)), [&](int i, int j, int k) {
        const double r = d * std::sqrt(double(i * i + j * j + k * k));
        if (j < 0 || r >= setup.support * edge) return;
        liquid_w += kernel.value(r);
        if (r == 0) return;
        liquid_n += number.value(r);
        out.liquid_vector -= lattice.volume * kernel.gradient(r) * j * d;
        out.missing += 2 * lattice.volume * r * r * kernel.gradient(r) / (r * r + 0.01 * setup.support * setup.support);
    });
    out.solid_ratio = out.wall_volume * wall_w;
    out.density_ratio = lattice.volume * liquid_w + out.solid_ratio;
    out.number_ratio = (liquid_n + out.wall_volume / lattice.volume * wall_n) / lattice.number_density;
    out.wall_vector = std::abs(out.wall_vector);
    out.wall_term = out.wall_vector * out.wall_vector;
    return out;
}
} // namespace

PlanarWall compute_wall_sums(const WallSetup& setup, double gap) {
    PlanarWall mean;
    with_kernel(setup.kind, setup.dimensions, setup.support, [&](const auto& kernel) {
        const double half = setup.wall_spacing / 2;
        for (const auto& [u, v] : {std::pair(0.0, 0.0), std::pair(half, 0.0), std::pair(half, half)}) {
            const auto one = measure_at(kernel, setup, gap, u, v);
            mean.wall_volume += one.wall_volume / 3;
            mean.density_ratio += one.density_ratio / 3;
            mean.number_ratio += one.number_ratio / 3;
            mean.wall_term += one.wall_term / 3;
            mean.wall_vector += one.wall_vector / 3;
            mean.liquid_vector += one.liquid_vector / 3;
            mean.solid_ratio += one.solid_ratio / 3;
            mean.laplacian += one.laplacian / 3;
            mean.missing += one.missing / 3;
            mean.wall_neighbours += one.wall_neighbours / 3;
        }
    });
    return mean;
}

namespace {
// The walls of a domain stand on the lattice of the liquid: no lateral offset.
PlanarWall measure_aligned(const WallSetup& setup, double gap) {
    PlanarWall out;
    with_kernel(setup.kind, setup.dimensions, setup.support,
        [&](const auto& kernel) { out = measure_at(kernel, setup, gap, 0.0, 0.0); });
    return out;
}
} // namespace

double equilibrium_wall_distance(const WallSetup& setup, const DensityOptions& density) {
    double lo = 0.3 * setup.spacing, hi = setup.support;
    for (int k = 0; k < 60; ++k) {
        const double gap = (lo + hi) / 2;
        const auto wall = measure_aligned(setup, gap);
        const double zeta = density.spiky_weight(wall.wall_neighbours);
        const double ratio = (1 - zeta) * wall.density_ratio + zeta * wall.number_ratio;
        (ratio > 1 ? lo : hi) = gap;
    }
    return (lo + hi) / 2;
}

double wall_laplacian_factor(const WallSetup& setup, const DensityOptions& density) {
    const auto wall = measure_aligned(setup, equilibrium_wall_distance(setup, density));
    return wall.missing / wall.laplacian;
}

double wall_pressure_factor(const WallSetup& setup, const DensityOptions& density) {
    const auto wall = measure_aligned(setup, equilibrium_wall_distance(setup, density));
    return 2 * wall.liquid_vector / wall.wall_vector;
}

namespace {
// Kernel sums of one layer of particles at a height above it.
struct LayerSums {
    double push = 0;   // sum V |W'|/r y [1/m]
    double spread = 0; // sum V |W'|/r y^2
};
template <class Kernel>
LayerSums see_layer(const Kernel& kernel, const WallSetup& setup, double volume, double spacing, double height) {
    const int support_cells = static_cast<int>(std::ceil(kernel.h / spacing)) + 1;
    const int depth = setup.dimensions == 3 ? support_cells : 0;
    LayerSums out;
    for (int k = -depth; k <= depth; ++k) {
        for (int i = -support_cells; i <= support_cells; ++i) {
            const double r = std::sqrt(spacing * spacing * double(i * i + k * k) + height * height);
            if (r >= kernel.h * edge) continue;
            out.push -= volume * kernel.gradient(r) * height;
            out.spread -= volume * kernel.gradient(r) * height * height;
        }
    }
    return out;
}

// The layers of liquid at multiples of the spacing away, and the wall's sums at each of them.
struct Layers {
    std::vector<LayerSums> liquid, solid; // by number; liquid[0] is empty
    double gap, spacing;
};
template <class Kernel>
Layers see_layers(const Kernel& kernel, const WallSetup& setup, double gap) {
    const auto lattice = compute_lattice_sums(setup.kind, setup.dimensions, setup.support, setup.spacing);
    const auto wall = measure_aligned(setup, gap);
    const double d = setup.spacing;
    Layers out{{{}}, {see_layer(kernel, setup, wall.wall_volume, setup.wall_spacing, gap)}, gap, d};
    for (int layer = 1; layer <= static_cast<int>(std::ceil(kernel.h / d)); ++layer) {
        out.liquid.push_back(see_layer(kernel, setup, lattice.volume, d, layer * d));
        out.solid.push_back(see_layer(kernel, setup, wall.wall_volume, setup.wall_spacing, gap + layer * d));
    }
    return out;
}

// Force on the first layer of liquid between a wall that counts `wall_factor` times and a uniform stress of 1, over that of a
// layer's neighbours on one side: positive towards the wall.
double layer_imbalance(const Layers& layers, double wall_factor) {
    const auto spread = [&](std::size_t at) {
        double sum = wall_factor * layers.solid[at].spread;
        for (std::size_t apart = 1; apart < layers.liquid.size(); ++apart) {
            sum += (at >= apart ? 2 : 1) * layers.liquid[apart].spread;
        }
        return sum;
    };
    double out = wall_factor * layers.gap / (0.5 * layers.spacing) * layers.solid[0].push / spread(0);
    for (std::size_t apart = 1; apart < layers.liquid.size(); ++apart) {
        out -= layers.liquid[apart].push * (1 / spread(0) + 1 / spread(apart));
    }
    return out;
}
} // namespace

double wall_viscous_factor(const WallSetup& setup, const DensityOptions& density, double viscous_support) {
    const double gap = equilibrium_wall_distance(setup, density);
    double lo = 0, hi = 10;
    with_kernel(setup.kind, setup.dimensions, viscous_support, [&](const auto& kernel) {
        const Layers layers = see_layers(kernel, setup, gap);
        for (int k = 0; k < 60; ++k) {
            const double wall_factor = (lo + hi) / 2;
            (layer_imbalance(layers, wall_factor) > 0 ? hi : lo) = wall_factor;
        }
    });
    return (lo + hi) / 2;
}

} // namespace treacle::sph
