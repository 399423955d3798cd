#include "sample.hpp"

#include <filesystem>
#include <fstream>

namespace treacle::rigid::mass_test {
namespace {

constexpr double exact = 1e-12; // of sums of some thousand terms, relative

// The inertia of a box of unit density about its middle, in its axes.
Vec3 box_inertia(const Vec3& edge) {
    const double v = edge[0] * edge[1] * edge[2] / 12;
    return {v * (edge[1] * edge[1] + edge[2] * edge[2]), v * (edge[0] * edge[0] + edge[2] * edge[2]),
        v * (edge[0] * edge[0] + edge[1] * edge[1])};
}

} // namespace

TEST(Moments, OfABoxAreExact) {
    const Vec3 edge{0.2, 0.3, 0.5};
    const auto m = scene::SolidRegion(box({1, 2, 3}, {1.2, 2.3, 3.5})).moments();
    EXPECT_NEAR(m.volume, 0.03, 0.03 * exact);
    const auto known = box_inertia(edge);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(m.centre[k], 1 + double(k) + edge[k] / 2, 4 * exact);
        EXPECT_NEAR(m.inertia[k][k], known[k], 1e-9 * known[k]);
        EXPECT_NEAR(m.inertia[k][(k + 1) % 3], 0, 1e-9 * known[0]);
    }
}

TEST(Moments, OfABallAreKnownToTheSquareOfTheCells) {
    const auto m = scene::SolidRegion(ball({0.1, -0.2, 0.3}, 0.4)).moments();
    const double volume = 4.0 / 3 * std::numbers::pi * 0.4 * 0.4 * 0.4;
    EXPECT_NEAR(m.volume, volume, exact * volume);
    // Cells of 1/128 of the diameter, four times their square.
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(m.inertia[k][k], 0.4 * volume * 0.16, 2.5e-4 * 0.4 * volume * 0.16);
    }
    EXPECT_NEAR(m.centre[1], -0.2, 1e-9);
}

TEST(Moments, OfADiscInThePlaneAreKnown) {
    const auto m = scene::SolidRegion(ball({0.1, -0.2, 0}, 0.4), 2).moments();
    const double area = std::numbers::pi * 0.16;
    EXPECT_NEAR(m.volume, area, exact * area);
    EXPECT_NEAR(m.inertia[2][2], area * 0.08, 1e-5 * area * 0.08);
}

TEST(Moments, OfATurnedMeshAreThoseOfItsBoxTurned) {
    // Corners by bits; each face by two triangles, counter-clockwise from outside.
    scene::TriangleMesh mesh;
    const Vec3 edge{0.2, 0.3, 0.5};
    const auto turn = rotation_by({0.3, -0.7, 0.4});
    const auto axes = to_matrix(turn);
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 x{edge[0] * (corner & 1), edge[1] * (corner >> 1 & 1), edge[2] * (corner >> 2 & 1)};
        mesh.vertices.push_back(axes * (x - 0.5 * edge) + Vec3{1, 2, 3});
    }
    const int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& f : faces) {
        mesh.triangles.push_back({f[0], f[1], f[2]});
        mesh.triangles.push_back({f[0], f[2], f[3]});
    }
    const auto m = scene::moments_of(mesh);
    EXPECT_NEAR(m.volume, 0.03, 0.03 * exact);
    const auto known = box_inertia(edge);
    const Matrix3 diagonal{Vec3{known[0], 0, 0}, Vec3{0, known[1], 0}, Vec3{0, 0, known[2]}};
    const auto expected = product(product(axes, diagonal), transposed(axes));
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(m.centre[i], 1 + double(i), 4 * exact);
        for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(m.inertia[i][j], expected[i][j], 1e-11 * known[0]);
    }
}

} // namespace treacle::rigid::mass_test
