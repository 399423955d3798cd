#include "shapes.hpp"

#include "base/text/error.hpp"
#include "scene/sampling/sampling.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>

using namespace treacle;
using namespace treacle::scene;
using namespace treacle::scene::testing;

namespace {

struct Spread {
    double mean = 0, min = 1e300, farthest = 0; // nearest neighbours; from points of the surface
};

// Brute force would be quadratic: points sorted along x.
class Nearest {
public:
    explicit Nearest(std::vector<Vec3> points) : points_(std::move(points)) {
        std::sort(points_.begin(), points_.end());
    }
    double operator()(const Vec3& x, bool skip_itself) const {
        double best = 1e300;
        const auto start = std::lower_bound(points_.begin(), points_.end(), x);
        const auto look = [&](const Vec3& p) {
            if (!(skip_itself && p == x)) best = std::min(best, gap(p, x));
        };
        for (auto i = start; i != points_.end() && (*i)[0] - x[0] < best; ++i) look(*i);
        for (auto i = start; i != points_.begin() && x[0] - (*(i - 1))[0] < best; --i) look(*(i - 1));
        return best;
    }

private:
    std::vector<Vec3> points_;
};

// Random points of the layer at depth `inset`: random points of space moved there along the normal.
std::vector<Vec3> points_of_layer(const SolidRegion& region, double inset, double spacing) {
    const Bounds b = region.surface_bounds();
    const double margin = std::abs(inset) + 2 * spacing;
    RandomPoints random(plus(b.min, -margin, {1, 1, 1}), plus(b.max, margin, {1, 1, 1}));
    std::vector<Vec3> result;
    while (result.size() < 4000) {
        Vec3 x = random();
        if (region.dimensions() == 2) x[2] = 0;
        if (std::abs(region.distance(x) + inset) > 2 * spacing) continue;
        for (int i = 0; i < 30; ++i) x = plus(x, -(region.distance(x) + inset), region.normal(x));
        if (std::abs(region.distance(x) + inset) < 1e-6 * spacing) result.push_back(x);
    }
    return result;
}

Spread measure(const SolidRegion& region, const SurfaceSamples& samples, double inset, double spacing) {
    Spread spread;
    const Nearest nearest(samples.positions);
    for (const Vec3& x : samples.positions) {
        const double r = nearest(x, true);
        spread.mean += r / double(samples.positions.size());
        spread.min = std::min(spread.min, r);
    }
    for (const Vec3& x : points_of_layer(region, inset, spacing))
        spread.farthest = std::max(spread.farthest, nearest(x, false));
    return {spread.mean / spacing, spread.min / spacing, spread.farthest / spacing};
}

void expect_even(const Shape& shape, double spacing, double inset, int dimensions = 3) {
    const SolidRegion region(shape, dimensions);
    const auto samples = sample_surface(region, {spacing, inset, {}});
    const Spread s = measure(region, samples, inset, spacing);
    SCOPED_TRACE("shape " + std::to_string(int(shape.kind)) + " inset " + std::to_string(inset / spacing) + " d, " +
                 std::to_string(samples.positions.size()) + " points");
    std::printf("kind %d, inset %.2f d: %zu points, nearest mean %.3f min %.3f, farthest %.3f\n", int(shape.kind),
        inset / spacing, samples.positions.size(), s.mean, s.min, s.farthest);
    EXPECT_GE(s.mean, 0.85);
    EXPECT_LE(s.mean, 1.15);
    EXPECT_GE(s.min, 0.6);
    EXPECT_LE(s.farthest, 0.75);
    EXPECT_EQ(samples.thin, 0u);
    EXPECT_GE(estimate_surface_count(region, {spacing, inset, {}}), samples.positions.size());
    for (std::size_t i = 0; i < samples.positions.size(); ++i) {
        EXPECT_NEAR(region.distance(samples.positions[i]), -inset, 1e-6 * spacing);
        EXPECT_NEAR(gap(samples.normals[i], {0, 0, 0}), 1, 1e-12);
        // Outward, also on edges, where it is the mean of the faces.
        EXPECT_GT(region.distance(plus(samples.positions[i], 0.01 * spacing, samples.normals[i])),
            region.distance(samples.positions[i]));
    }
}

Shape along(Shape s, const Vec3& axis) {
    s.axis = axis;
    return s;
}

} // namespace

TEST(SurfaceSampling, IsEvenOnSolidsAtTheSurfaceAndBelow) {
    const double d = 0.05;
    const Vec3 c{0.1, 0.2, 0.3}, askew{1, 2, -1};
    for (const double inset : {0.0, 0.4 * d}) {
        expect_even(box({0, 0, 0}, {1, 0.73, 0.51}), d, inset);
        expect_even(round(ShapeKind::sphere, c, 0.5), d, inset);
        expect_even(along(round(ShapeKind::cylinder, c, 0.4, 0.9), askew), d, inset);
        expect_even(along(round(ShapeKind::capsule, c, 0.3, 0.8), askew), d, inset);
        expect_even(along(round(ShapeKind::cone, c, 0.5, 0.9), askew), d, inset);
        expect_even(along(round(ShapeKind::torus, c, 0.5, 0, 0.2), askew), d, inset);
    }
}

TEST(SurfaceSampling, IsEvenOnMeshesWithSharpEdges) {
    const MeshFile cube("cube.obj", cube_mesh());
    expect_even(mesh_shape(cube.path()), 0.08, 0);
    expect_even(mesh_shape(cube.path()), 0.08, 0.04);
}

TEST(SurfaceSampling, IsEvenOnTheBunny) {
    const std::string path = model("bunny.ply");
    if (path.empty()) GTEST_SKIP() << "bunny.ply: TREACLE_DATA does not name its folder";
    Shape shape = mesh_shape(path);
    shape.size = 1;
    const double d = 0.02;
    const SolidRegion region(shape);
    for (const double inset : {0.0, 0.5 * d}) {
        const Stopwatch watch;
        const auto samples = sample_surface(region, {d, inset, {}});
        const double taken = watch.seconds();
        const Spread s = measure(region, samples, inset, d);
        std::printf("bunny, inset %.1f d: %zu points (%zu thin), nearest mean %.3f min %.3f, farthest %.3f, %.2f s\n",
            inset / d, samples.positions.size(), samples.thin, s.mean, s.min, s.farthest, taken);
        EXPECT_GE(s.mean, 0.85);
        EXPECT_LE(s.mean, 1.15);
        EXPECT_GE(s.min, 0.6);
        EXPECT_LE(s.farthest, 0.75);
    }
}

TEST(SurfaceSampling, IsEvenInThePlane) {
    const double d = 0.05;
    for (const double inset : {0.0, 0.4 * d}) {
        expect_even(box({0, 0, 0}, {1, 0.73, 0}), d, inset, 2);
        expect_even(round(ShapeKind::sphere, {0.1, 0.2, 0}, 0.5), d, inset, 2);
        expect_even(round(ShapeKind::cone, {0, 0, 0}, 0.5, 0.9), d, inset, 2);
        expect_even(round(ShapeKind::capsule, {0, 0, 0}, 0.3, 0.8), d, inset, 2);
        expect_even(along(round(ShapeKind::torus, {0, 0, 0}, 0.5, 0, 0.2), {0, 0, 1}), d, inset, 2);
        expect_even(along(round(ShapeKind::cylinder, {0, 0, 0}, 0.5, 5), {0, 1, 1}), d, inset, 2);
    }
}

TEST(SurfaceSampling, OfABoxHasItsCornersAndASquareLattice) {
    const SolidRegion region(box({0, 0, 0}, {0.4, 0.3, 0.2}));
    const auto samples = sample_surface(region, {0.1, 0, {}});
    EXPECT_EQ(samples.positions.size(), 5u * 4 * 3 - 3u * 2 * 1); // lattice of nodes without its inside
    for (const Vec3& corner : {Vec3{0, 0, 0}, Vec3{0.4, 0.3, 0.2}, Vec3{0.4, 0, 0.2}})
        EXPECT_NE(std::find(samples.positions.begin(), samples.positions.end(), corner), samples.positions.end());
}

TEST(SurfaceSampling, IsTheSameBitForBitWhenRepeated) {
    const MeshFile file("sphere.obj", sphere_mesh(3));
    for (const Shape& shape : {mesh_shape(file.path()), round(ShapeKind::sphere, {0, 0, 0}, 1)}) {
        const auto a = sample_surface(SolidRegion(shape), {0.1, 0.05, {}});
        const auto b = sample_surface(SolidRegion(shape), {0.1, 0.05, {}});
        EXPECT_EQ(a.positions, b.positions);
        EXPECT_EQ(a.normals, b.normals);
    }
}

TEST(SurfaceSampling, BodiesThinnerThanTwiceTheInsetGetALayerInTheirMiddle) {
    const double d = 0.1;
    const MeshFile file("plate.obj", [] {
        auto m = cube_mesh();
        for (Vec3& v : m.vertices) v[1] *= 0.05;
        return m;
    }());
    const Shape plates[] = {box({0, 0, 0}, {1, 0.05, 1}), mesh_shape(file.path())};
    for (const Shape& shape : plates) {
        const auto samples = sample_surface(SolidRegion(shape), {d, 0.05, {}});
        // The sampled area is that of one side, less up to an inset at its rim; per d^2 between 1 and 1.6.
        EXPECT_GT(samples.positions.size(), 80u);
        EXPECT_LT(samples.positions.size(), 160u);
        EXPECT_EQ(samples.thin, samples.positions.size());
        for (const Vec3& x : samples.positions) EXPECT_NEAR(x[1], 0.025, 1e-5); // single precision of the file
    }
    EXPECT_EQ(sample_surface(SolidRegion(round(ShapeKind::sphere, {0, 0, 0}, 0.04)), {d, 0.05, {}}).thin, 1u);
    EXPECT_GT(sample_surface(SolidRegion(round(ShapeKind::torus, {0, 0, 0}, 1, 0, 0.04)), {d, 0.05, {}}).thin, 60u);
}

TEST(SurfaceSampling, OfAnInvertedBoxSurroundsIt) {
    Shape tank = box({0, 0, 0}, {1, 1, 1});
    tank.inverted = true;
    const SolidRegion region(tank);
    const auto samples = sample_surface(region, {0.1, 0.05, {}});
    std::set<Vec3> corners{{-0.05, -0.05, -0.05}, {1.05, 1.05, 1.05}};
    for (std::size_t i = 0; i < samples.positions.size(); ++i) {
        corners.erase(samples.positions[i]);
        EXPECT_LE(region.distance(samples.positions[i]), -0.05 + 1e-12);
        const Vec3 inside{0.5, 0.5, 0.5};
        EXPECT_LT(gap(plus(samples.positions[i], 0.01, samples.normals[i]), inside), gap(samples.positions[i], inside));
    }
    EXPECT_TRUE(corners.empty());
    EXPECT_GE(estimate_surface_count(region, {0.1, 0.05, {}}), samples.positions.size());
}

TEST(SurfaceSampling, OfAPlaneIsClippedAndNeedsAClip) {
    Shape floor;
    floor.kind = ShapeKind::plane;
    const SolidRegion region(floor);
    const auto samples = sample_surface(region, {0.1, 0.05, {{0, -1, 0}, {1, 1, 2}}});
    EXPECT_EQ(samples.positions.size(), 200u);
    for (const Vec3& x : samples.positions) EXPECT_NEAR(x[1], -0.05, 1e-15);
    EXPECT_THROW(sample_surface(region, {0.1, 0.05, {}}), InputError);
    const auto line = sample_surface(SolidRegion(floor, 2), {0.1, 0.05, {{0, -1, 0}, {1, 1, 0}}});
    EXPECT_EQ(line.positions.size(), 10u);
}

TEST(SurfaceSampling, LeavesOutWhatTheClipExcludes) {
    const SolidRegion region(box({0, 0, 0}, {1, 1, 1}));
    for (const Vec3& x : sample_surface(region, {0.1, 0, {{0, 0, 0}, {0.55, 2, 2}}}).positions) EXPECT_LE(x[0], 0.55);
}
