#include "sph/iisph/iisph.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace treacle::sph {

namespace {
// Weight of the Jacobi iteration (Ihmsen et al. 2014).
constexpr double published_weight = 0.5;
// Weight times largest eigenvalue on the lattice: disorder raises eigenvalues by a quarter, and 2 diverges.
constexpr double stable_product = 1.5;

// Largest eigenvalue of A scaled by its diagonal in an endless lattice: for wave numbers k,
// |sum_j grad W_j sin(k.x_j)|^2 / sum_j |grad W_j|^2.
template <class Kernel>
double lattice_eigenvalue(const Kernel& kernel, const Constants& constants) {
    constexpr int waves = 12;
    const double d = constants.spacing;
    const int support_cells = static_cast<int>(constants.support / d);
    const int third = Kernel::dimensions == 3 ? 1 : 0;
    std::vector<std::array<double, 6>> around; // position over spacing, gradient
    double square = 0;
    for (int z = -support_cells * third; z <= support_cells * third; ++z) {
        for (int y = -support_cells; y <= support_cells; ++y) {
            for (int x = -support_cells; x <= support_cells; ++x) {
                const double r = d * std::sqrt(double(x * x + y * y + z * z));
                if (r == 0 || r >= constants.support) continue;
                const double g = kernel.gradient(r) * d;
                around.push_back({double(x), double(y), double(z), g * x, g * y, g * z});
                square += g * g * (x * x + y * y + z * z);
            }
        }
    }
    double largest = 0;
    for (int kz = 0; kz <= waves * third; ++kz) {
        for (int ky = 0; ky <= waves; ++ky) {
            for (int kx = 0; kx <= waves; ++kx) {
                double sum[3] = {0, 0, 0};
                for (const auto& j : around) {
                    const double wave = std::sin(math::pi / waves * (kx * j[0] + ky * j[1] + kz * j[2]));
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += wave * j[3 + c];
                }
                largest = std::max(largest, (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / square);
            }
        }
    }
    return largest;
}
} // namespace

int lattice_neighbours(const Constants& constants) {
    const int support_cells = static_cast<int>(constants.support / constants.spacing);
    const int third = constants.dimensions == 3 ? support_cells : 0;
    int count = -1; // itself
    for (int z = -third; z <= third; ++z) {
        for (int y = -support_cells; y <= support_cells; ++y) {
            for (int x = -support_cells; x <= support_cells; ++x) {
                count += constants.spacing * std::sqrt(double(x * x + y * y + z * z)) < constants.support ? 1 : 0;
            }
        }
    }
    return count;
}

double iisph_weight(const SphOptions& options, const Constants& constants) {
    if (options.pressure.jacobi_weight > 0) return options.pressure.jacobi_weight;
    double largest = 0;
    with_kernel(options.kernel, constants.dimensions, constants.support,
        [&](const auto& kernel) { largest = lattice_eigenvalue(kernel, constants); });
    return std::min(published_weight, stable_product / largest);
}

} // namespace treacle::sph
