#include "../own_folder.hpp"
#include "base/text/error.hpp"
#include "shared_data.hpp"
#include "video/camera/camera_file.hpp"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

using namespace treacle;
using namespace treacle::scene;
using namespace treacle::video;

namespace {

class CameraFile : public testing::Test {
protected:
    std::filesystem::path write(const std::string& name, const std::string& text) {
        const auto path = folder_.path() / name;
        std::filesystem::create_directories(path.parent_path());
        std::ofstream(path) << text;
        return path;
    }
    // The message with which a file is refused.
    std::string refusal(const std::filesystem::path& path, const std::string& camera = "") {
        try {
            (void)read_camera(path, camera).model();
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }

    test::OwnFolder folder_;
};

CameraRecord some_camera(const std::string& name) {
    CameraRecord camera;
    camera.name = name;
    camera.lens = {1280, 720, 900.25, 905.5, 645.125, 352.75, {-0.18, 0.05, 0.001, -0.0008, -0.006, 0.01, 0.02, 0.003}};
    camera.pose = CameraPose{rotation_matrix({0.4, -0.8, 1.1}), {0.02, -0.03, 0.6}};
    camera.rms = 0.123;
    camera.covariance.emplace();
    for (std::size_t i = 0; i < intrinsic_count; ++i) camera.covariance->at(i, i) = 0.01 * double(i + 1);
    camera.pose_covariance.emplace();
    (*camera.pose_covariance)[7] = 1e-6;
    return camera;
}

void expect_equal(const CameraRecord& a, const CameraRecord& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.lens, b.lens);
    EXPECT_EQ(a.rms, b.rms);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(a.pose->translation[i], b.pose->translation[i]);
        for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(a.pose->rotation[i][j], b.pose->rotation[i][j], 1e-15);
    }
    EXPECT_EQ(a.covariance->values, b.covariance->values);
    EXPECT_EQ(*a.pose_covariance, *b.pose_covariance);
}

constexpr const char* plain = R"(image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [438.783367, 0.000000, 305.593336, 0.000000, 437.302876, 243.738352, 0.000000, 0.000000, 1.000000]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.361976, 0.110510, 0.001014, 0.000505, 0.000000]
)";

} // namespace

TEST_F(CameraFile, ComesBackAsItWasWritten) {
    for (const auto* name : {"c.yaml", "c.yml", "c.json", "c.xml"}) {
        const auto path = folder_.path() / name;
        write_cameras(path, {some_camera("left")});
        expect_equal(read_camera(path, ""), some_camera("left"));
        EXPECT_EQ(read_camera(path, "left").name, "left");
    }
}

TEST_F(CameraFile, HoldsSeveralCameras) {
    for (const auto* name : {"c.yaml", "c.json"}) {
        const auto path = folder_.path() / name;
        write_cameras(path, {some_camera("left"), some_camera("right")});
        ASSERT_EQ(read_cameras(path).size(), 2u);
        expect_equal(read_camera(path, "right"), some_camera("right"));
        EXPECT_NE(refusal(path).find("there are left, right"), std::string::npos) << refusal(path);
        EXPECT_NE(refusal(path, "middle").find("no camera middle"), std::string::npos);
    }
}

TEST_F(CameraFile, ReadsPlainYamlAsRosWritesIt) {
    const auto camera = read_camera(write("ros.yaml", plain), "");
    EXPECT_EQ(camera.name, "narrow_stereo");
    EXPECT_DOUBLE_EQ(camera.lens.fy, 437.302876);
    EXPECT_DOUBLE_EQ(camera.lens.distortion[1], 0.110510);
    EXPECT_FALSE(camera.pose);
}

// Quaternion of a turn by -30 degrees about x, at 10 cm above and 20 cm in front.
TEST_F(CameraFile, ReadsOpenGlCamerasOfViRheometry) {
    const auto path = write("camera_params.xml", R"(<?xml version="1.0"?>
<setup3D>
<camera eyepos="0 10 20" quat="0.96592582628906829 -0.25881904510252074 0 0" window_size="960 540" fov="40"/>
</setup3D>)");
    const auto camera = read_camera(path, "").model();
    EXPECT_NEAR(camera.lens().fx, 270 / std::tan(20 * M_PI / 180), 1e-9);
    // The axis goes down by 30 degrees, and meets the middle of the picture.
    const double c = std::cos(M_PI / 6), s = std::sin(M_PI / 6);
    const auto middle = camera.project({0, 0.1 - 0.3 * s, 0.2 - 0.3 * c});
    EXPECT_NEAR(middle.x, 479.5, 1e-9);
    EXPECT_NEAR(middle.y, 269.5, 1e-9);
    EXPECT_NEAR(middle.depth, 0.3, 1e-12);
    EXPECT_GT(camera.project({0.01, 0, 0}).x, camera.project({0, 0, 0}).x); // x to the right
    EXPECT_LT(camera.project({0, 0.01, 0}).y, camera.project({0, 0, 0}).y); // y up
}

TEST_F(CameraFile, ReadsCamerasOfColmap) {
    write("model/cameras.txt", "# Camera list\n1 SIMPLE_RADIAL 640 480 500 320 240 -0.1\n2 OPENCV 800 600 700 710 "
                               "400.5 300.5 0.1 0.01 0.001 0.002\n");
    write("model/images.txt", "# Image list\n1 1 0 0 0 0.1 0.2 0.3 1 first frame.png\n1 2 3 4 5 6\n2 "
                              "0.70710678118654757 0.70710678118654757 0 0 0 0 1 2 second.png\n\n");
    const auto cameras = read_cameras(folder_.path() / "model");
    ASSERT_EQ(cameras.size(), 2u);
    EXPECT_EQ(cameras[0].name, "first frame.png");
    EXPECT_EQ(cameras[0].lens.cx, 319.5); // COLMAP counts from the corner of the first pixel
    EXPECT_EQ(cameras[0].lens.fy, 500);
    EXPECT_EQ(cameras[0].lens.distortion[0], -0.1);
    EXPECT_EQ(cameras[1].lens.fy, 710);
    EXPECT_EQ(cameras[1].lens.distortion[3], 0.002);
    // World to camera, a quarter turn about x: y goes to z.
    const auto seen = cameras[1].model().to_camera({0, 1, 0});
    EXPECT_NEAR(seen[2], 2, 1e-12);
    EXPECT_EQ(read_camera(folder_.path() / "model/cameras.txt", "second.png").lens.width, 800);
}

TEST_F(CameraFile, SaysWhatIsWrong) {
    const auto without = [&](const std::string& key) {
        std::string text = plain;
        const auto at = text.find(key);
        return write("bad.yaml", text.erase(at, text.find('\n', at) - at + 1));
    };
    EXPECT_NE(refusal(without("image_width")).find("image_width or image_height is missing"), std::string::npos);
    EXPECT_NE(refusal(write("no_pose.yaml", plain)).find("no_pose.yaml: the camera narrow_stereo has no pose"),
        std::string::npos)
        << refusal(write("no_pose.yaml", plain));
    EXPECT_NE(refusal(write("bad.yaml", "a: [1, 2")).find("is no camera file"), std::string::npos);
    EXPECT_NE(refusal(write("bad.yaml", "")).find("is empty"), std::string::npos);
    EXPECT_NE(refusal(folder_.path() / "none.yaml").find("no such camera file"), std::string::npos);
    std::string six = plain;
    six.replace(six.find("0.000505, 0.000000"), 18, "0.000505, 0.0, 1.0");
    EXPECT_NE(refusal(write("six.yaml", six)).find("6 numbers: must be 4, 5 or 8"), std::string::npos);
    std::string folding = plain;
    folding.replace(folding.find("-0.361976"), 9, "-1.9");
    EXPECT_NE(refusal(write("folding.yaml", folding)).find("folds the picture over"), std::string::npos);
    write("fish/cameras.txt", "1 OPENCV_FISHEYE 640 480 500 500 320 240 0 0 0 0\n");
    write("fish/images.txt", "");
    EXPECT_NE(refusal(folder_.path() / "fish").find("cameras.txt:1: camera model OPENCV_FISHEYE is not known"),
        std::string::npos);
    EXPECT_THROW(write_cameras(folder_.path() / "camera.txt", {some_camera("a")}), InputError);
}

TEST_F(CameraFile, PicturesOfAnotherSizeAreRefused) {
    const auto camera = some_camera("left");
    EXPECT_EQ(for_pictures(camera, 1280, 720, "clip.mp4").lens, camera.lens);
    try {
        (void)for_pictures(camera, 720, 1280, "clip.mp4");
        FAIL();
    } catch (const InputError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("clip.mp4: has 720 x 1280 pixels"), std::string::npos) << text;
        EXPECT_NE(text.find("turned by a quarter"), std::string::npos);
    }
}

TEST_F(CameraFile, ReadsTheRealCamerasOfViRheometry) {
    const auto data = test::shared_data("virheometry");
    if (data.empty()) GTEST_SKIP() << "no ../shared/data/virheometry";
    const auto camera = read_camera(data / "experiments/Lotion_7.0_7.0_2/camera_params.xml", "").model();
    const Vec3 eye = camera.pose().position();
    EXPECT_NEAR(eye[2], 0.2618270827, 1e-9);
    const auto corner = camera.project({0, 0, 0});
    EXPECT_GT(corner.depth, 0.2);
    EXPECT_GT(corner.x, 0);
    EXPECT_LT(corner.x, 960);
}
