#include "base/text/error.hpp"
#include "shapes.hpp"
#include "surface/silhouette.hpp"

#include <gtest/gtest.h>

namespace treacle::surface::silhouette_test {
namespace {

using namespace test;

scene::CameraModel camera(double k1 = 0, const Vec3& shift = {0, 0, 0}) {
    scene::Lens lens;
    lens.width = 640;
    lens.height = 480;
    lens.fx = 600;
    lens.fy = 610;
    lens.cx = 321.3;
    lens.cy = 236.8;
    lens.distortion = {k1, -0.1 * k1, 1e-3, -5e-4, 0, 0, 0, 0};
    scene::CameraPose pose;
    pose.translation = shift;
    return {"test", lens, pose};
}

// A sphere of triangles: those of an octahedron, split `levels` times. Each rank has a part.
Mesh sphere(const Comm& comm, const Vec3& at, double radius, int levels) {
    Mesh mesh;
    std::vector<Vec3> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    std::vector<std::array<int, 3>> triangles;
    for (int x = 0; x < 2; ++x) {
        for (int y = 2; y < 4; ++y) {
            for (int z = 4; z < 6; ++z) {
                const bool even = (x + y + z) % 2 == 0;
                triangles.push_back(even ? std::array{x, y, z} : std::array{y, x, z});
            }
        }
    }
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<int, int>, int> middles;
        std::vector<std::array<int, 3>> finer;
        const auto middle = [&](int a, int b) {
            const std::pair key(std::min(a, b), std::max(a, b));
            if (const auto known = middles.find(key); known != middles.end()) return known->second;
            Vec3 m;
            double length = 0;
            for (std::size_t k = 0; k < 3; ++k)
                length +=
                    std::pow(m[k] = points[static_cast<std::size_t>(a)][k] + points[static_cast<std::size_t>(b)][k], 2);
            for (double& c : m) c /= std::sqrt(length);
            points.push_back(m);
            return middles[key] = static_cast<int>(points.size()) - 1;
        };
        for (const auto& [a, b, c] : triangles) {
            const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        triangles = finer;
    }
    for (const auto& p : points) {
        for (std::size_t k = 0; k < 3; ++k) mesh.vertices.push_back(at[k] + radius * p[k]);
        mesh.global.push_back(static_cast<std::int64_t>(mesh.global.size()));
        mesh.velocity.insert(mesh.velocity.end(), {1, 0, 0});
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (static_cast<int>(t) % comm.size() == comm.rank()) mesh.triangles.push_back(triangles[t]);
    }
    return mesh;
}

// Area [pixels] of a sphere's outline: the cone of rays that touch it, through the lens, as a polygon of many corners.
double outline_area(const scene::CameraModel& camera, const Vec3& at, double radius) {
    const double distance = std::sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
    const double angle = std::asin(radius / distance);
    const Vec3 axis{at[0] / distance, at[1] / distance, at[2] / distance};
    Vec3 u{axis[2], 0, -axis[0]};
    const double length = std::hypot(u[0], u[2]);
    for (double& c : u) c /= length;
    const Vec3 v{axis[1] * u[2] - axis[2] * u[1], axis[2] * u[0] - axis[0] * u[2], axis[0] * u[1] - axis[1] * u[0]};
    const int n = 20000;
    double sum = 0, lastx = 0, lasty = 0;
    for (int k = 0; k <= n; ++k) {
        const double phi = 2 * math::pi * k / n;
        Vec3 ray;
        for (std::size_t c = 0; c < 3; ++c)
            ray[c] = std::cos(angle) * axis[c] + std::sin(angle) * (std::cos(phi) * u[c] + std::sin(phi) * v[c]);
        const auto pixel = camera.project_camera(ray);
        if (k > 0) sum += lastx * pixel.y - lasty * pixel.x;
        lastx = pixel.x;
        lasty = pixel.y;
    }
    return std::abs(sum) / 2;
}

TEST(Silhouette, OfASphereHasTheAreaOfItsOutline) {
    double worst = 0;
    for (const double k1 : {0.0, -0.15}) {
        for (const Vec3& at : {Vec3{0.02, 0.01, 2}, Vec3{-0.62, -0.42, 2}}) { // the second one in a corner
            const auto seen = camera(k1);
            const auto drawn = draw_silhouette(Comm::world(), sphere(Comm::world(), at, 0.25, 6), seen);
            const double exact = outline_area(seen, at, 0.25);
            worst = std::max(worst, std::abs(static_cast<double>(drawn.count()) / exact - 1));
            EXPECT_NEAR(static_cast<double>(drawn.count()) / exact, 1, 0.002) << k1 << " " << at[0];
        }
    }
    RecordProperty("area_error_percent", std::to_string(100 * worst));
}

TEST(Silhouette, IsTheSameBitsOnAnyNumberOfRanks) {
    const auto seen = camera(-0.15);
    const auto ours =
        draw_silhouette(Comm::world(), sphere(Comm::world(), {0.1, 0.2, 1.5}, 0.3, 4), seen, {0.01, 1e-5});
    const auto alone = draw_silhouette(Comm::self(), sphere(Comm::self(), {0.1, 0.2, 1.5}, 0.3, 4), seen, {0.01, 1e-5});
    EXPECT_EQ(mismatches(ours, alone), 0);
    EXPECT_EQ(ours.depth, alone.depth);
    const auto a =
        outline_distance(Comm::world(), sphere(Comm::world(), {0.1, 0.2, 1.5}, 0.3, 4), seen, ours, {0.01, 1e-5});
    const auto b =
        outline_distance(Comm::self(), sphere(Comm::self(), {0.1, 0.2, 1.5}, 0.3, 4), seen, alone, {0.01, 1e-5});
    EXPECT_EQ(a, b);
}

Mesh square(const Vec3& low, const Vec3& high) {
    Mesh mesh;
    mesh.vertices = {
        low[0], low[1], low[2], high[0], low[1], low[2], high[0], high[1], high[2], low[0], high[1], high[2]};
    mesh.velocity.assign(12, 0);
    mesh.global = {0, 1, 2, 3};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

// Corners on pixel centres: rows and columns of the top and left edges count, those of the bottom and right do not; the
// diagonal counts once.
TEST(Silhouette, CountsPixelCentresOnTopAndLeftEdgesOnly) {
    scene::Lens lens;
    lens.width = 32;
    lens.height = 24;
    lens.fx = lens.fy = 10;
    const scene::CameraModel seen("pixels", lens, {});
    const auto drawn = draw_silhouette(Comm::self(), square({0.5, 0.3, 1}, {1.7, 1.5, 1}), seen);
    EXPECT_EQ(drawn.count(), 12 * 12);
    EXPECT_EQ(drawn.mask[3 * 32 + 5], 1);
    EXPECT_EQ(drawn.mask[15 * 32 + 5], 0);
    EXPECT_EQ(drawn.mask[3 * 32 + 17], 0);
    auto moved = square({0.5, 0.3, 1}, {1.7, 1.5, 1});
    for (std::size_t v = 0; v < 4; ++v) moved.velocity[3 * v] = 10; // [m/s]: 1 pixel in 10 ms
    EXPECT_EQ(mismatches(drawn, draw_silhouette(Comm::self(), moved, seen, {0.01, 0})), 2 * 12);
}

TEST(Silhouette, EndsAtTheNearPlaneAndBehindSolids) {
    scene::Lens lens;
    lens.width = 32;
    lens.height = 24;
    lens.fx = lens.fy = 10;
    lens.cx = 16;
    lens.cy = 4;
    const scene::CameraModel seen("near", lens, {});
    // A floor from behind the camera to far in front of it covers what is below the horizon.
    Mesh floor = square({-1000, 1, -5}, {1000, 1, 1000});
    const auto drawn = draw_silhouette(Comm::self(), floor, seen);
    EXPECT_EQ(drawn.count(), 32 * (24 - 5));
    HidingTriangles plate{{-1000, -1000, 2, 1000, -1000, 2, 0, 1000, 2}, {{0, 1, 2}}};
    // Depth 2 on the floor is 10 * 1 / 2 rows below the horizon.
    const auto hidden = draw_silhouette(Comm::self(), floor, seen, {}, &plate);
    EXPECT_EQ(hidden.count(), 32 * (24 - 4 - 5));
}

TEST(Silhouette, OutlineDistanceMovesSmoothly) {
    const auto seen = camera(-0.1);
    const Vec3 at{0.1, -0.05, 2};
    const double radius = 0.25;
    double last = 0;
    for (const double shift : {0.0, 0.0004, 0.0008}) { // [m]: an eighth of a pixel, a quarter
        auto mesh = sphere(Comm::world(), {at[0] + shift, at[1], at[2]}, radius, 6);
        const auto drawn = draw_silhouette(Comm::world(), mesh, seen);
        const auto distance = outline_distance(Comm::world(), mesh, seen, drawn);
        // Left of the sphere's middle, the pixel next to its outline.
        const auto middle = seen.project(at);
        const auto row = static_cast<std::size_t>(std::lround(middle.y));
        std::size_t column = static_cast<std::size_t>(std::lround(middle.x)) - 80;
        while (distance[row * 640 + column] < -1.5) ++column;
        const double there = distance[row * 640 + column] - static_cast<double>(column);
        if (shift > 0) {
            EXPECT_NEAR(there - last, -0.0004 * 600 / 2, 0.03);
        }
        last = there;
    }
}

} // namespace
} // namespace treacle::surface::silhouette_test
