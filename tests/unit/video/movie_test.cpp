#include "../own_folder.hpp"
#include "base/text/error.hpp"
#include "video/clip/movie.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

using namespace treacle;
using namespace treacle::video;
namespace fs = std::filesystem;

namespace {
class MovieFiles : public testing::Test {
protected:
    std::size_t count_files() const {
        return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator{}));
    }

    const test::OwnFolder own;
    const fs::path& folder = own.path();
};

Image picture(int width, int height, int shade) {
    Image image{width, height, {}};
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
            for (const int value : {shade, 2 * column, 2 * row}) image.pixels.push_back(std::uint8_t(value));
    return image;
}

std::string content(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

MovieOptions small(double rate = 25) {
    MovieOptions options;
    options.frames_per_second = rate;
    options.width = 96;
    options.height = 64;
    return options;
}

fs::path write_movie(const fs::path& path, const MovieOptions& options, int frames) {
    MovieWriter writer(path, options);
    for (int k = 0; k < frames; ++k) writer.add(picture(96, 64, 20 * k));
    return writer.finish();
}
} // namespace

TEST_F(MovieFiles, PngHoldsExactlyThePicture) {
    const auto image = picture(31, 17, 200);
    write_png(folder / "a.png", image);
    const cv::Mat back = cv::imread((folder / "a.png").string());
    ASSERT_EQ(back.cols, 31);
    ASSERT_EQ(back.rows, 17);
    for (int row = 0; row < 17; ++row)
        for (int column = 0; column < 31; ++column)
            for (int k = 0; k < 3; ++k) ASSERT_EQ(back.at<cv::Vec3b>(row, column)[2 - k], image.at(column, row)[k]);
    EXPECT_EQ(count_files(), 1u); // nothing temporary is left
}

TEST_F(MovieFiles, PngIsTheSameByteForByte) {
    write_png(folder / "a.png", picture(64, 48, 90));
    write_png(folder / "b.png", picture(64, 48, 90));
    EXPECT_EQ(content(folder / "a.png"), content(folder / "b.png"));
}

TEST_F(MovieFiles, PngWithoutItsFolderIsAnError) {
    EXPECT_THROW(write_png(folder / "missing" / "a.png", picture(8, 8, 0)), SimulationError);
    Image broken = picture(8, 8, 0);
    broken.pixels.pop_back();
    EXPECT_THROW(write_png(folder / "a.png", broken), InputError);
    EXPECT_EQ(count_files(), 0u);
}

TEST_F(MovieFiles, MovieHasItsFramesRateAndColours) {
    const auto path = write_movie(folder / "run.mp4", small(25), 12);
    EXPECT_EQ(path, folder / "run.mp4");
    cv::VideoCapture back(path.string());
    ASSERT_TRUE(back.isOpened());
    EXPECT_NEAR(back.get(cv::CAP_PROP_FPS), 25, 1e-6);
    int frames = 0;
    for (cv::Mat frame; back.read(frame); ++frames) {
        ASSERT_EQ(frame.size(), cv::Size(96, 64));
        // 4:2:0 codecs lose about 3 grey levels on average; four times that for one smooth spot.
        const auto centre = frame.at<cv::Vec3b>(32, 48);
        EXPECT_NEAR(centre[2], 20 * frames, 12);
        EXPECT_NEAR(centre[1], 96, 12);
        EXPECT_NEAR(centre[0], 64, 12);
    }
    EXPECT_EQ(frames, 12);
    EXPECT_EQ(count_files(), 1u);
}

TEST_F(MovieFiles, FirstCodecNeedsNoMessage) {
    MovieWriter writer(folder / "run.mp4", small());
    EXPECT_EQ(writer.codec(), Codec::h264);
    EXPECT_EQ(writer.message(), "");
}

TEST_F(MovieFiles, EveryCodecWritesWhatItIsGiven) {
    for (const auto codec : {Codec::h264, Codec::mpeg4, Codec::motion_jpeg}) {
        auto options = small();
        options.codecs = {codec};
        const auto path = write_movie(folder / "run.mp4", options, 5);
        EXPECT_EQ(path.extension(), codec == Codec::motion_jpeg ? ".avi" : ".mp4");
        cv::VideoCapture back(path.string());
        int frames = 0;
        for (cv::Mat frame; back.read(frame);) ++frames;
        EXPECT_EQ(frames, 5);
    }
}

TEST_F(MovieFiles, CodecThatFailsGivesWayToTheNextWithAMessage) {
    auto options = small(100000); // MPEG-4 counts time in at most 65535 parts of a second
    options.codecs = {Codec::mpeg4, Codec::motion_jpeg};
    MovieWriter writer(folder / "run.mp4", options);
    EXPECT_EQ(writer.codec(), Codec::motion_jpeg);
    EXPECT_NE(writer.message().find("MPEG-4"), std::string::npos) << writer.message();
    writer.add(picture(96, 64, 0));
    EXPECT_EQ(writer.finish(), folder / "run.avi");
    EXPECT_EQ(count_files(), 1u);
}

TEST_F(MovieFiles, WithoutAnyCodecThereIsAnErrorAndNoFile) {
    auto options = small();
    options.codecs = {};
    EXPECT_THROW(MovieWriter(folder / "run.mp4", options), SimulationError);
    EXPECT_EQ(count_files(), 0u);
}

TEST_F(MovieFiles, FolderThatCannotBeWrittenIsNamed) {
    try {
        MovieWriter writer(folder / "missing" / "run.mp4", small());
        FAIL() << "opened";
    } catch (const SimulationError& error) {
        EXPECT_NE(std::string(error.what()).find((folder / "missing").string()), std::string::npos);
    }
}

TEST_F(MovieFiles, UnfinishedMovieLeavesTheOldOne) {
    std::ofstream(folder / "run.mp4") << "old";
    {
        MovieWriter writer(folder / "run.mp4", small());
        writer.add(picture(96, 64, 0));
    }
    EXPECT_EQ(content(folder / "run.mp4"), "old");
    EXPECT_EQ(count_files(), 1u);
}

TEST_F(MovieFiles, MovieWithoutFramesIsAnError) {
    MovieWriter writer(folder / "run.mp4", small());
    EXPECT_THROW(writer.finish(), SimulationError);
}

TEST_F(MovieFiles, BadRatesAndSizesAreRefused) {
    EXPECT_THROW(MovieWriter(folder / "run.mp4", small(0)), InputError);
    EXPECT_THROW(MovieWriter(folder / "run.mp4", small(std::nan(""))), InputError);
    auto odd = small();
    odd.width = 95;
    EXPECT_THROW(MovieWriter(folder / "run.mp4", odd), InputError);
    MovieWriter writer(folder / "run.mp4", small());
    EXPECT_THROW(writer.add(picture(64, 64, 0)), InputError);
}
