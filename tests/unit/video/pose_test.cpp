#include "../own_folder.hpp"
#include "../refusal.hpp"
#include "base/text/error.hpp"
#include "video/pose/contour_pose.hpp"
#include "video/pose/levels.hpp"
#include "video/pose/pose_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

using namespace treacle;
using namespace treacle::scene;
using namespace treacle::video;

namespace {
using test::refusal;

Lens some_lens() { return {640, 480, 600, 602, 322, 238, {-0.12, 0.06, 0.0005, -0.0007, -0.01, 0, 0, 0}}; }

// From in front of and above a block at the origin, 40 cm away.
CameraPose some_pose(double yaw = 0.5) {
    const Matrix3 down = rotation_matrix({-std::numbers::pi / 2 - 0.5, 0, 0}), turn = rotation_matrix({0, 0, yaw});
    const Matrix3 r = product(transposed(down), turn);
    const Matrix3 flip = {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, -1}};
    const Matrix3 rotation = product(flip, r);
    const Vec3 middle = apply(rotation, {0.03, 0.02, 0.02});
    return {rotation, {-middle[0], -middle[1], 0.4 - middle[2]}};
}

CameraRecord record_of(const CameraPose& pose) {
    CameraRecord out;
    out.name = "c";
    out.lens = some_lens();
    out.pose = pose;
    return out;
}

SeenSolid block() {
    SeenSolid out;
    out.name = "block";
    out.distance = [](const Vec3& x) {
        const Vec3 low{0, 0, 0}, high{0.06, 0.04, 0.04};
        double outside = 0, inside = -1e30;
        for (std::size_t k = 0; k < 3; ++k) {
            const double d = std::max(low[k] - x[k], x[k] - high[k]);
            if (d > 0) outside += d * d;
            inside = std::max(inside, d);
        }
        return outside > 0 ? std::sqrt(outside) : inside;
    };
    out.centre = {0.03, 0.02, 0.02};
    out.radius = 0.0413;
    return out;
}

std::vector<ScenePoint> points_seen(const CameraPose& pose, double noise, std::mt19937& random) {
    std::normal_distribution<double> normal;
    const CameraModel camera("", some_lens(), pose);
    std::vector<ScenePoint> out;
    for (int i = 0; i < 8; ++i) {
        const Vec3 x{(i & 1) ? 0.12 : -0.06, (i & 2) ? 0.1 : -0.05, (i & 4) ? 0.08 : -0.02};
        const auto p = camera.project(x);
        out.push_back({x, {p.x + noise * normal(random), p.y + noise * normal(random)}, 0, "p"});
    }
    return out;
}

double mahalanobis(const CameraPose& truth, const PoseEstimate& estimate) {
    const Vec3 w = rotation_vector(product(estimate.pose.rotation, transposed(truth.rotation)));
    cv::Matx<double, 6, 1> d;
    for (int k = 0; k < 3; ++k) {
        d(k) = w[std::size_t(k)];
        d(3 + k) = estimate.pose.translation[std::size_t(k)] - truth.translation[std::size_t(k)];
    }
    return (d.t() * inverse(matrix_of(estimate.covariance)) * d)(0);
}

double largest_shift(const CameraPose& a, const CameraPose& b) {
    const CameraModel first("", some_lens(), a), second("", some_lens(), b);
    double out = 0;
    for (int i = 0; i < 8; ++i) {
        const Vec3 x{(i & 1) ? 0.06 : 0.0, (i & 2) ? 0.04 : 0.0, (i & 4) ? 0.04 : 0.0};
        out = std::max(
            out, std::hypot(first.project(x).x - second.project(x).x, first.project(x).y - second.project(x).y));
    }
    return out;
}

} // namespace

TEST(Pose, JacobiansAreThoseOfDifferences) {
    const CameraModel camera("", some_lens(), some_pose());
    const Vec3 x{0.03, 0.01, 0.02};
    const auto jacobian = pixel_jacobian(camera, x);
    for (int k = 0; k < 6; ++k) {
        PoseVector up = PoseVector::all(0);
        up[k] = 1e-6;
        const auto a = CameraModel("", some_lens(), changed(some_pose(), -up)).project(x),
                   b = CameraModel("", some_lens(), changed(some_pose(), up)).project(x);
        EXPECT_NEAR(jacobian(0, k), (b.x - a.x) / 2e-6, 1e-3 * std::abs(jacobian(0, k)) + 1e-3);
        EXPECT_NEAR(jacobian(1, k), (b.y - a.y) / 2e-6, 1e-3 * std::abs(jacobian(1, k)) + 1e-3);
    }
}

TEST(Pose, ExactPointsGiveTheExactPose) {
    std::mt19937 random(1);
    const auto estimate = pose_of_points(record_of({}), points_seen(some_pose(), 0, random), {});
    EXPECT_LT(largest_shift(some_pose(), estimate.pose), 1e-6);
    auto four = points_seen(some_pose(), 0, random);
    four.resize(4); // on one plane
    EXPECT_LT(largest_shift(some_pose(), pose_of_points(record_of({}), four, {}).pose), 1e-4);
}

// chi2 of 6 degrees of freedom lies below 10.64 in 90 %; of 100 repeats 81 to 97 in all but 1 %.
TEST(Pose, CovarianceOfPointsIsHonest) {
    std::mt19937 random(2);
    int inside = 0;
    for (int k = 0; k < 100; ++k) {
        const auto pose = some_pose(0.06 * k);
        const auto estimate = pose_of_points(record_of({}), points_seen(pose, 0.7, random), {0.7});
        inside += mahalanobis(pose, estimate) < 10.64;
    }
    EXPECT_GE(inside, 81);
    EXPECT_LE(inside, 97);
}

TEST(Pose, BadPointsAreRefused) {
    std::mt19937 random(3);
    auto points = points_seen(some_pose(), 0, random);
    auto few = points;
    few.resize(3);
    EXPECT_NE(refusal([&] { (void)pose_of_points(record_of({}), few, {}); }).find("3 points do not fix a pose"),
        std::string::npos);
    auto mixed = points;
    std::swap(mixed[0].pixel, mixed[7].pixel);
    EXPECT_NE(refusal([&] { (void)pose_of_points(record_of({}), mixed, {}); }).find("no pose fits the points"),
        std::string::npos);
    auto line = points;
    for (std::size_t i = 0; i < line.size(); ++i) line[i].position = {0.01 * double(i), 0, 0};
    EXPECT_NE(
        refusal([&] { (void)pose_of_points(record_of({}), line, {}); }).find("lie on one line"), std::string::npos);
    points[2].pixel[0] = 700;
    EXPECT_NE(
        refusal([&] { (void)pose_of_points(record_of({}), points, {}); }).find("outside of pictures of 640 x 480"),
        std::string::npos);
}

TEST(Pose, TablesOfPointsHaveUnits) {
    const test::OwnFolder folder;
    const auto write = [&](const std::string& text) {
        const auto path = folder.path() / "points.csv";
        std::ofstream(path) << text;
        return path;
    };
    for (const auto* text : {"# corners\nx [cm], y [mm], z, u, v\n1, 2, 3, 4.5, 5\n",
             "x [cm]\ty [mm]\tz\tu\tv\n1\t2\t3\t4.5\t5\n", "x [cm] y [mm] z u v\n1 2 3 4.5 5\n"}) {
        const auto points = read_scene_points(write(text));
        ASSERT_EQ(points.size(), 1u);
        EXPECT_EQ(points[0].position, (Vec3{0.01, 0.002, 3}));
        EXPECT_EQ(points[0].pixel, (Vec2{4.5, 5}));
    }
    EXPECT_NE(refusal([&] {
        (void)read_scene_points(write("x,y,z,u\n1,2,3,4\n"));
    }).find("points.csv:1: the column v is missing"),
        std::string::npos);
    EXPECT_NE(
        refusal([&] { (void)read_scene_points(write("x,y,z,u,v\n1,2,3,4\n")); }).find("points.csv:2: has 4 values"),
        std::string::npos);
    EXPECT_NE(refusal([&] { (void)read_scene_points(write("x,y,z,u,v\n1,2,3,4,a\n")); }).find("\"a\" is no number"),
        std::string::npos);
    EXPECT_NE(refusal([&] { (void)read_scene_points(write("x [kg],y,z,u,v\n1,2,3,4,5\n")); }).find("must be a length"),
        std::string::npos);
}

TEST(ContourPose, FindsThePoseFromTwoDegreesAndACentimetreAway) {
    const auto truth = some_pose();
    const CameraModel camera("", some_lens(), truth);
    Silhouette mask{"mask", look_at(camera, {block()}).mask()};
    const auto start = changed(truth, {0.02, -0.025, 0.03, 0.008, -0.006, 0.01});
    EXPECT_GT(largest_shift(truth, start), 15);
    const auto found = refine_on_contour(record_of(start), block(), mask, {});
    // Steps of pixels leave some 0.3 pixel at a point, averaged over the outline.
    EXPECT_LT(largest_shift(truth, found.estimate.pose), 0.3);
    EXPECT_GT(found.overlap_after, 0.99);
    EXPECT_LT(found.overlap_before, 0.9);
    EXPECT_GT(found.fitting, 0.9);
    EXPECT_NEAR(found.mean, 0, 0.05);
}

// A third of the outline belongs to liquid that has moved.
TEST(ContourPose, PartsThatMovedAreLeftOut) {
    const auto truth = some_pose();
    const CameraModel camera("", some_lens(), truth);
    SeenSolid blob = block();
    blob.distance = [](const Vec3& x) {
        return std::sqrt(std::pow(x[0] - 0.055, 2) + std::pow(x[1] - 0.02, 2) + std::pow(x[2] - 0.015, 2)) - 0.022;
    };
    blob.centre = {0.055, 0.02, 0.015};
    blob.radius = 0.023;
    Silhouette mask{"mask", look_at(camera, {block(), blob}).mask()};
    const auto found =
        refine_on_contour(record_of(changed(truth, {0.01, -0.01, 0.01, 0.003, -0.003, 0.005})), block(), mask, {});
    EXPECT_LT(largest_shift(truth, found.estimate.pose), 0.6);
    EXPECT_LT(found.fitting, 0.95);
}

TEST(ContourPose, AnotherPlaceIsRefused) {
    const CameraModel camera("", some_lens(), some_pose());
    Silhouette mask{"mask.png", look_at(camera, {block()}).mask()};
    const auto far = changed(some_pose(), {0, 0, 0, 0.2, 0, 0});
    EXPECT_NE(refusal([&] { (void)refine_on_contour(record_of(far), block(), mask, {}); }).find("lies nowhere near"),
        std::string::npos);
    mask.mask.width /= 2;
    EXPECT_NE(
        refusal([&] { (void)refine_on_contour(record_of(some_pose()), block(), mask, {}); }).find("was calibrated for"),
        std::string::npos);
}

TEST(Levels, VerticalOfATiltedLevelAndAPlumbLine) {
    const CameraModel camera("", some_lens(), some_pose());
    const Vec3 up{std::sin(0.02), 0, std::cos(0.02)}; // level z = 3 cm - x tan(0.02)
    std::vector<PlanePixel> level, plumb;
    const auto add = [&](std::vector<PlanePixel>& list, const Vec3& x, int axis) {
        const auto p = camera.project(x);
        list.push_back({{p.x, p.y}, axis, x[std::size_t(axis)], "level.csv:1"});
    };
    for (const double x : {0.0, 0.03, 0.06}) add(level, {x, 0, 0.03 - x * std::tan(0.02)}, 1);
    for (const double y : {0.0, 0.02, 0.04}) add(level, {0.06, y, 0.03 - 0.06 * std::tan(0.02)}, 0);
    const auto found = vertical_of_level(record_of(some_pose()), level, {0, 0, 1}, 0.5);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found.up[k], up[k], 1e-6);
    EXPECT_GT(found.deviation, 0.001);
    EXPECT_LT(found.deviation, 0.05);
    for (const double s : {0.0, 0.04, 0.08}) add(plumb, {0.02 + s * up[0], 0, s * up[2]}, 1);
    const auto line = vertical_of_plumb(record_of(some_pose()), plumb, {0, 0, 1}, 0.5);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(line.up[k], up[k], 1e-6);
    EXPECT_NE(refusal([&] {
        (void)vertical_of_level(record_of(some_pose()), {level.begin(), level.begin() + 3}, {0, 0, 1}, 0.5);
    }).find("lie on one line"),
        std::string::npos);
}
