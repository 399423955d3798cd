#include "base/text/error.hpp"
#include "scene/camera/camera_model.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

using namespace treacle;
using namespace treacle::scene;

namespace {
// A wide phone lens: barrel distortion of 60 pixels in the corners.
Lens wide_lens() { return {1280, 720, 900, 905, 645, 352, {-0.18, 0.05, 0.001, -0.0008, -0.006, 0, 0, 0}}; }

Lens rational_lens() { return {1920, 1080, 1400, 1400, 950, 545, {0.5, -0.1, 0.0005, 0.0003, 0.02, 0.7, -0.05, 0.03}}; }

CameraPose some_pose() { return {rotation_matrix({0.4, -0.8, 1.1}), {0.02, -0.03, 0.6}}; }

double distance(const Vec2& a, const Vec2& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }
} // namespace

TEST(CameraModel, CentreOfTheTopLeftPixelIsZero) {
    const CameraModel camera("c", {640, 480, 500, 500, 319.5, 239.5, {}}, {});
    const auto centre = camera.project({0, 0, 2});
    EXPECT_DOUBLE_EQ(centre.x, 319.5); // the middle of columns 0 to 639
    EXPECT_DOUBLE_EQ(centre.y, 239.5);
    EXPECT_DOUBLE_EQ(centre.depth, 2);
    EXPECT_DOUBLE_EQ(camera.project({0.1, 0, 1}).x, 369.5); // x runs to the right
    EXPECT_DOUBLE_EQ(camera.project({0, 0.1, 1}).y, 289.5); // y runs down
}

// Values of cv::projectPoints (OpenCV 4.6); tests/unit/video compares many more.
TEST(CameraModel, ProjectsAsOpenCv) {
    const CameraModel camera("c", wide_lens(), some_pose());
    const auto p = camera.project({0.1, -0.05, 0.2});
    EXPECT_NEAR(p.x, 658.95635186, 1e-7);
    EXPECT_NEAR(p.y, 221.06335862, 1e-7);
}

TEST(CameraModel, UndistortInvertsDistortOverThePicture) {
    for (const Lens& lens : {wide_lens(), rational_lens()}) {
        const CameraModel camera("c", lens, some_pose());
        for (int i = 0; i <= 20; ++i)
            for (int j = 0; j <= 20; ++j) {
                const Vec2 pixel{-0.5 + lens.width * i / 20.0, -0.5 + lens.height * j / 20.0};
                const auto back = camera.project(camera.unproject(pixel, 1.7));
                EXPECT_LT(distance({back.x, back.y}, pixel), 1e-9);
                EXPECT_NEAR(back.depth, 1.7, 1e-12);
            }
    }
}

TEST(CameraModel, DistortionNeverFoldsBack) {
    const CameraModel camera("c", wide_lens(), {});
    EXPECT_GT(camera.max_radius(), 2.0); // 1 + 3 k1 r^2 + 5 k2 r^4 + 7 k3 r^6 falls to 0 at 2.06
    EXPECT_LT(camera.max_radius(), 2.06);
    double last = -1;
    for (double r = 0; r < 20; r += 0.01) {
        const double here = camera.distort({r * 0.6, r * 0.8})[1];
        EXPECT_GT(here, last);
        last = here;
    }
    const Vec2 outside{6, -9};
    EXPECT_LT(distance(camera.undistort(camera.distort(outside)), outside), 1e-9);
}

TEST(CameraModel, UndistortedLensSeesEverythingInFront) {
    const CameraModel camera("c", {640, 480, 500, 500, 320, 240, {}}, {});
    EXPECT_GT(camera.max_radius(), 50);
    EXPECT_LT(camera.project({1, 1, -1}).depth, CameraModel::near_plane);
}

TEST(CameraModel, RotationVectorsGoBothWays) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 200; ++k) {
        Vec3 v{normal(random), normal(random), normal(random)};
        const double l = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        const double angle = k % 4 == 0 ? std::numbers::pi - 1e-9 * k : k % 4 == 1 ? 1e-9 : 3.1 * k / 200;
        for (double& x : v) x *= angle / l;
        const Vec3 back = rotation_vector(rotation_matrix(v));
        for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(back[i], v[i], 2e-8);
    }
}

TEST(CameraModel, MovedWorldKeepsThePicture) {
    const CameraModel camera("c", wide_lens(), some_pose());
    const Matrix3 turn = rotation_matrix({0.3, 0.2, -0.5});
    const Vec3 shift{0.4, -0.1, 0.2}, point{0.03, 0.05, -0.02};
    Vec3 old = apply(turn, point);
    for (std::size_t i = 0; i < 3; ++i) old[i] += shift[i];
    const CameraModel moved("c", wide_lens(), in_moved_world(some_pose(), turn, shift));
    EXPECT_NEAR(moved.project(point).x, camera.project(old).x, 1e-9);
    EXPECT_NEAR(moved.project(point).y, camera.project(old).y, 1e-9);
}

TEST(CameraModel, ResizedPicturesShowTheSame) {
    const CameraModel camera("c", wide_lens(), some_pose());
    const CameraModel half("c", resized(wide_lens(), 640, 360), some_pose());
    const auto a = camera.project({0.1, -0.05, 0.2}), b = half.project({0.1, -0.05, 0.2});
    EXPECT_NEAR((a.x + pixel_corner_offset) / 2, b.x + pixel_corner_offset, 1e-9);
    EXPECT_NEAR((a.y + pixel_corner_offset) / 2, b.y + pixel_corner_offset, 1e-9);
}

TEST(CameraModel, RefusesPicturesOfAnotherShape) {
    try {
        resized(wide_lens(), 720, 1280);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("turned by a quarter"), std::string::npos) << error.what();
    }
    EXPECT_THROW(resized(wide_lens(), 1280, 800), InputError);
}

TEST(CameraModel, RefusesWhatIsNoCamera) {
    Lens lens = wide_lens();
    lens.fx = 0;
    EXPECT_THROW(CameraModel("c", lens, {}), InputError);
    lens = wide_lens();
    lens.width = 0;
    EXPECT_THROW(CameraModel("c", lens, {}), InputError);
    lens = wide_lens();
    lens.distortion[0] = -0.9; // folds within the picture
    EXPECT_THROW(CameraModel("c", lens, {}), InputError);
    CameraPose mirrored;
    mirrored.rotation[2] = {0, 0, -1};
    EXPECT_THROW(CameraModel("c", wide_lens(), mirrored), InputError);
}
