#include "base/text/error.hpp"
#include "shapes.hpp"
#include "surface/mesh/mesh_check.hpp"

#include <gtest/gtest.h>
#include <set>

namespace treacle::surface::parts_test {
namespace {

using namespace test;

Options options() {
    Options out;
    out.spacing = 1;
    return out;
}

Shape ball(double radius) {
    return [=](const Vec3& x) { return std::hypot(x[0], x[1], x[2]) < radius; };
}

// A ball behind a plane: a cap of its volume, closed by a disc in the plane.
TEST(CroppedSurface, IsClosedAtTheSidesOfTheBox) {
    const double radius = 8, side = 1.3;
    const auto cloud = fill(ball(radius), 10, {0.2, 0.1, 0.3});
    Mesher mesher(Comm::world(), cropped({}, {-20, -20, -20}, {side, 20, 20}), options());
    const auto part = cloud.part(Comm::world());
    const auto& mesh = mesher.build(part.rows());
    EXPECT_TRUE(check_mesh(Comm::world(), mesh).none());
    const double height = radius + side,
                 fraction = height * height * (3 * radius - height) / (4 * radius * radius * radius);
    EXPECT_NEAR(mesher.summary().volume / cloud.count(), fraction, 0.01);
    double farthest = -100;
    for (std::size_t v = 0; v < mesh.vertices.size(); v += 3) farthest = std::max(farthest, mesh.vertices[v]);
    EXPECT_NEAR(Comm::world().max(farthest), side, 1e-12);
    EXPECT_EQ(mesher.summary().components, 1);
}

// Inside of a box that lies in the liquid all is liquid.
TEST(CroppedSurface, OfABoxInTheLiquidIsThatBox) {
    const auto cloud = fill(ball(12), 13, {0.2, 0.1, 0.3});
    Mesher mesher(Comm::world(), cropped({}, {-3.2, -2.5, -4}, {3, 2.5, 1.7}), options());
    const auto part = cloud.part(Comm::world());
    const auto& mesh = mesher.build(part.rows());
    EXPECT_TRUE(check_mesh(Comm::world(), mesh).none());
    EXPECT_NEAR(mesher.summary().volume, 6.2 * 5 * 5.7,
        1e-3); // sharp edges are met to the rounding of the volume's whole numbers
    EXPECT_THROW(cropped({}, {1, 0, 0}, {0, 1, 1}), InputError);
    Domain periodic;
    periodic.max = {10, 10, 10};
    periodic.sides[0] = periodic.sides[1] = Side::periodic;
    EXPECT_THROW(cropped(periodic, {1, 0, 0}, {9, 10, 10}), InputError);
    EXPECT_EQ(cropped(periodic, {-1, 1, 0}, {11, 9, 10}).sides[0], Side::periodic);
}

TEST(SurfaceScalars, AreTheMeansOfTheParticles) {
    const auto cloud = fill(ball(6), 8, {0.2, 0.1, 0.3});
    auto chosen = options();
    chosen.scalars = 2;
    Mesher mesher(Comm::world(), {}, chosen);
    const auto part = cloud.part(Comm::world());
    auto rows = part.rows();
    std::vector<double> twice;
    for (const double p : part.pressure) twice.push_back(2 * p + 1);
    rows.scalars = {part.pressure, twice};
    const auto& mesh = mesher.build(rows);
    for (std::size_t v = 0; v < mesh.pressure.size(); ++v) {
        EXPECT_EQ(mesh.scalars[0][v], mesh.pressure[v]);
        EXPECT_NEAR(mesh.scalars[1][v], 2 * mesh.pressure[v] + 1, 1e-12);
    }
}

// Two liquids that fill a ball, the interface across it: each a closed surface; together they are the ball, and the
// interface is one set of vertices.
TEST(SurfaceOfOneLiquid, LeavesNoGapToTheOthers) {
    const auto cloud = fill(ball(7), 9, {0.21, 0.13, 0.37}, 0.15);
    const auto part = cloud.part(Comm::world());
    Mesher whole(Comm::world(), {}, options());
    whole.build(part.rows());
    double volumes = 0;
    std::array<std::set<std::array<double, 3>>, 2> inner;
    for (int liquid = 0; liquid < 2; ++liquid) {
        auto chosen = options();
        chosen.liquid = liquid;
        Mesher mesher(Comm::world(), {}, chosen);
        const auto& mesh = mesher.build(part.rows());
        EXPECT_TRUE(check_mesh(Comm::world(), mesh).none());
        EXPECT_EQ(mesher.summary().components, 1);
        volumes += mesher.summary().volume;
        std::vector<double> near;
        for (std::size_t v = 0; v < mesh.liquid.size(); ++v) {
            const double* x = &mesh.vertices[3 * v];
            if (std::hypot(x[1], x[2]) < 3 && std::abs(x[0]) < 2) near.insert(near.end(), x, x + 3);
        }
        const auto all = Comm::world().all_gather(std::span<const double>(near));
        for (std::size_t k = 0; k < all.size(); k += 3)
            inner[static_cast<std::size_t>(liquid)].insert({all[k], all[k + 1], all[k + 2]});
    }
    // Smoothing rounds the rim where both meet the air, 44 spacings long, by some 0.07 spacings squared.
    EXPECT_NEAR(volumes / whole.summary().volume, 1, 0.003);
    ASSERT_GT(inner[0].size(), 100u);
    ASSERT_EQ(inner[0].size(), inner[1].size());
    for (const auto& a : inner[0]) { // but for the order of sums
        double nearest = 1;
        for (const auto& b : inner[1]) nearest = std::min(nearest, std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
        EXPECT_LT(nearest, 1e-12);
    }
}

Mesh tetrahedra(const Comm& comm, const std::vector<std::array<int, 3>>& triangles, int vertices) {
    Mesh mesh;
    for (int v = 0; v < vertices; ++v) {
        const double t = v;
        mesh.vertices.insert(mesh.vertices.end(), {std::cos(2 * t), std::sin(3 * t), 0.1 * t * t});
        mesh.global.push_back(v);
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (static_cast<int>(t) % comm.size() == comm.rank()) mesh.triangles.push_back(triangles[t]);
    }
    return mesh;
}

TEST(MeshCheck, CountsWhatIsWrong) {
    const auto comm = Comm::world();
    const auto faults = [&](const std::vector<std::array<int, 3>>& triangles, int vertices) {
        return check_mesh(comm, tetrahedra(comm, triangles, vertices));
    };
    const std::vector<std::array<int, 3>> sound{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    EXPECT_TRUE(faults(sound, 4).none());
    EXPECT_EQ(faults({sound[0], sound[1], sound[2]}, 4).open, 3);
    auto turned = sound;
    std::swap(turned[3][0], turned[3][1]);
    EXPECT_EQ(faults(turned, 4).crowded, 3);
    auto touching = sound;
    touching.insert(touching.end(), {{3, 5, 4}, {3, 4, 6}, {4, 5, 6}, {5, 3, 6}});
    const auto pinched = faults(touching, 7);
    EXPECT_EQ(pinched.pinched, 1);
    EXPECT_EQ(pinched.open + pinched.crowded + pinched.flat, 0);
    EXPECT_EQ(faults({{0, 1, 1}}, 2).flat, 1);
}

} // namespace
} // namespace treacle::surface::parts_test
