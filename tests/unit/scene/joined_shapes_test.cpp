#include "shapes.hpp"

#include "base/text/error.hpp"
#include "scene/sampling/sampling.hpp"
#include "scene/sampling/signed_distance.hpp"
#include "scene/shapes/clip.hpp"

#include <gtest/gtest.h>
#include <numbers>

using namespace treacle;
using namespace treacle::scene;
using namespace treacle::scene::testing;

namespace {

constexpr double pi = std::numbers::pi;

Shape joined(ShapeKind kind, std::vector<Shape> parts) {
    Shape s;
    s.kind = kind;
    s.where = "scene.yaml:7";
    s.parts = std::move(parts);
    return s;
}

Shape cylinder(double radius, double height) {
    Shape s = round(ShapeKind::cylinder, {0, 0, 0}, radius, height);
    s.axis = {0, 0, 1};
    return s;
}

// Both ends of the hole are flush with those of the pipe.
Shape pipe() { return joined(ShapeKind::subtract, {cylinder(0.5, 1), cylinder(0.3, 1)}); }

// Of a rectangle: the pipe's section, and that of a block.
double from_rectangle(double x, double y, double x_min, double x_max, double half) {
    const double across = std::max(x_min - x, x - x_max), along = std::abs(y) - half;
    if (across > 0 && along > 0) return std::hypot(across, along);
    return std::max(across, along);
}
double from_pipe(const Vec3& x) { return from_rectangle(std::hypot(x[0], x[1]), x[2], 0.3, 0.5, 0.5); }

// Relative errors of a region's volume and largest inertia about its centre.
void expect_moments(const SolidRegion& region, double volume, double inertia_zz) {
    EXPECT_NEAR(region.volume() / volume, 1, 5e-4);
    EXPECT_NEAR(region.moments().inertia[2][2] / inertia_zz, 1, 1e-3);
}

} // namespace

TEST(JoinedShapes, APipeHasTheDistancesOfItsSection) {
    const SolidRegion region(pipe());
    RandomPoints random({-0.8, -0.8, -0.8}, {0.8, 0.8, 0.8});
    for (int i = 0; i < 4000; ++i) {
        const Vec3 x = random();
        EXPECT_NEAR(region.distance(x), from_pipe(x), 5e-4) << x[0] << " " << x[1] << " " << x[2];
    }
    // The bore is open, although the two cylinders end in the same planes.
    EXPECT_NEAR(region.distance({0, 0, 0.5}), 0.3, 1e-9);
    EXPECT_NEAR(region.distance({0.1, 0, 0.5}), 0.2, 1e-6);
    expect_moments(region, pi * (0.25 - 0.09), pi / 2 * (0.0625 - 0.0081));
}

TEST(JoinedShapes, TwoBoxesWithACommonFaceAreOne) {
    const SolidRegion region(joined(ShapeKind::unite, {box({0, 0, 0}, {0.4, 1, 1}), box({0.4, 0, 0}, {1, 1, 1})}));
    const SolidRegion whole(box({0, 0, 0}, {1, 1, 1}));
    RandomPoints random({-0.3, -0.3, -0.3}, {1.3, 1.3, 1.3});
    for (int i = 0; i < 4000; ++i) {
        const Vec3 x = random();
        EXPECT_NEAR(region.distance(x), whole.distance(x), 1e-3);
    }
    EXPECT_NEAR(region.distance({0.4, 0.5, 0.5}), -0.4, 1e-9);
    expect_moments(region, 1, 1.0 / 6);
}

TEST(JoinedShapes, OutsideAnIntersectionTheNearestPointMayBeOnAnEdge) {
    Shape half;
    half.kind = ShapeKind::plane;
    half.axis = {0, 0, 1};
    const SolidRegion region(joined(ShapeKind::intersect, {round(ShapeKind::sphere, {0, 0, 0}, 1), half}));
    RandomPoints random({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5});
    for (int i = 0; i < 4000; ++i) {
        const Vec3 x = random();
        const double r = std::hypot(x[0], x[1]), R = std::hypot(r, x[2]);
        const double rim = std::hypot(r - 1, x[2]);
        const double exact = x[2] > 0 ? (r < 1 ? x[2] : rim) : std::max(R - 1, x[2]);
        EXPECT_NEAR(region.distance(x), exact, 5e-4);
    }
    EXPECT_NEAR(region.bounds().max[2], 0, 1e-12);
    EXPECT_NEAR(region.bounds().min[2], -1, 1e-12);
    expect_moments(region, 2 * pi / 3, 4 * pi / 15);
}

TEST(JoinedShapes, AHollowBallHasItsInertia) {
    const SolidRegion region(joined(
        ShapeKind::subtract, {round(ShapeKind::sphere, {3, 0, 0}, 1), round(ShapeKind::sphere, {3, 0, 0}, 0.8)}));
    EXPECT_NEAR(region.moments().centre[0], 3, 1e-6);
    expect_moments(region, 4 * pi / 3 * (1 - std::pow(0.8, 3)), 8 * pi / 15 * (1 - std::pow(0.8, 5)));
    EXPECT_LT(region.distance({3.9, 0, 0}), 0);
    EXPECT_NEAR(region.distance({3, 0, 0}), 0.8, 1e-9);
}

TEST(JoinedShapes, PartsKeepTheirOwnPlaceInsideAShapeThatIsPlaced) {
    Shape bar = box({0, 0, 0}, {2, 0.2, 0.2});
    bar.rotation_angle = pi / 2; // about its own centre
    bar.rotation_axis = {0, 0, 1};
    Shape s =
        joined(ShapeKind::unite, {joined(ShapeKind::subtract, {bar, round(ShapeKind::sphere, {1, 1.1, 0.1}, 0.05)}),
                                     round(ShapeKind::sphere, {4, 0, 0}, 0.5)});
    s.rotation_angle = pi / 2; // about the origin
    s.rotation_axis = {0, 0, 1};
    s.translation = {0, 0, 1};
    const SolidRegion region(s);
    // The bar stands at x = 0.9 .. 1.1, y = -0.9 .. 1.1, and (x, y, z) goes to (-y, x, z + 1).
    EXPECT_NEAR(region.distance({0.5, 1, 1.1}), -0.1, 1e-9);
    EXPECT_GT(region.distance({-1.1 + 0.01, 1, 1.1}), 0); // in the ball that is taken out
    EXPECT_NEAR(region.distance({0, 4, 1}), -0.5, 1e-9);
    EXPECT_NEAR(region.distance({0, 5, 1}), 0.5, 1e-9);
}

TEST(JoinedShapes, InThePlaneCutsAreJoined) {
    // Two ends of a ring that a box opens, and a part that does not meet the plane.
    const Shape far = round(ShapeKind::sphere, {0, 0, 5}, 1);
    const Shape ring =
        joined(ShapeKind::subtract, {cylinder(0.5, 2), cylinder(0.3, 2), box({0, -0.1, -1}, {1, 0.1, 1}), far});
    const SolidRegion region(ring, 2);
    EXPECT_GT(region.distance({0.4, 0, 0}), 0);
    EXPECT_NEAR(region.distance({-0.4, 0, 0}), -0.1, 1e-9);
    EXPECT_NEAR(region.distance({0.4, 0, 0}), 0.1, 1e-9);
    EXPECT_NEAR(region.distance({0, 0, 0}), std::hypot(std::sqrt(0.09 - 0.01), 0.1), 1e-9);
    const double strip = 2 * (0.1 / 2 * std::sqrt(0.25 - 0.01) + 0.125 * std::asin(0.2) -
                                 0.1 / 2 * std::sqrt(0.09 - 0.01) - 0.045 * std::asin(1.0 / 3));
    EXPECT_NEAR(region.volume() / (pi * 0.16 - strip), 1, 5e-4);
}

TEST(JoinedShapes, OfAMeshAndAShape) {
    const MeshFile cube("cube.obj", cube_mesh());
    const Shape drilled = joined(ShapeKind::subtract, {mesh_shape(cube.path()), box({0.25, 0.25, 0}, {0.75, 0.75, 1})});
    const SolidRegion region(drilled);
    EXPECT_NEAR(region.volume(), 0.75, 4e-4);
    EXPECT_NEAR(region.distance({0.5, 0.5, 1}), 0.25, 1e-9);
    EXPECT_NEAR(region.distance({0.1, 0.5, 0.5}), -0.1, 1e-9);
    EXPECT_EQ(region.meshes().size(), 1u);
}

TEST(JoinedShapes, LayersCoverTheSurfaceAndNothingElse) {
    const double d = 0.05;
    for (const double inset : {0.0, 0.4 * d, -0.5 * d}) {
        const SolidRegion region(pipe());
        const auto samples = sample_surface(region, {d, inset, {}});
        double farthest = 0, closest = 1;
        for (std::size_t i = 0; i < samples.positions.size(); ++i) {
            EXPECT_NEAR(from_pipe(samples.positions[i]), -inset, 3e-2 * d); // inside the bore none
            for (std::size_t j = 0; j < i; ++j)
                closest = std::min(closest, gap(samples.positions[i], samples.positions[j]));
        }
        RandomPoints random({-0.6, -0.6, -0.6}, {0.6, 0.6, 0.6});
        for (int i = 0; i < 3000; ++i) {
            const Vec3 x = random(), foot = plus(x, -(region.distance(x) + inset), region.normal(x));
            if (std::abs(region.distance(foot) + inset) > 1e-6) continue;
            double nearest = 1;
            for (const Vec3& y : samples.positions) nearest = std::min(nearest, gap(foot, y));
            farthest = std::max(farthest, nearest);
        }
        EXPECT_LT(farthest, 0.9 * d) << inset; // as of meshes
        EXPECT_GT(closest, 0.6 * d) << inset;
        EXPECT_LE(samples.positions.size(), estimate_surface_count(region, {d, inset, {}})) << inset;
    }
}

TEST(JoinedShapes, ClipKeepsWhatIsInTheBox) {
    const Bounds domain{{0, 0, 0}, {1, 1, 1}};
    const SolidRegion region(clipped(round(ShapeKind::sphere, {0, 0, 0}, 0.5), domain));
    EXPECT_NEAR(region.volume() / (pi / 6 * 0.125), 1, 5e-4);
    EXPECT_GE(region.bounds().min[0], 0);
    EXPECT_NE(refusal(clipped(round(ShapeKind::sphere, {-3, 0, 0}, 0.5), domain)).find("sphere.clip leaves nothing"),
        std::string::npos);
}

TEST(JoinedShapes, WithoutAnEndAreBoundedByTheClip) {
    Shape floor;
    floor.kind = ShapeKind::plane;
    floor.axis = {0, 0, 1};
    Shape pit = cylinder(0.3, 1);
    const SolidRegion region(joined(ShapeKind::subtract, {floor, pit}));
    EXPECT_FALSE(region.closed());
    EXPECT_GT(region.distance({0, 0, -0.1}), 0);
    EXPECT_LT(region.distance({0.5, 0, -0.1}), 0);
    const auto samples = sample_surface(region, {0.05, 0.02, {{-1, -1, -1}, {1, 1, 1}}});
    for (const Vec3& x : samples.positions) EXPECT_NEAR(region.distance(x), -0.02, 1e-3);
    // Turned inside out what is left is a hole with an end.
    Shape hole = joined(ShapeKind::unite, {box({0, 0, 0}, {1, 1, 1}), box({1, 0, 0}, {2, 0.5, 1})});
    hole.inverted = true;
    const SolidRegion around(joined(ShapeKind::intersect, {hole}));
    EXPECT_TRUE(around.closed());
    EXPECT_TRUE(std::isinf(around.volume()));
    EXPECT_NEAR(around.distance({0.5, 0.5, 0.5}), 0.5, 1e-9);
}

TEST(JoinedShapes, ThatAreEmptyAreRefusedWithTheReason) {
    EXPECT_NE(refusal(joined(ShapeKind::subtract, {cylinder(0.3, 1), cylinder(0.5, 2)}))
                  .find("scene.yaml:7: difference is empty"),
        std::string::npos);
    EXPECT_NE(refusal(joined(ShapeKind::intersect, {cylinder(0.3, 1), box({2, 0, 0}, {3, 1, 1})}))
                  .find("have nothing in common"),
        std::string::npos);
    EXPECT_NE(refusal(joined(ShapeKind::unite,
                          {round(ShapeKind::sphere, {9, 0, 5}, 1), round(ShapeKind::sphere, {0, 0, 5}, 1)}),
                  2)
                  .find("z = 0"),
        std::string::npos);
}
