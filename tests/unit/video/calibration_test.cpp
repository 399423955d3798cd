#include "../refusal.hpp"
#include "base/text/error.hpp"
#include "shared_data.hpp"
#include "video/camera/board_pictures.hpp"
#include "video/camera/calibration_covariance.hpp"
#include "video/camera/circle_bias.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

using namespace treacle;
using namespace treacle::scene;
using namespace treacle::video;

namespace {
using test::refusal;

Lens true_lens() { return {1280, 720, 1100, 1105, 645, 355, {-0.12, 0.06, 0.0005, -0.0007, -0.01, 0, 0, 0}}; }

Board small_board() {
    Board board;
    board.spacing = 0.025;
    return board;
}

// Pictures of the board by an exact camera, points off by noise, and by an error that those of a picture share.
std::vector<BoardPicture> pictures(std::size_t count, double noise, unsigned seed, double shared = 0) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> u(-1, 1);
    const auto points = board_points(small_board());
    std::vector<BoardPicture> out;
    while (out.size() < count) {
        const Matrix3 turn = rotation_matrix({0.7 * u(random), 0.7 * u(random), 0.4 * u(random)});
        const Vec3 middle = apply(turn, {0.1, 0.0625, 0});
        const double depth = 0.3 + 0.1 * u(random);
        const CameraPose pose{
            turn, {0.5 * depth * u(random) - middle[0], 0.28 * depth * u(random) - middle[1], depth - middle[2]}};
        const CameraModel camera("", true_lens(), pose);
        BoardPicture picture;
        picture.name = "picture" + std::to_string(out.size());
        picture.state = PictureState::used;
        picture.width = 1280;
        picture.height = 720;
        const double bow = shared * normal(random);
        bool inside = true;
        for (const auto& p : points) {
            const auto seen = camera.project({p[0], p[1], bow * (p[0] * p[0] + p[1] * p[1])});
            inside = inside && seen.x > 5 && seen.y > 5 && seen.x < 1274 && seen.y < 714;
            picture.view.points.push_back({seen.x + noise * normal(random), seen.y + noise * normal(random)});
        }
        if (inside) out.push_back(picture);
    }
    return out;
}

} // namespace

TEST(Calibration, ExactPointsGiveTheExactLens) {
    const auto result = calibrate(small_board(), {}, pictures(10, 0, 1));
    EXPECT_NEAR(result.lens.fx, 1100, 0.01);
    EXPECT_NEAR(result.lens.cy, 355, 0.01);
    EXPECT_NEAR(result.lens.distortion[0], -0.12, 1e-4);
    EXPECT_LT(result.rms, 1e-3); // OpenCV takes points in single precision
}

// The image of a circle through a pinhole is a conic whose middle follows from its matrix: Q* = P C* P^T, and the middle is
// its pole of the line at infinity.
TEST(Circles, MiddleOfTheImageIsThatOfItsEllipse) {
    const Lens lens{1280, 720, 1100, 1105, 645, 355, {}};
    const CameraPose pose{rotation_matrix({0.6, -0.5, 0.2}), {-0.05, 0.02, 0.3}};
    const CameraModel camera("", lens, pose);
    const double radius = 0.009;
    const Vec3 centre{0.06, 0.03, 0};
    const auto bias = circle_bias(camera, {centre}, 2 * radius);
    // The dual conic of the circle is diag(r^2, r^2, -1) about its centre; columns of P for points (x, y, 1) of the board.
    std::array<Vec3, 3> columns;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto& r = pose.rotation;
        const Vec3 axis = k < 2 ? Vec3{r[0][k], r[1][k], r[2][k]} : camera.to_camera(centre);
        columns[k] = {lens.fx * axis[0] + lens.cx * axis[2], lens.fy * axis[1] + lens.cy * axis[2], axis[2]};
    }
    const auto dual = [&](std::size_t i, std::size_t j) {
        return radius * radius * (columns[0][i] * columns[0][j] + columns[1][i] * columns[1][j]) -
               columns[2][i] * columns[2][j];
    };
    const auto middle = camera.project(centre);
    EXPECT_NEAR(bias[0][0], dual(0, 2) / dual(2, 2) - middle.x, 1e-3);
    EXPECT_NEAR(bias[0][1], dual(1, 2) / dual(2, 2) - middle.y, 1e-3);
    EXPECT_GT(std::hypot(bias[0][0], bias[0][1]), 0.2);
}

// Middles of circles' images as points: the lens is found all the same, and without the circles' size it is not.
TEST(Circles, GiveTheExactLens) {
    auto board = read_board("circles:4x11");
    board.spacing = 0.012;
    const auto centres = board_points(board);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> u(-1, 1);
    std::vector<BoardPicture> list;
    while (list.size() < 10) {
        const Matrix3 turn = rotation_matrix({0.7 * u(random), 0.7 * u(random), 0.4 * u(random)});
        const Vec3 middle = apply(turn, {0.04, 0.06, 0});
        const double depth = 0.28 + 0.05 * u(random);
        const CameraModel camera(
            "", true_lens(), {turn, {0.05 * u(random) - middle[0], 0.02 * u(random) - middle[1], depth - middle[2]}});
        const auto bias = circle_bias(camera, centres, 0.014);
        BoardPicture picture;
        picture.name = "picture";
        picture.state = PictureState::used;
        picture.width = 1280;
        picture.height = 720;
        picture.view.diameter = 0.014;
        for (std::size_t i = 0; i < centres.size(); ++i) {
            const auto seen = camera.project(centres[i]);
            picture.view.points.push_back({seen.x + bias[i][0], seen.y + bias[i][1]});
        }
        list.push_back(picture);
    }
    const auto result = calibrate(board, {}, list);
    EXPECT_NEAR(result.lens.fx, 1100, 0.05);
    EXPECT_LT(result.rms, 2e-3);
    for (auto& picture : list) picture.view.diameter = 0;
    const auto biased = calibrate(board, {}, list);
    EXPECT_GT(std::abs(biased.lens.fx - 1100) + 100 * biased.rms, 0.5);
}

TEST(Calibration, BadPictureIsLeftOutAndNamed) {
    auto list = pictures(12, 0.1, 2);
    for (std::size_t i = 0; i < 12; ++i) list[7].view.points[i][0] += 4;
    const auto result = calibrate(small_board(), {}, list);
    EXPECT_EQ(result.count(PictureState::outlier), 1u);
    EXPECT_EQ(result.pictures[7].state, PictureState::outlier);
    EXPECT_NE(result.pictures[7].reason.find("times the median"), std::string::npos);
    EXPECT_LT(result.rms, 0.16);
    EXPECT_GT(result.pictures[7].rms, 1);
}

// Errors over standard deviations, their root mean square over parameters and repeats: 1 where these are right.
double mean_square_score(double noise, double shared, bool jackknife) {
    constexpr int repeats = 12;
    double sum = 0;
    int count = 0;
    for (unsigned seed = 0; seed < repeats; ++seed) {
        CalibrationOptions options;
        options.outlier_factor = 1e9;
        const auto result = calibrate(small_board(), options, pictures(14, noise, 100 + seed, shared));
        const auto covariance = jackknife ? result.covariance : independent_covariance(result);
        const Lens truth = true_lens();
        const std::array<double, 9> errors{result.lens.fx - truth.fx, result.lens.fy - truth.fy,
            result.lens.cx - truth.cx, result.lens.cy - truth.cy, result.lens.distortion[0] - truth.distortion[0],
            result.lens.distortion[1] - truth.distortion[1], result.lens.distortion[2] - truth.distortion[2],
            result.lens.distortion[3] - truth.distortion[3], result.lens.distortion[4] - truth.distortion[4]};
        for (std::size_t i = 0; i < errors.size(); ++i, ++count)
            sum += std::pow(errors[i] / covariance.deviation(i), 2);
    }
    return std::sqrt(sum / count);
}

// 108 scores: their root mean square is known to some 10 %, of correlated parameters to 20 %.
TEST(Calibration, DeviationsOfIndependentErrorsAreHonest) {
    EXPECT_NEAR(mean_square_score(0.15, 0, false), 1, 0.25);
    const double score = mean_square_score(0.15, 0, true);
    EXPECT_LT(score, 1.1);
    EXPECT_GT(score, 0.6);
}

// Boards that are bent by another bow in each picture (0.2 mm over 10 cm): errors that the points of a picture share.
TEST(Calibration, DeviationsOfSharedErrorsAreHonest) {
    EXPECT_GT(mean_square_score(0.05, 0.02, false), 1.5); // independent ones are too small
    const double score = mean_square_score(0.05, 0.02, true);
    EXPECT_LT(score, 1.25);
    EXPECT_GT(score, 0.5);
}

TEST(Calibration, PicturesOfAnotherSizeAreNamed) {
    auto list = pictures(6, 0.1, 3);
    std::swap(list[2].width, list[2].height);
    const auto text = refusal([&] { (void)calibrate(small_board(), {}, list); });
    EXPECT_NE(text.find("picture2: has 720 x 1280 pixels, others have 1280 x 720"), std::string::npos) << text;
    EXPECT_NE(text.find("turned by a quarter"), std::string::npos);
}

TEST(Calibration, TooFewPicturesAreRefusedWithTheirReasons) {
    auto list = pictures(6, 0.1, 3);
    for (std::size_t i = 1; i < 5; ++i) {
        list[i].state = PictureState::no_board;
        list[i].reason = "no board was found";
    }
    const auto text = refusal([&] { (void)calibrate(small_board(), {}, list); });
    EXPECT_NE(text.find("found in 2 of 6 pictures"), std::string::npos) << text;
    EXPECT_NE(text.find("picture3: no board was found"), std::string::npos);
}

TEST(Boards, ThoseThatLookTheSameTurnedAreRefused) {
    for (const auto* text : {"9x6", "6x9", "8x5", "circles:4x11", "circles:4x9"})
        EXPECT_NO_THROW(check_board(read_board(text))) << text;
    for (const auto* text : {"8x6", "9x7", "circles:4x10", "symmetric:7x6"}) {
        const auto refused = refusal([&] { check_board(read_board(text)); });
        EXPECT_NE(refused.find("looks the same turned by 180 degrees"), std::string::npos) << text;
    }
    for (const auto* text : {"9", "9x", "1x6", "9x6x2", "x"}) EXPECT_THROW(read_board(text), InputError) << text;
}

class RealPictures : public testing::Test {
protected:
    void SetUp() override {
        folder_ = test::shared_data("calibration");
        if (folder_.empty()) GTEST_SKIP() << "no ../shared/data/calibration";
    }
    std::vector<BoardPicture> look(const std::string& board, int window) {
        BoardPicturesOptions options;
        options.search.window = window;
        auto given = read_board(board);
        given.spacing = 0.025;
        return find_boards(list_pictures({folder_}), given, options);
    }
    std::filesystem::path folder_;
};

// The reference: OpenCV's own calibration of the thirteen pictures with windows of 11 pixels.
TEST_F(RealPictures, GiveTheReferenceWithItsWindows) {
    const auto found = look("9x6", 11);
    CalibrationOptions all;
    all.outlier_factor = 1e9;
    const auto reference = calibrate(small_board(), all, found);
    EXPECT_NEAR(reference.lens.fx, 536.1, 0.3);
    EXPECT_NEAR(reference.lens.fy, 536.0, 0.3);
    EXPECT_NEAR(reference.lens.cx, 342.4, 0.3);
    EXPECT_NEAR(reference.lens.cy, 235.5, 0.3);
    EXPECT_NEAR(reference.rms, 0.41, 0.005);
    const auto cleaned = calibrate(small_board(), {}, found);
    EXPECT_EQ(cleaned.count(PictureState::outlier), 1u);
    EXPECT_EQ(cleaned.pictures[1].name, "left02.jpg");
    EXPECT_EQ(cleaned.pictures[1].state, PictureState::outlier);
    EXPECT_LE(cleaned.rms, 0.3);
}

// Windows within the squares: nothing reaches from one corner to the next, and no picture is an outlier.
TEST_F(RealPictures, HaveNoOutlierWithWindowsThatFitTheSquares) {
    const auto result = calibrate(small_board(), {}, look("9x6", 0));
    EXPECT_EQ(result.count(PictureState::used), 13u);
    for (const auto& picture : result.pictures) EXPECT_LT(picture.rms, 0.25) << picture.name;
    EXPECT_LT(result.rms, 0.19);
}

TEST_F(RealPictures, TellTheSizeOfTheBoard) {
    const auto squares = refusal([&] { (void)look("10x7", 0); });
    EXPECT_NE(squares.find("show a chessboard with 9 x 6 inner corners"), std::string::npos) << squares;
    EXPECT_NE(squares.find("not squares"), std::string::npos);
}
