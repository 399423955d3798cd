#include "sph/model/lattice.hpp"

#include <gtest/gtest.h>

namespace treacle::sph::lattice_test {
namespace {

// Sums over the lattice of spacing 1, by a script of its own; half of the last digit is the tolerance.
struct Golden {
    int dimensions;
    KernelKind kind;
    double support;
    int neighbours;
    double kernel_sum, gradient_factor, laplacian_factor, number_density;
};
const Golden goldens[] = {
    {3, KernelKind::mueller, 2, 26, 1.0098, .9470, .9206, 12.208},
    {3, KernelKind::mueller, 2.5, 80, .9954, .9542, .9216, 26.588},
    {3, KernelKind::mueller, 3, 92, 1.0022, .9874, .9511, 48.633},
    {3, KernelKind::cubic_spline, 2, 26, 1.0000, 1.0201, .9916, 12.208},
    {3, KernelKind::cubic_spline, 3, 92, 1.0018, 1.0083, .9731, 48.633},
    {3, KernelKind::wendland_c2, 3, 92, 1.0031, .9975, .9591, 48.633},
    {2, KernelKind::mueller, 2, 8, 1.0146, .8737, .8455, 5.657},
    {2, KernelKind::cubic_spline, 2, 8, 1.0009, 1.0122, .9795, 5.657},
    {2, KernelKind::cubic_spline, 3, 24, 1.0034, 1.0033, .9594, 17.461},
};

} // namespace

TEST(Lattice, SumsAreTheGoldenNumbers) {
    for (const auto& golden : goldens) {
        const auto lattice = compute_lattice_sums(golden.kind, golden.dimensions, golden.support, 1);
        EXPECT_EQ(lattice.neighbours, golden.neighbours) << golden.support;
        EXPECT_NEAR(lattice.kernel_sum, golden.kernel_sum, 0.51e-4);
        EXPECT_NEAR(lattice.gradient_factor, golden.gradient_factor, 0.51e-4);
        EXPECT_NEAR(lattice.laplacian_factor, golden.laplacian_factor, 0.51e-4);
        EXPECT_NEAR(lattice.number_density, golden.number_density, 0.51e-3);
        EXPECT_DOUBLE_EQ(lattice.volume, 1 / lattice.kernel_sum);
    }
}

TEST(Lattice, DiagonalsOfTheLaplacianAreTheGoldenNumbers) {
    EXPECT_NEAR(compute_lattice_sums(KernelKind::mueller, 3, 2, 1).laplacian_diagonal, 3.9679, 0.51e-4);
    EXPECT_NEAR(compute_lattice_sums(KernelKind::cubic_spline, 3, 2, 1).laplacian_diagonal, 4.2739, 0.51e-4);
}

TEST(Lattice, ScalesWithTheSpacing) {
    const double d = 0.013;
    const auto unit = compute_lattice_sums(KernelKind::cubic_spline, 3, 2.5, 1);
    const auto small = compute_lattice_sums(KernelKind::cubic_spline, 3, 2.5 * d, d);
    // Round-off of some hundred terms.
    EXPECT_NEAR(small.kernel_sum * d * d * d, unit.kernel_sum, 1e-13);
    EXPECT_NEAR(small.gradient_factor, unit.gradient_factor, 1e-13);
    EXPECT_NEAR(small.laplacian_factor, unit.laplacian_factor, 1e-13);
    EXPECT_NEAR(small.laplacian_diagonal * d * d, unit.laplacian_diagonal, 1e-12);
    EXPECT_NEAR(small.number_density, unit.number_density, 1e-12);
}

TEST(PlanarWall, SumsAreTheGoldenNumbers) {
    const WallSetup setup{KernelKind::mueller, 3, 2, 1, 1};
    const double golden[][5] = {
        // gap, rho / rho0, n / n0, alpha, |S|
        {.8, 1.299, 1.335, .640, 1.039},
        {1.0, 1.120, 1.151, .448, .750},
        {1.1, 1.042, 1.070, .332, .600},
        {1.2, .975, .994, .223, .460},
        {1.4, .876, .880, .068, .228},
    };
    for (const auto& row : golden) {
        const auto wall = compute_wall_sums(setup, row[0]);
        EXPECT_NEAR(wall.wall_volume, 1.60199, 0.51e-5);
        EXPECT_NEAR(wall.density_ratio, row[1], 0.51e-3) << "gap " << row[0];
        EXPECT_NEAR(wall.number_ratio, row[2], 0.51e-3) << "gap " << row[0];
        // The golden alpha has the density of the particle; a mean of quotients is not quite that of means.
        EXPECT_NEAR(wall.wall_term / (row[1] * row[1]), row[3], 2e-3) << "gap " << row[0];
        EXPECT_NEAR(wall.wall_vector, row[4], 0.51e-3) << "gap " << row[0];
    }
    EXPECT_NEAR(compute_wall_sums({KernelKind::mueller, 3, 2, 1, 0.5}, 1).wall_volume, .40616, 0.51e-5);
}

TEST(PlanarWall, VolumeInThePlaneIsTheGoldenNumber) {
    const double volume = compute_lattice_sums(KernelKind::mueller, 2, 2, 1).volume;
    EXPECT_NEAR(compute_wall_sums({KernelKind::mueller, 2, 2, 1, 1}, 1).wall_volume / volume, 1.7288, 0.51e-4);
}

TEST(PlanarWall, RestGapIsWiderThanASpacing) {
    for (const auto kind : {KernelKind::mueller, KernelKind::cubic_spline}) {
        const WallSetup setup{kind, 3, 2, 1, 1};
        const double smooth = equilibrium_wall_distance(setup, DensityOptions{});
        EXPECT_GT(smooth, 1.0) << "at one spacing the wall compresses the liquid";
        EXPECT_LT(smooth, 1.4);
    }
}

} // namespace treacle::sph::lattice_test
