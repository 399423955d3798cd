#include "../own_folder.hpp"
#include "../refusal.hpp"
#include "base/text/error.hpp"
#include "video/camera/board_pictures.hpp"
#include "video/clip/clip_writer.hpp"

#include <cmath>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

using namespace treacle;
using namespace treacle::video;
namespace fs = std::filesystem;

namespace {
using test::refusal;

constexpr int width = 640, height = 480;

// A board of `columns` x `rows` inner corners seen from `view`, its squares about `square` pixels wide.
cv::Mat board_picture(int view, int columns = 9, int rows = 6, double square = 38) {
    constexpr int pixels = 40; // of a square before it is warped
    cv::Mat flat((rows + 3) * pixels, (columns + 3) * pixels, CV_8U, cv::Scalar(230));
    for (int row = 0; row <= rows; ++row)
        for (int column = 0; column <= columns; ++column)
            if ((row + column) % 2 == 0)
                cv::rectangle(
                    flat, cv::Rect((column + 1) * pixels, (row + 1) * pixels, pixels, pixels), 30, cv::FILLED);
    const float w = float(flat.cols), h = float(flat.rows);
    const float s = float(square / pixels), lean = 30.0f * float(std::sin(1.7 * view)),
                x = 60 + 25.0f * float(view % 3), y = 40 + 18.0f * float(view % 4);
    const std::vector<cv::Point2f> from{{0, 0}, {w, 0}, {w, h}, {0, h}};
    const std::vector<cv::Point2f> to{
        {x, y + lean / 2}, {x + s * w, y}, {x + s * w - lean, y + s * h - lean / 2}, {x + lean, y + s * h}};
    cv::Mat out;
    cv::warpPerspective(
        flat, out, cv::getPerspectiveTransform(from, to), {width, height}, cv::INTER_AREA, cv::BORDER_CONSTANT, 120);
    cv::GaussianBlur(out, out, {0, 0}, 0.7);
    return out;
}

class Boards : public testing::Test {
protected:
    fs::path write(const std::string& name, const cv::Mat& picture) {
        cv::imwrite((folder_.path() / name).string(), picture);
        return folder_.path() / name;
    }
    std::vector<BoardPicture> look(const std::vector<fs::path>& paths, const std::string& text = "9x6") {
        auto board = read_board(text);
        board.spacing = 0.025;
        return find_boards(paths, board, {});
    }
    test::OwnFolder folder_;
};

} // namespace

TEST_F(Boards, CorruptAndBlurredPicturesAreNamedAndPassedOver) {
    std::vector<fs::path> paths;
    for (int k = 0; k < 4; ++k) paths.push_back(write("good" + std::to_string(k) + ".png", board_picture(k)));
    for (const auto* name : {"cut.png", "cut.jpg"}) {
        const auto path = write(name, board_picture(1));
        fs::resize_file(path, fs::file_size(path) / 2);
        paths.push_back(path);
    }
    std::ofstream(folder_.path() / "text.jpg") << "no picture";
    paths.push_back(folder_.path() / "text.jpg");
    cv::Mat blurred;
    cv::GaussianBlur(board_picture(2), blurred, {0, 0}, 6);
    paths.push_back(write("blurred.png", blurred));
    paths.push_back(write("empty.png", cv::Mat(height, width, CV_8U, cv::Scalar(90))));
    const auto found = look(paths);
    ASSERT_EQ(found.size(), 9u);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(found[i].state, PictureState::used) << found[i].name << found[i].reason;
    EXPECT_EQ(found[4].reason, "the file is cut off");
    EXPECT_EQ(found[5].reason, "the file is cut off");
    EXPECT_EQ(found[6].state, PictureState::unreadable);
    EXPECT_NE(found[7].state, PictureState::used) << found[7].view.edge_width << " of " << found[7].view.separation;
    EXPECT_EQ(found[8].state, PictureState::no_board);
}

TEST_F(Boards, FirstCornerLiesBesideABlackSquareWhicheverWayTheBoardIsHeld) {
    const cv::Mat upright = board_picture(0);
    cv::Mat turned;
    cv::rotate(upright, turned, cv::ROTATE_180);
    const auto a = look({write("a.png", upright)})[0].view, b = look({write("b.png", turned)})[0].view;
    ASSERT_EQ(a.points.size(), 54u);
    for (std::size_t i = 0; i < 54; ++i) {
        EXPECT_NEAR(b.points[i][0], width - 1 - a.points[i][0], 0.05);
        EXPECT_NEAR(b.points[i][1], height - 1 - a.points[i][1], 0.05);
    }
}

TEST_F(Boards, AnotherSizeIsTold) {
    std::vector<fs::path> paths;
    for (int k = 0; k < 4; ++k) paths.push_back(write("p" + std::to_string(k) + ".png", board_picture(k, 8, 5)));
    for (const auto* given : {"9x6", "10x5", "7x4", "6x5"}) {
        const auto text = refusal([&] { (void)look(paths, given); });
        EXPECT_NE(text.find("show a chessboard with 8 x 5 inner corners"), std::string::npos) << given << ": " << text;
    }
    EXPECT_EQ(refusal([&] { (void)look(paths, "8x5"); }), "");
    for (int k = 0; k < 4; ++k) (void)write("p" + std::to_string(k) + ".png", board_picture(k, 8, 6));
    const auto alike = refusal([&] { (void)look(paths, "9x6"); });
    EXPECT_NE(alike.find("this one looks the same turned by 180 degrees"), std::string::npos) << alike;
}

TEST_F(Boards, CentresOfCirclesAreFound) {
    cv::Mat picture(height, width, CV_8U, cv::Scalar(225));
    auto board = read_board("circles:4x11");
    board.spacing = 20;
    check_board(board);
    std::vector<cv::Point2d> centres;
    for (const auto& p : board_points(board)) centres.emplace_back(180 + 1.8 * p[1] + 0.1 * p[0], 90 + 1.7 * p[0]);
    for (const auto& c : centres)
        cv::circle(picture, cv::Point(int(16 * c.x), int(16 * c.y)), 16 * 9, 25, cv::FILLED, cv::LINE_AA, 4);
    cv::GaussianBlur(picture, picture, {0, 0}, 0.8);
    const auto found = look({write("circles.png", picture)}, "circles:4x11");
    ASSERT_EQ(found[0].state, PictureState::used) << found[0].reason;
    // The grid may be numbered from its other end.
    const auto& p = found[0].view.points;
    for (const auto& c : centres) {
        double least = 1e9;
        for (const auto& q : p) least = std::min(least, std::hypot(q[0] - c.x, q[1] - c.y));
        EXPECT_LT(least, 0.15);
    }
    // 20 units of the centres are 25 mm; OpenCV fills half a pixel more all round.
    EXPECT_NEAR(found[0].view.diameter, 0.025 / 20 * 19 / std::sqrt(1.7 * 1.8), 4e-4);
}

TEST_F(Boards, HeicIsRefusedWithACure) {
    std::ofstream file(folder_.path() / "IMG_0001.HEIC", std::ios::binary);
    const char head[] = "\0\0\0\x18"
                        "ftypheic\0\0\0\0mif1heic";
    file.write(head, sizeof head);
    file.close();
    const auto text = refusal([&] { (void)look({folder_.path() / "IMG_0001.HEIC"}); });
    EXPECT_NE(text.find("IMG_0001.HEIC: is a HEIC picture"), std::string::npos) << text;
    EXPECT_NE(text.find("convert it to JPEG"), std::string::npos);
}

// A clip that a phone held upright has stored lying: 20 frames, the board at four places.
TEST_F(Boards, VideoGivesAPictureForEachPlace) {
    ClipOptions options;
    options.width = width;
    options.height = height;
    options.turned = 90;
    const auto path = folder_.path() / "board.mp4";
    ClipWriter writer(path, options);
    for (int k = 0; k < 20; ++k) {
        cv::Mat rgb;
        cv::cvtColor(board_picture(k / 5), rgb, cv::COLOR_GRAY2RGB);
        writer.add({width, height, {rgb.datastart, rgb.dataend}}, k / 30.0);
    }
    writer.finish();
    const auto found = look({path});
    ASSERT_EQ(found.size(), 4u);
    for (const auto& picture : found) {
        EXPECT_EQ(picture.state, PictureState::used);
        EXPECT_EQ(picture.width, width);
        EXPECT_NE(picture.name.find("board.mp4 frame "), std::string::npos);
    }
    const auto still = look({write("still.png", board_picture(0))})[0].view;
    for (std::size_t i = 0; i < 54; ++i) EXPECT_NEAR(found[0].view.points[i][0], still.points[i][0], 0.3);
}
