#include "surface/mesh/mirror.hpp"

#include "base/text/vec3.hpp"

#include <gtest/gtest.h>

namespace treacle::surface {
namespace {

// The corner of the unit cube at the origin, cut off at x + y + z = 1: volume 1/6.
Mesh corner() {
    Mesh out;
    out.vertices = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    out.normals = {-1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    out.velocity = {1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3};
    out.pressure = {1, 2, 3, 4};
    out.liquid = {0, 0, 0, 0};
    out.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return out;
}

double volume(const Mesh& mesh) {
    double out = 0;
    const auto vertex = [&](int i) {
        return Vec3{mesh.vertices[std::size_t(3 * i)], mesh.vertices[std::size_t(3 * i) + 1],
            mesh.vertices[std::size_t(3 * i) + 2]};
    };
    for (const auto& t : mesh.triangles) {
        const auto a = vertex(t[0]), b = vertex(t[1]), c = vertex(t[2]);
        out += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                   a[2] * (b[0] * c[1] - b[1] * c[0])) /
               6;
    }
    return out;
}

TEST(Mirror, ImagesAreOrientedAsTheMeshIs) {
    auto mesh = corner();
    EXPECT_NEAR(volume(mesh), 1. / 6, 1e-15);
    add_images(mesh, {{0, 0.}});
    EXPECT_NEAR(volume(mesh), 2. / 6, 1e-15);
    add_images(mesh, {{1, 0.}, {2, -1.}});
    EXPECT_NEAR(volume(mesh), 8. / 6, 1e-14);
    EXPECT_EQ(mesh.size(), 32);
    EXPECT_EQ(mesh.triangles.size(), 32u);
    EXPECT_EQ(mesh.pressure.size(), 32u);
    EXPECT_EQ(mesh.velocity[3 * 4], -1);      // across the first mirror
    EXPECT_EQ(mesh.velocity[3 * 4 + 1], 2);   // along it
    EXPECT_EQ(mesh.vertices[3 * 17 + 2], -2); // of the origin's height, by the mirror at -1
}

TEST(Mirror, NothingHasNoImage) {
    Mesh mesh;
    add_images(mesh, {{0, 1.}});
    EXPECT_EQ(mesh.size(), 0);
}

TEST(Mirror, PointsAreFoldedIntoThePartThatIsRun) {
    scene::Domain domain;
    domain.min = {0, 0, 0};
    domain.max = {1, 1, 1};
    domain.faces[0].mirror = domain.faces[3].mirror = true;
    EXPECT_EQ(folded({-0.25, 1.25, -1}, domain), (Vec3{0.25, 0.75, -1}));
    EXPECT_EQ(domain.with_images().min, (Vec3{-1, 0, 0}));
    EXPECT_EQ(domain.with_images().max, (Vec3{1, 2, 1}));
}

} // namespace
} // namespace treacle::surface
