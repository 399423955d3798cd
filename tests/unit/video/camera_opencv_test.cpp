#include "scene/camera/camera_model.hpp"

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <random>

using namespace treacle;
using namespace treacle::scene;

// Random lenses of 4, 5 and 8 coefficients in random poses.
TEST(CameraModel, ProjectsAsOpenCvDoes) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> u(-1, 1);
    for (int k = 0; k < 60; ++k) {
        Lens lens{
            1280, 720, 1000 + 300 * u(random), 1000 + 300 * u(random), 640 + 30 * u(random), 360 + 30 * u(random), {}};
        lens.distortion = {0.1 * u(random), 0.02 * u(random), 0.003 * u(random), 0.003 * u(random),
            k % 3 > 0 ? 0.01 * u(random) : 0.0};
        if (k % 3 == 2)
            for (std::size_t i = 5; i < 8; ++i) lens.distortion[i] = 0.02 * u(random);
        const Vec3 turn{u(random), u(random), u(random)}, shift{0.1 * u(random), 0.1 * u(random), 1 + 0.3 * u(random)};
        const CameraModel camera("c", lens, {rotation_matrix(turn), shift});
        std::vector<cv::Point3d> points;
        for (int i = 0; i < 30; ++i) points.emplace_back(0.3 * u(random), 0.3 * u(random), 0.3 * u(random));
        const cv::Mat matrix = (cv::Mat_<double>(3, 3) << lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1);
        const std::vector<double> coefficients(lens.distortion.begin(), lens.distortion.end());
        std::vector<cv::Point2d> seen;
        cv::projectPoints(points, cv::Vec3d(turn[0], turn[1], turn[2]), cv::Vec3d(shift[0], shift[1], shift[2]), matrix,
            coefficients, seen);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto p = camera.project({points[i].x, points[i].y, points[i].z});
            EXPECT_NEAR(p.x, seen[i].x, 1e-8);
            EXPECT_NEAR(p.y, seen[i].y, 1e-8);
        }
    }
}

TEST(CameraModel, GoldenValuesOfTheSceneTest) {
    const cv::Mat matrix = (cv::Mat_<double>(3, 3) << 900, 0, 645, 0, 905, 352, 0, 0, 1);
    std::vector<cv::Point2d> seen;
    cv::projectPoints(std::vector<cv::Point3d>{{0.1, -0.05, 0.2}}, cv::Vec3d(0.4, -0.8, 1.1),
        cv::Vec3d(0.02, -0.03, 0.6), matrix, std::vector<double>{-0.18, 0.05, 0.001, -0.0008, -0.006, 0, 0, 0}, seen);
    EXPECT_NEAR(seen[0].x, 658.95635186, 1e-7) << cv::format("%.8f %.8f", seen[0].x, seen[0].y);
    EXPECT_NEAR(seen[0].y, 221.06335862, 1e-7);
}
