#include "io/frame.hpp"

#include "base/text/error.hpp"
#include "sample.hpp"
#include "temporary_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>

using namespace treacle;
using namespace treacle::io;

namespace {
const Comm world() { return Comm::world(); }

Sample sample_of(int total, int empty_rank) {
    const auto part = part_without(world(), total, empty_rank);
    return {part.first, part.count};
}

std::vector<double> reals(const Frame& frame, const std::string& name) {
    return std::get<std::vector<double>>(frame.find(name)->values);
}
} // namespace

TEST(Frame, DoublePrecisionComesBackExactlyWithAnEmptyRank) {
    const TemporaryFolder folder(world());
    FrameWriter writer(world(), folder, "liquid", Precision::float64);
    const auto path = writer.write(42, 0.1, sample_of(50, 0).block());
    EXPECT_EQ(path.filename(), "liquid_000042.hdf");
    const auto frame = read_frame(path);
    const Sample all(0, 50);
    EXPECT_EQ(frame.positions, all.positions);
    EXPECT_EQ(reals(frame, "velocity"), all.velocities);
    EXPECT_EQ(std::get<std::vector<std::int64_t>>(frame.find("id")->values), all.ids);
    EXPECT_EQ(frame.find("velocity")->components, 3);
    EXPECT_EQ(frame.find("density")->unit, "kg/m^3");
    EXPECT_EQ(frame.time, 0.1);
    EXPECT_EQ(frame.step, 42);
    EXPECT_EQ(frame.find("pressure"), nullptr);
}

TEST(Frame, SinglePrecisionIsRoundedToNearest) {
    const TemporaryFolder folder(world());
    FrameWriter writer(world(), folder, "liquid");
    const auto frame = read_frame(writer.write(0, 0, sample_of(50, 0).block()));
    const Sample all(0, 50);
    ASSERT_EQ(frame.positions.size(), all.positions.size());
    for (std::size_t i = 0; i < all.positions.size(); ++i)
        EXPECT_EQ(frame.positions[i], static_cast<double>(static_cast<float>(all.positions[i])));
    EXPECT_EQ(frame.precision, Precision::float32);
}

TEST(Frame, NoParticlesAtAllIsAFrameToo) {
    const TemporaryFolder folder(world());
    FrameWriter writer(world(), folder, "liquid");
    const auto frame = read_frame(writer.write(1, 0.5, Sample(0, 0).block()));
    EXPECT_EQ(frame.size(), 0);
    EXPECT_EQ(frame.fields.size(), 5u);
}

TEST(Frame, SharesOfTheRanksAreTheWhole) {
    const TemporaryFolder folder(world());
    FrameWriter writer(world(), folder, "liquid", Precision::float64);
    const auto path = writer.write(0, 0, sample_of(50, 1).block());
    const auto part = read_frame(world(), path);
    EXPECT_EQ(part.total, 50);
    EXPECT_EQ(world().all_gather(part.positions), Sample(0, 50).positions);
    EXPECT_LE(part.size(), 50 / world().size() + 1);
}

TEST(Frame, TheSeriesListsEveryFrameOnce) {
    const TemporaryFolder folder(world());
    FrameWriter liquid(world(), folder, "liquid"), solid(world(), folder, "solid");
    for (int i = 0; i < 3; ++i) liquid.write(i, 0.1 * i, sample_of(5, 0).block());
    liquid.write(2, 0.2, sample_of(6, 0).block());
    solid.write(0, 0, sample_of(5, 0).block());
    const auto series = read_series(folder.path() / "liquid.hdf.series");
    ASSERT_EQ(series.size(), 3u);
    EXPECT_EQ(series[2].file, "liquid_000002.hdf");
    EXPECT_EQ(series[1].time, 0.1);
    EXPECT_EQ(read_frame(folder.path() / series[2].file).size(), 6);
    EXPECT_EQ(series_names(folder), (std::vector<std::string>{"liquid", "solid"}));
}

TEST(Frame, AResumedRunDropsLaterFramesAndKeepsEarlierOnes) {
    const TemporaryFolder folder(world());
    {
        FrameWriter first(world(), folder, "liquid");
        for (int i = 0; i < 5; ++i) first.write(i, 0.1 * i, sample_of(5, 0).block());
    }
    FrameWriter second(world(), folder, "liquid");
    second.resume(0.2);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "liquid_000004.hdf"));
    second.write(3, 0.35, sample_of(7, 0).block());
    const auto series = read_series(folder.path() / "liquid.hdf.series");
    ASSERT_EQ(series.size(), 4u);
    EXPECT_EQ(series[2].time, 0.2);
    EXPECT_EQ(series[3].time, 0.35);
    EXPECT_EQ(read_frame(folder.path() / "liquid_000001.hdf").size(), 5);
}

TEST(Frame, ResumeWithoutASeriesStartsOne) {
    const TemporaryFolder folder(world());
    FrameWriter writer(world(), folder, "liquid");
    writer.resume(1.0);
    writer.write(0, 2.0, sample_of(5, 0).block());
    EXPECT_EQ(read_series(folder.path() / "liquid.hdf.series").size(), 1u);
}

TEST(Frame, RepeatedFramesAreTheSameBytes) {
    const TemporaryFolder folder(world());
    FrameWriter writer(world(), folder, "liquid"), again(world(), folder, "again");
    const auto bytes = [](const std::filesystem::path& path) {
        std::ifstream file(path, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    const auto first = bytes(writer.write(0, 0, sample_of(50, 0).block()));
    EXPECT_GT(first.size(), 1000u);
    EXPECT_EQ(first, bytes(again.write(0, 0, sample_of(50, 0).block())));
}

TEST(Frame, AFieldOfWrongLengthOnOneRankThrowsOnAll) {
    const TemporaryFolder folder(world());
    FrameWriter writer(world(), folder, "liquid");
    auto sample = sample_of(50, 0);
    if (world().rank() == world().size() - 1) sample.densities.pop_back();
    const auto text = error_of([&] { writer.write(0, 0, sample.block()); });
    EXPECT_NE(text.find("density"), std::string::npos) << text;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "liquid_000000.hdf"));
}

TEST(Frame, FieldsThatDifferBetweenRanksThrowOnAll) {
    if (world().size() == 1) GTEST_SKIP() << "needs two ranks";
    const TemporaryFolder folder(world());
    FrameWriter writer(world(), folder, "liquid");
    const auto sample = sample_of(50, 0);
    auto block = sample.block();
    if (world().rank() == 1) block.fields.pop_back();
    const auto text = error_of([&] { writer.write(0, 0, block); });
    EXPECT_NE(text.find("different datasets"), std::string::npos) << text;
}

TEST(Frame, AFieldNameTwiceIsRefused) {
    const TemporaryFolder folder(world());
    FrameWriter writer(world(), folder, "liquid");
    const auto sample = sample_of(5, 0);
    auto block = sample.block();
    block.fields.push_back(block.fields[0]);
    EXPECT_NE(error_of([&] { writer.write(0, 0, block); }).find("twice"), std::string::npos);
}

TEST(Frame, AFileThatIsNoFrameIsBadInput) {
    const TemporaryFolder folder(world());
    const auto path = folder.path() / "text.hdf";
    if (world().is_root()) std::ofstream(path) << "no HDF5";
    world().barrier();
    try {
        read_frame(world(), path);
        FAIL() << "read a text as a frame";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::bad_input);
        EXPECT_NE(std::string(error.what()).find("text.hdf"), std::string::npos);
    }
    EXPECT_THROW(read_series(folder.path() / "none.hdf.series"), InputError);
    EXPECT_THROW(read_series(path), InputError);
}
