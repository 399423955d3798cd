#include "shapes.hpp"

#include "base/text/error.hpp"

#include <gtest/gtest.h>

using namespace treacle;
using namespace treacle::scene;
using namespace treacle::scene::testing;

// Every triangle with three vertices of its own, as STL files have them.
static TriangleMesh unshared(const TriangleMesh& mesh, double jitter) {
    TriangleMesh result;
    int k = 0;
    for (const auto& t : mesh.triangles) {
        const int first = int(result.vertices.size());
        for (const int v : t) result.vertices.push_back(plus(mesh.vertices[v], jitter * (k++ % 3 - 1), {1, 1, 1}));
        result.triangles.push_back({first, first + 1, first + 2});
    }
    return result;
}

TEST(Mesh, ACubeIsClosedAndMeasuredExactly) {
    const auto [mesh, report] = check_mesh(cube_mesh());
    EXPECT_TRUE(report.closed());
    EXPECT_EQ(report.components, 1u);
    EXPECT_NEAR(report.volume, 1, 1e-14); // round-off of 12 terms
    EXPECT_NEAR(report.area, 6, 1e-14);
    EXPECT_NEAR(report.thickness_p01, 1, 1e-12);
    EXPECT_TRUE(report.notes().empty());
}

TEST(Mesh, TriangleSoupIsWeldedWithinTheTolerance) {
    const auto cube = cube_mesh();
    const auto [mesh, report] = check_mesh(unshared(cube, 3e-10)); // tolerance: 1e-9 of 1.7
    EXPECT_TRUE(report.closed());
    EXPECT_EQ(mesh.vertices.size(), 8u);
    EXPECT_EQ(report.welded, 28u);
}

TEST(Mesh, VerticesFurtherApartThanTheToleranceStayApart) {
    EXPECT_FALSE(check_mesh(unshared(cube_mesh(), 1e-6)).report.closed());
}

TEST(Mesh, AMissingTriangleIsAHoleOfThreeEdges) {
    auto open = sphere_mesh(2);
    open.triangles.erase(open.triangles.begin() + 5);
    const auto report = check_mesh(open).report;
    EXPECT_EQ(report.open_edges, 3u);
    EXPECT_EQ(report.holes, 1u);
}

TEST(Mesh, TwoSeparateHolesAreTwo) {
    auto open = sphere_mesh(3);
    open.triangles.erase(open.triangles.begin() + 500);
    open.triangles.erase(open.triangles.begin());
    const auto report = check_mesh(open).report;
    EXPECT_EQ(report.open_edges, 6u);
    EXPECT_EQ(report.holes, 2u);
}

TEST(Mesh, AnOpenMeshIsRefusedWithTheCountOfOpenEdgesAndACure) {
    auto open = sphere_mesh(2);
    open.triangles.pop_back();
    const MeshFile file("open.obj", open);
    try {
        load_closed_mesh(file.path(), "scene.yaml:14");
        FAIL() << "an open mesh was accepted";
    } catch (const InputError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("scene.yaml:14"), std::string::npos) << text;
        EXPECT_NE(text.find("3 open edges around 1 hole"), std::string::npos) << text;
        EXPECT_NE(text.find("Close Holes"), std::string::npos) << text;
    }
}

TEST(Mesh, AMeshInsideOutIsTurned) {
    auto mesh = sphere_mesh(2);
    for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
    const auto report = check_mesh(mesh).report;
    EXPECT_TRUE(report.inside_out);
    EXPECT_GT(report.volume, 0);
    EXPECT_EQ(report.notes().size(), 1u);
}

TEST(Mesh, SingleTrianglesThatFaceTheWrongWayAreTurned) {
    auto mesh = sphere_mesh(2);
    const double volume = check_mesh(mesh).report.volume;
    for (const std::size_t i : {0u, 17u, 18u, 40u}) std::swap(mesh.triangles[i][0], mesh.triangles[i][1]);
    const auto report = check_mesh(mesh).report;
    EXPECT_EQ(report.turned, 4u);
    EXPECT_NEAR(report.volume, volume, 1e-13); // round-off
}

TEST(Mesh, TrianglesWithoutAreaAreLeftOut) {
    auto mesh = cube_mesh();
    mesh.triangles.push_back({0, 0, 1});
    const auto report = check_mesh(mesh).report;
    EXPECT_EQ(report.degenerate, 1u);
    EXPECT_TRUE(report.closed());
}

TEST(Mesh, TwoCubesAreTwoComponents) {
    auto mesh = cube_mesh();
    for (const Vec3& v : cube_mesh().vertices) mesh.vertices.push_back(plus(v, 3, {1, 0, 0}));
    for (const auto& t : cube_mesh().triangles) mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
    const auto report = check_mesh(mesh).report;
    EXPECT_EQ(report.components, 2u);
    EXPECT_NEAR(report.volume, 2, 1e-13);
}

TEST(Mesh, AThinPlateIsReportedAsThin) {
    auto plate = cube_mesh();
    for (Vec3& v : plate.vertices) v[1] *= 0.01;
    EXPECT_NEAR(check_mesh(plate).report.thickness_p01, 0.01, 1e-9);
}

TEST(Mesh, AFileThatIsNoMeshIsRefused) {
    const MeshFile file("empty.obj", TriangleMesh{});
    EXPECT_THROW(read_mesh(file.path(), "scene.yaml:14"), InputError);
}

TEST(Mesh, AFlatMeshIsRefused) {
    auto flat = cube_mesh();
    for (Vec3& v : flat.vertices) v[2] *= 1e-30;
    const MeshFile file("flat.obj", flat);
    EXPECT_THROW(load_closed_mesh(file.path(), ""), InputError);
}

class Models : public ::testing::TestWithParam<const char*> {};

TEST_P(Models, AreClosedAndLoadedWithinTwoSeconds) {
    const std::string path = model(GetParam());
    if (path.empty()) GTEST_SKIP() << GetParam() << ": TREACLE_DATA does not name its folder";
    const Stopwatch watch;
    const auto report = load_closed_mesh(path, "").report;
    const double taken = watch.seconds();
    EXPECT_TRUE(report.closed());
    EXPECT_GT(report.volume, 0);
    EXPECT_LT(taken, 2.0);
    std::string notes;
    for (const auto& note : report.notes()) notes += note + "; ";
    std::printf("%s: %zu triangles, volume %g, thickness_p01 %g, %.2f s; %s\n", GetParam(), report.triangles,
        report.volume, report.thickness_p01, taken, notes.c_str());
}

INSTANTIATE_TEST_SUITE_P(Mesh, Models, ::testing::Values("bunny.ply", "dragon_50k.obj"));
