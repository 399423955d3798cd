#include "shapes.hpp"

#include "base/text/error.hpp"
#include "scene/sampling/signed_distance.hpp"

#include <gtest/gtest.h>
#include <numbers>

using namespace treacle;
using namespace treacle::scene;
using namespace treacle::scene::testing;

namespace {

void add(TriangleMesh& mesh, const TriangleMesh& part, double scale, const Vec3& shift) {
    const int first = int(mesh.vertices.size());
    for (const Vec3& v : part.vertices) mesh.vertices.push_back(plus(shift, scale, v));
    for (const auto& t : part.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

void turn(TriangleMesh& mesh, std::size_t from) {
    for (std::size_t t = from; t < mesh.triangles.size(); ++t) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
}

std::string refusal(const TriangleMesh& mesh) {
    const MeshFile file("bad.obj", mesh);
    try {
        SolidRegion region(mesh_shape(file.path()));
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

bool has(const std::string& text, const std::string& fragment) { return text.find(fragment) != std::string::npos; }

} // namespace

TEST(MeshParts, ThatOverlapCountOnce) {
    TriangleMesh mesh;
    add(mesh, cube_mesh(), 1, {0, 0, 0});
    add(mesh, cube_mesh(), 1, {0.625, 0.125, 0.25});
    const MeshFile file("two.obj", mesh);
    const SolidRegion region(mesh_shape(file.path()));
    const double common = 0.375 * 0.875 * 0.75;
    EXPECT_NEAR(region.volume() / (2 - common), 1, 5e-4);
    EXPECT_NEAR(region.moments().volume, region.volume(), 1e-12);
    EXPECT_NEAR(region.meshes().front().separate_volume, 2, 1e-6);
    // Deep inside the walls within do not count.
    Shape a = box({0, 0, 0}, {1, 1, 1}), b = box({0.625, 0.125, 0.25}, {1.625, 1.125, 1.25}), both;
    both.kind = ShapeKind::unite;
    both.parts = {a, b};
    const SolidRegion exact(both);
    RandomPoints random({-0.3, -0.3, -0.3}, {1.9, 1.4, 1.5});
    for (int i = 0; i < 2000; ++i) {
        const Vec3 x = random();
        EXPECT_NEAR(region.distance(x), exact.distance(x), 5e-4);
    }
}

TEST(MeshParts, InThePlaneCountOnceToo) {
    TriangleMesh mesh;
    add(mesh, cube_mesh(), 1, {0, 0, -0.5});
    add(mesh, cube_mesh(), 1, {0.625, 0.125, -0.375});
    const MeshFile file("two.obj", mesh);
    EXPECT_NEAR(SolidRegion(mesh_shape(file.path()), 2).volume() / (2 - 0.375 * 0.875), 1, 5e-4);
}

TEST(MeshParts, CavitiesStayCavitiesBesideOverlaps) {
    TriangleMesh mesh;
    add(mesh, cube_mesh(), 1, {0, 0, 0});
    const auto cavity = mesh.triangles.size();
    add(mesh, cube_mesh(), 0.5, {0.1, 0.1, 0.1});
    turn(mesh, cavity);
    const MeshFile hollow("hollow.obj", mesh);
    EXPECT_NEAR(SolidRegion(mesh_shape(hollow.path())).volume(), 1 - 0.125,
        1e-6); // no overlap: exact for the coordinates, which are of single precision
    add(mesh, cube_mesh(), 1, {0.8, 0, 0});
    const MeshFile file("more.obj", mesh);
    const SolidRegion region(mesh_shape(file.path()));
    EXPECT_NEAR(region.volume() / (1.8 - 0.125), 1, 5e-4);
    EXPECT_GT(region.distance({0.3, 0.3, 0.3}), 0);
    EXPECT_NEAR(region.distance({0.9, 0.5, 0.5}), -0.3, 1e-3); // from the cavity, beyond the face within
}

TEST(MeshParts, WhatIsWrongIsSaidByItsName) {
    TriangleMesh twice = cube_mesh();
    twice.triangles.push_back(twice.triangles.front());
    EXPECT_TRUE(has(refusal(twice), "has 1 duplicate triangle")) << refusal(twice);
    TriangleMesh whole;
    add(whole, cube_mesh(), 1, {0, 0, 0});
    add(whole, cube_mesh(), 1, {0, 0, 0});
    EXPECT_TRUE(has(refusal(whole), "has 12 duplicate triangles")) << refusal(whole);
    TriangleMesh wall = cube_mesh(); // between two opposite edges
    wall.triangles.push_back({0, 1, 7});
    wall.triangles.push_back({0, 7, 6});
    EXPECT_TRUE(has(refusal(wall), "has inner walls: ")) << refusal(wall);
    TriangleMesh open = cube_mesh();
    open.triangles.pop_back();
    EXPECT_TRUE(has(refusal(open), "3 open edges around 1 hole")) << refusal(open);
    TriangleMesh inwards = cube_mesh();
    add(inwards, cube_mesh(), 0.5, {3, 0, 0});
    turn(inwards, 12);
    EXPECT_TRUE(has(refusal(inwards), "face inwards")) << refusal(inwards);
}

TEST(MeshParts, MapCoordinatesAreRefusedWithTheCure) {
    TriangleMesh mesh;
    add(mesh, sphere_mesh(4), 10, {5e5, 5e6, 100});
    EXPECT_TRUE(has(refusal(mesh), "rounds them by up to 0.298")) << refusal(mesh);
    EXPECT_TRUE(has(refusal(mesh), "[-500000, -5000000, ")) << refusal(mesh);
    TriangleMesh near;
    add(near, sphere_mesh(4), 10, {1e3, 1e3, 0});
    EXPECT_EQ(refusal(near), "");
}
