#include "shapes.hpp"

#include "base/text/error.hpp"
#include "scene/sampling/nearby_distance.hpp"
#include "scene/sampling/signed_distance.hpp"

#include <gtest/gtest.h>
#include <numbers>
#include <vector>

using namespace treacle;
using namespace treacle::scene;
using namespace treacle::scene::testing;

namespace {

constexpr double pi = std::numbers::pi;

Shape turned(Shape s, double angle, const Vec3& axis, const Vec3& translation) {
    s.rotation_angle = angle;
    s.rotation_axis = axis;
    s.translation = translation;
    return s;
}

Shape along(Shape s, const Vec3& axis) {
    s.axis = axis;
    return s;
}

std::vector<Shape> solids() {
    const Vec3 c{0.1, -0.2, 0.3}, askew{1, 2, -1};
    return {box({-0.5, -0.4, -0.3}, {0.6, 0.5, 0.4}),
        turned(box({-0.5, -0.4, -0.3}, {0.6, 0.5, 0.4}), 0.7, askew, {0.1, 0, 0}), round(ShapeKind::sphere, c, 0.6),
        along(round(ShapeKind::cylinder, c, 0.4, 0.9), askew), along(round(ShapeKind::capsule, c, 0.3, 0.8), askew),
        turned(along(round(ShapeKind::cone, c, 0.5, 0.9), askew), 1.1, {0, 1, 0}, {0, 0.2, 0}),
        along(round(ShapeKind::torus, c, 0.5, 0, 0.2), askew)};
}

double at(const Shape& s, const Vec3& x, int dimensions = 3) { return SolidRegion(s, dimensions).distance(x); }

} // namespace

TEST(SignedDistance, AgreesWithFormulasOnAxes) {
    const double e = 1e-14; // round-off
    EXPECT_NEAR(at(box({0, 0, 0}, {2, 4, 6}), {1, 2, 3}), -1, e);
    EXPECT_NEAR(at(box({0, 0, 0}, {2, 4, 6}), {5, 8, 3}), 5, e);
    EXPECT_NEAR(at(round(ShapeKind::sphere, {1, 0, 0}, 2), {1, 5, 0}), 3, e);
    EXPECT_NEAR(at(round(ShapeKind::cylinder, {0, 0, 0}, 1, 2), {4, 5, 0}), 5, e);
    EXPECT_NEAR(at(round(ShapeKind::cylinder, {0, 0, 0}, 1, 2), {0, 0.25, 0}), -0.75, e);
    EXPECT_NEAR(at(round(ShapeKind::capsule, {0, 0, 0}, 1, 2), {0, 5, 0}), 3, e);
    EXPECT_NEAR(at(round(ShapeKind::torus, {0, 0, 0}, 3, 0, 1), {0, 0, 0}), 2, e);
    EXPECT_NEAR(at(round(ShapeKind::torus, {0, 0, 0}, 3, 0, 1), {3, 0, 0}), -1, e);
    // Base radius 3 at y = -2, apex at y = 2: from the axis at the base level the side is 3 * 4 / 5 away.
    EXPECT_NEAR(at(round(ShapeKind::cone, {0, 0, 0}, 3, 4), {0, -2, 0}), 0, e);
    EXPECT_NEAR(at(round(ShapeKind::cone, {0, 0, 0}, 3, 4), {0, 4, 0}), 2, e);
    EXPECT_NEAR(at(round(ShapeKind::cone, {0, 0, 0}, 3, 4), {0, 1.5, 0}), -0.5 * 3 / 5, e);
    Shape plane;
    plane.kind = ShapeKind::plane;
    plane.axis = {0, 2, 0};
    EXPECT_NEAR(at(plane, {7, -3, 1}), -3, e);
}

TEST(SignedDistance, HasAUnitGradientEqualToTheNormal) {
    for (const Shape& shape : solids()) {
        const SolidRegion region(shape);
        RandomPoints random({-1.2, -1.2, -1.2}, {1.2, 1.2, 1.2});
        int kinks = 0;
        for (int i = 0; i < 2000; ++i) {
            const Vec3 x = random(), n = region.normal(x);
            EXPECT_NEAR(gap(n, {0, 0, 0}), 1, 1e-12);
            const double step = 1e-5;
            const double slope = (region.distance(plus(x, step, n)) - region.distance(plus(x, -step, n))) / (2 * step);
            // Second order in the step; only on the medial axis, of no volume, is there a kink.
            kinks += std::abs(slope - 1) > 1e-6;
        }
        EXPECT_LT(kinks, 5) << int(shape.kind);
    }
}

TEST(SignedDistance, WalkingTheDistanceAlongTheNormalEndsOnTheSurface) {
    for (const Shape& shape : solids()) {
        const SolidRegion region(shape);
        RandomPoints random({-1.2, -1.2, -1.2}, {1.2, 1.2, 1.2});
        for (int i = 0; i < 2000; ++i) {
            const Vec3 x = random();
            const Vec3 foot = plus(x, -region.distance(x), region.normal(x));
            EXPECT_NEAR(region.distance(foot), 0, 1e-12) << int(shape.kind); // round-off
        }
    }
}

TEST(SignedDistance, VolumeAndBoundsAgreeWithCounting) {
    for (const Shape& shape : solids()) {
        const SolidRegion region(shape);
        const Bounds b = region.bounds();
        const int n = 60;
        int inside = 0;
        Vec3 low{9, 9, 9}, high{-9, -9, -9};
        for (int i = 0; i < n * n * n; ++i) {
            Vec3 x;
            const int index[3] = {i % n, i / n % n, i / n / n};
            for (int a = 0; a < 3; ++a) x[a] = b.min[a] - 0.1 + (b.max[a] - b.min[a] + 0.2) * (index[a] + 0.5) / n;
            if (region.distance(x) > 0) continue;
            ++inside;
            for (int a = 0; a < 3; ++a) low[a] = std::min(low[a], x[a]), high[a] = std::max(high[a], x[a]);
        }
        double cell = 1;
        for (int a = 0; a < 3; ++a) {
            const double step = (b.max[a] - b.min[a] + 0.2) / n;
            cell *= step;
            EXPECT_GE(low[a], b.min[a] - 1e-12);
            EXPECT_LE(high[a], b.max[a] + 1e-12);
            EXPECT_LT(low[a] - b.min[a], 3 * step); // tight: the apex of the cone is narrow
            EXPECT_LT(b.max[a] - high[a], 3 * step);
        }
        EXPECT_NEAR(inside * cell / region.volume(), 1, 0.02) << int(shape.kind); // surface cells at 60 per edge
    }
}

TEST(SignedDistance, InvertedIsTheNegative) {
    Shape shape = round(ShapeKind::sphere, {0, 0, 0}, 1);
    shape.inverted = true;
    const SolidRegion region(shape);
    EXPECT_DOUBLE_EQ(region.distance({3, 0, 0}), -2);
    EXPECT_DOUBLE_EQ(region.normal({3, 0, 0})[0], -1);
    EXPECT_TRUE(std::isinf(region.volume()));
    EXPECT_TRUE(std::isinf(region.bounds().max[0]));
    EXPECT_DOUBLE_EQ(region.surface_bounds().max[0], 1);
}

TEST(SignedDistance, OfAMeshAgreesWithTheShapeItStandsFor) {
    const MeshFile cube("cube.obj", cube_mesh());
    const SolidRegion mesh(mesh_shape(cube.path())), exact(box({0, 0, 0}, {1, 1, 1}));
    RandomPoints random({-0.5, -0.5, -0.5}, {1.5, 1.5, 1.5});
    for (int i = 0; i < 20000; ++i) {
        const Vec3 x = random();
        EXPECT_NEAR(mesh.distance(x), exact.distance(x), 1e-13); // round-off
    }
    const Vec3 corner = mesh.normal({1, 1, 1});
    EXPECT_NEAR(corner[0], 1 / std::sqrt(3), 1e-6); // three equal angles
}

TEST(SignedDistance, PlacesAMeshByScaleSizeRotationAndTranslation) {
    const MeshFile cube("cube.obj", cube_mesh());
    Shape shape = mesh_shape(cube.path());
    shape.scale = 2;
    shape.translation = {1, 0, 0};
    EXPECT_NEAR(at(shape, {2, 1, 1}), -1, 1e-13);
    shape.size = 4; // centred at the origin first, scale ignored
    EXPECT_NEAR(at(shape, {1, 0, 0}), -2, 1e-13);
    shape.rotation_angle = pi / 4;
    EXPECT_NEAR(at(shape, {1 + 2 * std::sqrt(2), 0, 0}), 0, 1e-12);
    EXPECT_NEAR(SolidRegion(shape).volume(), 64, 1e-10);
}

TEST(SignedDistance, OfOverlappingMeshPartsIsInsideBoth) {
    auto mesh = cube_mesh();
    for (const Vec3& v : cube_mesh().vertices) mesh.vertices.push_back(plus(v, 0.5, {1, 0.3, 0.2}));
    for (const auto& t : cube_mesh().triangles) mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
    const MeshFile file("two.obj", mesh);
    const SolidRegion region(mesh_shape(file.path()));
    EXPECT_LT(region.distance({0.2, 0.5, 0.5}), 0);
    EXPECT_LT(region.distance({0.8, 0.6, 0.6}), 0);
    EXPECT_LT(region.distance({1.3, 0.6, 0.6}), 0);
    EXPECT_GT(region.distance({1.3, 0.05, 0.6}), 0);
}

// Places along a path that jumps at times, stands still at times, and at times lies in the surface.
std::vector<Vec3> path_of_places() {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<Vec3> out{{0.5, 0.5, 0.5}};
    for (int i = 0; i < 20000; ++i) {
        const double step = i % 100 == 0 ? 1 : i % 10 == 0 ? 0 : std::pow(10, -1 - i % 5);
        Vec3 x = plus(out.back(), step, {unit(random), unit(random), unit(random)});
        if (i % 77 == 0) x[static_cast<std::size_t>(i % 3)] = i % 2;
        for (double& a : x) a = a < -1 || a > 2 ? 0.5 : a;
        out.push_back(x);
    }
    return out;
}

TEST(SignedDistance, OfPlacesThatFollowEachOtherIsTheSameBitForBit) {
    const MeshFile cube("cube.obj", cube_mesh());
    auto two = cube_mesh();
    for (const Vec3& v : cube_mesh().vertices) two.vertices.push_back(plus(v, 1, {0, 0, 1.3}));
    for (const auto& t : cube_mesh().triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
    const MeshFile pair("pair.obj", two);
    Shape outside = mesh_shape(cube.path());
    outside.inverted = true;
    for (const Shape& shape : {mesh_shape(cube.path()), mesh_shape(pair.path()), outside, box({0, 0, 0}, {1, 1, 1})}) {
        const SolidRegion region(shape);
        NearbyDistance distance(region);
        for (const Vec3& x : path_of_places()) ASSERT_EQ(distance(x), region.distance(x)) << x[0] << ' ' << x[1];
    }
}

TEST(SignedDistance, OfTheBunnyTakesMicroseconds) {
    const std::string path = model("bunny.ply");
    if (path.empty()) GTEST_SKIP() << "bunny.ply: TREACLE_DATA does not name its folder";
    Shape shape = mesh_shape(path);
    shape.size = 1;
    const SolidRegion region(shape);
    RandomPoints random({-0.6, -0.6, -0.6}, {0.6, 0.6, 0.6});
    const int n = 100'000;
    int inside = 0;
    const Stopwatch watch;
    for (int i = 0; i < n; ++i) inside += region.distance(random()) < 0;
    const double taken = watch.seconds();
    EXPECT_LT(taken / n, 20e-6); // measured 5 microseconds
    std::printf("%.2f us per query\n", taken / n * 1e6);
    // Three standard deviations of counting.
    const double fraction = region.volume() / (1.2 * 1.2 * 1.2);
    EXPECT_NEAR(double(inside) / n, fraction, 3 * std::sqrt(fraction / n));
}

TEST(PlaneScene, RegionsAreTheCutAtZeroHeight) {
    EXPECT_NEAR(at(box({0, 0, 0}, {2, 4, 0}), {1, 2, 0}, 2), -1, 1e-14);
    EXPECT_NEAR(at(round(ShapeKind::sphere, {0, 0, 3}, 5), {6, 0, 0}, 2), 2, 1e-14);
    EXPECT_NEAR(at(along(round(ShapeKind::cylinder, {0, 0, 0}, 1, 0.1), {0, 0, 1}), {0, 0, 0}, 2), -1, 1e-14);
    EXPECT_NEAR(at(round(ShapeKind::cone, {0, 0, 0}, 3, 4), {0, 4, 0}, 2), 2, 1e-14);
    const Shape ring = along(round(ShapeKind::torus, {0, 0, 0}, 3, 0, 1), {0, 0, 1});
    EXPECT_NEAR(at(ring, {0, 0, 0}, 2), 2, 1e-14);
    EXPECT_NEAR(SolidRegion(ring, 2).volume(), pi * (16 - 4), 1e-12);
    EXPECT_NEAR(
        at(turned(box({-1, -1, 0}, {1, 1, 0}), pi / 4, {0, 0, 1}, {0, 0, 0}), {std::sqrt(2), 0, 0}, 2), 0, 1e-14);
}

TEST(PlaneScene, ObliqueCutsAreExactToTheirGrid) {
    // A cylinder along (0, 1, 1) cuts the plane in an ellipse of half-axes 1 and sqrt 2.
    const SolidRegion ellipse(along(round(ShapeKind::cylinder, {0, 0, 0}, 1, 20), {0, 1, 1}), 2);
    EXPECT_NEAR(ellipse.distance({1.5, 0, 0}), 0.5, 1e-5);
    EXPECT_NEAR(ellipse.distance({0, 2, 0}), 2 - std::sqrt(2), 1e-5);
    EXPECT_NEAR(ellipse.volume(), pi * std::sqrt(2), 1e-4);
    EXPECT_LT(ellipse.distance({0, 0, 0}), 0);
}

TEST(PlaneScene, MeshesAreSlicedEvenThroughVertices) {
    const MeshFile sphere("sphere.obj", sphere_mesh(5));
    Shape shape = mesh_shape(sphere.path());
    for (const double height : {0.0, 0.3}) {
        shape.translation = {0, 0, height};
        const SolidRegion disc(shape, 2);
        const double r = std::sqrt(1 - height * height);
        // Chords of 128 per circle: within 1 - cos(pi / 128) = 3e-4, and as much by slicing between vertices.
        EXPECT_NEAR(disc.distance({0, 0, 0}), -r, 1e-3);
        EXPECT_NEAR(disc.distance({2, 0, 0}), 2 - r, 1e-3);
        EXPECT_NEAR(disc.volume(), pi * r * r, 3e-3);
    }
}

TEST(PlaneScene, AMeshWithItsTopInThePlaneIsCutBelowIt) {
    const MeshFile cube("cube.obj", cube_mesh());
    Shape shape = mesh_shape(cube.path());
    shape.translation = {0, 0, -1};
    const SolidRegion square(shape, 2);
    EXPECT_NEAR(square.distance({0.5, 0.5, 0}), -0.5, 1e-12);
    EXPECT_NEAR(square.volume(), 1, 1e-12);
}

TEST(Refusals, NameTheParameterAndThePlace) {
    EXPECT_NE(refusal(box({0, 0, 0}, {1, 0, 1})).find("along y"), std::string::npos);
    EXPECT_NE(refusal(box({0, 0, 0}, {1, 0, 1})).find("scene.yaml:7"), std::string::npos);
    EXPECT_NE(refusal(round(ShapeKind::sphere, {0, 0, 0}, -1)).find("sphere.radius = -1"), std::string::npos);
    EXPECT_NE(refusal(round(ShapeKind::cylinder, {0, 0, 0}, 1, 0)).find("cylinder.height"), std::string::npos);
    EXPECT_NE(refusal(round(ShapeKind::torus, {0, 0, 0}, 1, 0, 2)).find("torus.tube_radius"), std::string::npos);
    EXPECT_NE(refusal(along(round(ShapeKind::cone, {0, 0, 0}, 1, 1), {0, 0, 0})).find("cone.axis"), std::string::npos);
    EXPECT_NE(refusal(round(ShapeKind::sphere, {0, 0, NAN}, 1)).find("sphere.centre"), std::string::npos);
    EXPECT_NE(refusal(round(ShapeKind::sphere, {0, 0, 3}, 1), 2).find("z = 0"), std::string::npos);
    EXPECT_NE(refusal(mesh_shape("no_such.ply")).find("no_such.ply"), std::string::npos);
}
