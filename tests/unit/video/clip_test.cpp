#include "../own_folder.hpp"
#include "base/text/error.hpp"
#include "video/clip/clip_writer.hpp"
#include "video/clip/frame_source.hpp"
#include "video/clip/movie.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>

using namespace treacle;
using namespace treacle::video;
namespace fs = std::filesystem;

namespace {
class Clips : public testing::Test {
protected:
    const test::OwnFolder own;
    const fs::path& folder = own.path();
};

// A picture whose four corners differ, with a bright square that moves by `k`.
Image picture(int width, int height, int k) {
    Image image{width, height, std::vector<std::uint8_t>(std::size_t(3 * width * height))};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            auto* p = image.pixels.data() + 3 * (y * width + x);
            p[0] = std::uint8_t(255 * x / width);
            p[1] = std::uint8_t(255 * y / height);
            p[2] = std::uint8_t(x / 8 == 2 + k % 4 && y / 8 == 3 ? 250 : 20);
        }
    return image;
}

ClipOptions lossless(int width, int height) {
    ClipOptions options;
    options.width = width;
    options.height = height;
    options.codec = ClipCodec::h264_lossless;
    return options;
}

void write_clip(const fs::path& path, const ClipOptions& options, const std::vector<double>& stamps) {
    ClipWriter writer(path, options);
    for (std::size_t k = 0; k < stamps.size(); ++k)
        writer.add(picture(options.width, options.height, int(k)), stamps[k]);
    writer.finish();
}

std::vector<double> steady(int count, double rate, double first = 0) {
    std::vector<double> stamps;
    for (int k = 0; k < count; ++k) stamps.push_back(first + k / rate);
    return stamps;
}

SourceRequest of(const fs::path& clip) {
    SourceRequest request;
    request.clip = clip;
    return request;
}

std::vector<TimedFrame> read_all(FrameSource& source) {
    std::vector<TimedFrame> frames;
    for (TimedFrame frame; source.read(frame);) frames.push_back(frame);
    return frames;
}

std::string content(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

// a, b, c, d of the track header's matrix, in which (x, y) is shown at (a x + c y, b x + d y): ISO/IEC 14496-12, 6.2.2.
std::array<int, 4> matrix_in_header(const fs::path& path) {
    const auto bytes = content(path);
    const auto start = bytes.find("tkhd") + 4 + 40;
    const auto number = [&](std::size_t i) {
        std::uint32_t value = 0;
        for (std::size_t k = 0; k < 4; ++k) value = value << 8 | std::uint8_t(bytes[start + 4 * i + k]);
        return std::int32_t(value) / 65536;
    };
    return {number(0), number(1), number(3), number(4)};
}

std::string refusal(const SourceRequest& request) {
    try {
        const auto source = open_frames(request);
        read_all(*source);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

void expect_names(const std::string& message, const std::vector<std::string>& words) {
    for (const auto& word : words)
        EXPECT_NE(message.find(word), std::string::npos) << word << " is not in: " << message;
}
} // namespace

TEST_F(Clips, LosslessVideoGivesBackPixelsAndVariableStampsExactly) {
    const std::vector<double> stamps = {0.5, 0.533, 0.58, 0.59, 0.7, 0.741};
    write_clip(folder / "a.mp4", lossless(64, 48), stamps);
    const auto source = open_frames(of(folder / "a.mp4"));
    EXPECT_TRUE(source->info().variable_rate());
    const auto frames = read_all(*source);
    ASSERT_EQ(frames.size(), stamps.size());
    for (std::size_t k = 0; k < stamps.size(); ++k) {
        EXPECT_NEAR(frames[k].stamp, stamps[k], 0.5 / 90000 + 1e-12); // half a tick of the file
        EXPECT_NEAR(source->info().stamps[k], stamps[k], 0.5 / 90000 + 1e-12);
        EXPECT_EQ(frames[k].image.pixels, picture(64, 48, int(k)).pixels);
    }
    source->rewind();
    EXPECT_EQ(read_all(*source).size(), stamps.size());
}

TEST_F(Clips, FramesThatAreStoredOutOfOrderComeInTheOrderOfDisplay) {
    auto options = lossless(64, 48);
    options.codec = ClipCodec::h264;
    options.reordered = 3;
    write_clip(folder / "a.mp4", options, steady(20, 30, 0.25));
    const auto source = open_frames(of(folder / "a.mp4"));
    EXPECT_FALSE(source->info().variable_rate());
    const auto frames = read_all(*source);
    ASSERT_EQ(frames.size(), 20u);
    for (int k = 0; k < 20; ++k) EXPECT_NEAR(frames[std::size_t(k)].stamp, 0.25 + k / 30.0, 1e-5);
}

TEST_F(Clips, DisplayMatrixOf0And90And180And270TurnsFramesUpright) {
    const std::array cosine = {1, 0, -1, 0}, sine = {0, 1, 0, -1};
    for (const int degrees : {0, 90, 180, 270}) {
        auto options = lossless(48, 64); // portrait
        options.turned = degrees;
        const auto path = folder / (std::to_string(degrees) + ".mp4");
        write_clip(path, options, steady(3, 30));
        EXPECT_EQ(matrix_in_header(path),
            (std::array{cosine[degrees / 90], sine[degrees / 90], -sine[degrees / 90], cosine[degrees / 90]}));
        const auto source = open_frames(of(path));
        EXPECT_EQ(source->info().orientation.degrees(), degrees);
        EXPECT_EQ(source->info().width, 48);
        EXPECT_EQ(source->info().height, 64);
        const auto frames = read_all(*source);
        ASSERT_EQ(frames.size(), 3u);
        EXPECT_EQ(frames[1].image.width, 48);
        EXPECT_EQ(frames[1].image.pixels, picture(48, 64, 1).pixels) << degrees;
    }
}

// By hand: a clockwise quarter turn takes the left column to the top row.
TEST_F(Clips, QuarterTurnIsClockwise) {
    const Image image{2, 1, {1, 1, 1, 2, 2, 2}}; // 1 2
    const auto turned = turn(image, {0, 1, -1, 0});
    EXPECT_EQ(turned.width, 1);
    EXPECT_EQ(turned.pixels, (std::vector<std::uint8_t>{1, 1, 1, 2, 2, 2})); // 1 over 2
    EXPECT_EQ((Orientation{0, 1, -1, 0}).degrees(), 90);
    const auto back = turn(image, {0, -1, 1, 0});
    EXPECT_EQ(back.pixels, (std::vector<std::uint8_t>{2, 2, 2, 1, 1, 1}));
}

TEST_F(Clips, SameFramesGiveTheSameBytesWhereverMemoryLies) {
    auto options = lossless(64, 48);
    options.codec = ClipCodec::h264;
    std::string first;
    std::vector<std::vector<char>> kept;
    for (std::size_t k = 0; k < 300; ++k) {
        kept.emplace_back(64 * (1 + 7 * k % 41));
        write_clip(folder / "a.mp4", options, steady(5, 30));
        const auto bytes = content(folder / "a.mp4");
        if (k == 0) first = bytes;
        ASSERT_EQ(bytes, first) << k;
    }
}

TEST_F(Clips, Ffv1IsLossless) {
    for (const auto* name : {"a.mkv", "a.avi"}) {
        auto options = lossless(64, 48);
        options.codec = ClipCodec::ffv1;
        options.frames_per_second = 25;
        write_clip(folder / name, options, steady(4, 25));
        const auto frames = read_all(*open_frames(of(folder / name)));
        ASSERT_EQ(frames.size(), 4u) << name;
        EXPECT_EQ(frames[3].image.pixels, picture(64, 48, 3).pixels);
        EXPECT_NEAR(frames[3].stamp, 0.12, 1e-9);
    }
}

TEST_F(Clips, UnfinishedVideoLeavesNothing) {
    {
        ClipWriter writer(folder / "a.mp4", lossless(64, 48));
        writer.add(picture(64, 48, 0), 0);
        EXPECT_THROW(writer.add(picture(64, 48, 1), 0), InputError);
        EXPECT_THROW(writer.add(picture(32, 48, 1), 1), InputError);
    }
    EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(Clips, SlowMotionTakesItsTrueRateOrATimeMap) {
    write_clip(folder / "a.mp4", lossless(64, 48), steady(9, 30, 1));
    auto request = of(folder / "a.mp4");
    request.true_rate = 240;
    auto frames = read_all(*open_frames(request));
    EXPECT_NEAR(frames[8].time, 1 + 8 / 240.0, 1e-5);
    request.true_rate = 0;
    request.time_map = "1:0 1.1:0.1 1.2:0.11 2:0.91"; // normal, ten times slowed, normal
    frames = read_all(*open_frames(request));
    EXPECT_NEAR(frames[0].time, 0, 1e-5);
    EXPECT_NEAR(frames[6].time, 0.11, 1e-5);
    EXPECT_NEAR(frames[8].time, 0.11 + 2 / 30.0, 1e-5);
    for (const auto* bad : {"1:0", "1:0 1:2", "1:0 2:-1", "1;0 2;3", "no_such.csv"}) {
        request.time_map = bad;
        EXPECT_THROW(open_frames(request), InputError) << bad;
    }
}

TEST_F(Clips, PicturesOfAFolderAndAPatternAreFrames) {
    for (const int k : {2, 9, 10}) write_png(folder / ("f_" + std::to_string(k) + ".png"), picture(31, 17, k));
    auto request = of(folder);
    expect_names(refusal(request), {"--rate", "--times"});
    request.rate = 24;
    auto frames = read_all(*open_frames(request));
    ASSERT_EQ(frames.size(), 3u);
    EXPECT_EQ(frames[2].image.pixels, picture(31, 17, 10).pixels); // 10 after 9
    EXPECT_DOUBLE_EQ(frames[2].stamp, 2 / 24.0);
    request.clip = folder / "f_%d.png";
    expect_names(refusal(request), {"number 3 is missing"});
    request.clip = folder / "f_*.png";
    std::ofstream(folder / "times.csv") << "picture,time [ms]\n2,100\n9,200\n10,450\n";
    request.rate = 0;
    request.times = folder / "times.csv";
    frames = read_all(*open_frames(request));
    EXPECT_DOUBLE_EQ(frames[2].stamp, 0.45);
    write_png(folder / "f_11.png", picture(33, 17, 0));
    expect_names(refusal(request), {"has 3 times", "4 pictures"});
    request.times.clear();
    request.rate = 24;
    expect_names(refusal(request), {"f_11.png", "33 x 17", "31 x 17"});
}

TEST_F(Clips, WhatIsNoVideoIsRefusedWithACure) {
    expect_names(refusal(of(folder / "none.mp4")), {"none.mp4", "no such file"});
    std::ofstream(folder / "text.mp4") << "this is no video";
    expect_names(refusal(of(folder / "text.mp4")), {"text.mp4", "no video that can be read"});
    std::ofstream(folder / "a.heic", std::ios::binary) << std::string("\0\0\0\x18"
                                                                      "ftypheic\0\0\0\0",
        16);
    expect_names(refusal(of(folder / "a.heic")), {"HEIC", "Most Compatible"});
    auto options = lossless(64, 48);
    options.codec = ClipCodec::h264;
    options.interlaced = true;
    write_clip(folder / "fields.mp4", options, steady(4, 25));
    expect_names(refusal(of(folder / "fields.mp4")), {"interlaced", "bwdif"});
    options.interlaced = false;
    options.pixel_width = 16;
    options.pixel_height = 11;
    write_clip(folder / "wide.mp4", options, steady(4, 25));
    expect_names(refusal(of(folder / "wide.mp4")), {"not square", "1.4545", "setsar"});
    options.pixel_width = options.pixel_height = 1;
    options.hybrid_log_gamma = true;
    write_clip(folder / "hdr.mp4", options, steady(4, 25));
    expect_names(refusal(of(folder / "hdr.mp4")), {"HDR", "HLG", "10 bit", "HDR off"});
}

TEST_F(Clips, VideoThatIsCutOffIsNamed) {
    auto options = lossless(64, 48);
    write_clip(folder / "a.mp4", options, steady(12, 30));
    fs::resize_file(folder / "a.mp4", fs::file_size(folder / "a.mp4") * 6 / 10);
    expect_names(refusal(of(folder / "a.mp4")), {"a.mp4", "cut off", "copy the file again"});
    options.index_first = true;
    write_clip(folder / "b.mp4", options, steady(12, 30));
    fs::resize_file(folder / "b.mp4", fs::file_size(folder / "b.mp4") * 6 / 10);
    expect_names(refusal(of(folder / "b.mp4")), {"b.mp4", "cut off", "of the 12 frames", "--allow-damage"});
    auto request = of(folder / "b.mp4");
    request.allow_damage = true;
    const auto frames = read_all(*open_frames(request));
    EXPECT_GT(frames.size(), 1u);
    EXPECT_LT(frames.size(), 12u);
}
