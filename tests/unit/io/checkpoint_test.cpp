#include "io/checkpoint/checkpoint.hpp"

#include "base/text/error.hpp"
#include "temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>

using namespace treacle;
using namespace treacle::io;

namespace {
Comm world() { return Comm::world(); }

// Rows first..first+count-1 of a known array of three components.
std::vector<double> rows_of(std::int64_t first, std::int64_t count) {
    std::vector<double> values;
    for (std::int64_t i = 3 * first; i < 3 * (first + count); ++i) values.push_back(std::sin(1.0 + 0.7 * i));
    return values;
}
constexpr std::int64_t total = 101;

// Uneven, rank 0 without rows when there are others.
std::pair<std::int64_t, std::int64_t> writers_rows() {
    if (world().size() == 1) return {0, total};
    if (world().rank() == 0) return {0, 0};
    if (world().size() == 2) return {0, total};
    return world().rank() == 1 ? std::pair<std::int64_t, std::int64_t>{0, 30}
                               : std::pair<std::int64_t, std::int64_t>{30, total - 30};
}

void write_sample(const std::filesystem::path& path, double time) {
    const auto [first, count] = writers_rows();
    CheckpointWriter writer(world(), path);
    writer.attribute("time", time);
    writer.attribute("step", 77);
    writer.attribute("scene", "dam break");
    writer.attribute("empty", "");
    const std::vector<double> history = {0.1, -0.0, std::numeric_limits<double>::denorm_min()};
    const std::vector<std::int64_t> counters = {std::numeric_limits<std::int64_t>::max(), -1};
    const std::vector<double> nothing;
    writer.replicated("history", std::span(history));
    writer.replicated("random/counters", std::span(counters));
    writer.replicated("nothing", std::span(nothing));
    const auto positions = rows_of(first, count);
    writer.distributed("liquid/position", 3, std::span(positions));
    std::vector<std::int64_t> ids(static_cast<std::size_t>(count));
    std::iota(ids.begin(), ids.end(), first);
    writer.distributed("liquid/id", 1, std::move(ids));
    writer.distributed("solid/id", 1, std::vector<std::int64_t>{});
    writer.commit();
}

// Changes one bit in the middle of the stored positions, wherever they lie.
void flip_a_bit_of_the_values(const std::filesystem::path& path) {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    const std::string bytes(std::istreambuf_iterator<char>(file), {});
    const auto row = rows_of(50, 1);
    const std::string wanted(reinterpret_cast<const char*>(row.data()), sizeof(double));
    const auto at = bytes.find(wanted);
    ASSERT_NE(at, std::string::npos);
    file.clear();
    file.seekp(static_cast<std::streamoff>(at));
    file.put(static_cast<char>(bytes[at] ^ 1));
}

template <class Work>
void on_root(Work&& work) {
    world().barrier();
    if (world().is_root()) work();
    world().barrier();
}
} // namespace

TEST(Checkpoint, EveryBitComesBackOnTheSameRanks) {
    const TemporaryFolder folder(world());
    const auto path = checkpoint_path(folder, 77);
    EXPECT_EQ(path.filename(), "checkpoint_000000077.h5");
    write_sample(path, 0.1);
    const CheckpointReader reader(world(), path);
    EXPECT_EQ(reader.writer_ranks(), world().size());
    EXPECT_EQ(reader.attribute<double>("time"), 0.1);
    EXPECT_EQ(reader.attribute<std::int64_t>("step"), 77);
    EXPECT_EQ(reader.attribute<std::string>("scene"), "dam break");
    EXPECT_EQ(reader.attribute<std::string>("empty"), "");
    const auto history = reader.replicated<double>("history");
    ASSERT_EQ(history.size(), 3u);
    EXPECT_TRUE(std::signbit(history[1]));
    EXPECT_EQ(history[2], std::numeric_limits<double>::denorm_min());
    EXPECT_EQ(reader.replicated<std::int64_t>("random/counters")[0], std::numeric_limits<std::int64_t>::max());
    EXPECT_TRUE(reader.replicated<double>("nothing").empty());
    const auto [first, count] = writers_rows();
    const auto rows = reader.distributed<double>("liquid/position");
    EXPECT_EQ(rows.components, 3);
    EXPECT_EQ(rows.total, total);
    EXPECT_EQ(rows.values, rows_of(first, count));
    EXPECT_EQ(reader.distributed<std::int64_t>("liquid/id").size(), count);
    EXPECT_EQ(reader.distributed<std::int64_t>("solid/id").total, 0);
    EXPECT_EQ(validate_checkpoint(world(), path), "");
}

TEST(Checkpoint, AnotherNumberOfRanksGetsEqualSharesOfTheSameRows) {
    if (world().size() == 1) GTEST_SKIP() << "needs two ranks";
    const TemporaryFolder folder(world());
    const auto path = checkpoint_path(folder, 1);
    write_sample(path, 0);
    // Rank 0 alone reads what all wrote, then all read what one wrote.
    world().guard_root([&] {
        const CheckpointReader alone(Comm::self(), path);
        EXPECT_EQ(alone.distributed<double>("liquid/position").values, rows_of(0, total));
        CheckpointWriter writer(Comm::self(), checkpoint_path(folder, 2));
        writer.distributed("x", 3, rows_of(0, total));
        writer.commit();
    });
    const CheckpointReader reader(world(), checkpoint_path(folder, 2));
    const auto rows = reader.distributed<double>("x");
    EXPECT_LE(std::abs(rows.size() - total / world().size()), 1);
    EXPECT_EQ(world().all_gather(rows.values), rows_of(0, total));
}

TEST(Checkpoint, ManyAttributesAndNothingElse) {
    const TemporaryFolder folder(world());
    const auto path = checkpoint_path(folder, 1);
    CheckpointWriter writer(world(), path);
    for (int i = 0; i < 300; ++i) writer.attribute("value " + std::to_string(i), 0.1 * i);
    writer.commit();
    const CheckpointReader reader(world(), path);
    EXPECT_EQ(reader.attribute_names().size(), 300u);
    EXPECT_EQ(reader.attribute<double>("value 299"), 0.1 * 299);
}

TEST(Checkpoint, ABitFlippedInTheValuesIsFound) {
    const TemporaryFolder folder(world());
    const auto path = checkpoint_path(folder, 1);
    write_sample(path, 0);
    on_root([&] { flip_a_bit_of_the_values(path); });
    const auto reason = validate_checkpoint(world(), path);
    EXPECT_NE(reason.find("liquid/position: the checksum is wrong"), std::string::npos) << reason;
    EXPECT_THROW(CheckpointReader(world(), path).distributed<double>("liquid/position"), Error);
}

TEST(Checkpoint, ATruncatedFileIsFoundAtEveryLength) {
    const TemporaryFolder folder(world());
    const auto path = checkpoint_path(folder, 1);
    write_sample(path, 0);
    const auto size = static_cast<std::int64_t>(std::filesystem::file_size(path));
    for (const std::int64_t length :
        {size - 1, size - 100, size / 2, std::int64_t{1000}, std::int64_t{10}, std::int64_t{0}}) {
        on_root([&] { std::filesystem::resize_file(path, static_cast<std::uintmax_t>(length)); });
        EXPECT_NE(validate_checkpoint(world(), path), "") << length << " of " << size;
    }
}

TEST(Checkpoint, AFlippedByteAnywhereIsFoundOrHarmless) {
    const TemporaryFolder folder(world());
    const auto path = folder.path() / "whole.h5", broken = folder.path() / "broken.h5";
    write_sample(path, 0.25);
    const auto size = static_cast<std::int64_t>(std::filesystem::file_size(path));
    int harmless = 0, tried = 0;
    for (std::int64_t at = 3; at < size; at += 97, ++tried) {
        on_root([&] {
            std::filesystem::copy_file(path, broken, std::filesystem::copy_options::overwrite_existing);
            std::fstream file(broken, std::ios::binary | std::ios::in | std::ios::out);
            file.seekg(at);
            const int byte = file.get();
            file.seekp(at);
            file.put(static_cast<char>(byte ^ 0x10));
        });
        if (!validate_checkpoint(world(), broken).empty()) continue;
        ++harmless;
        const CheckpointReader reader(world(), broken);
        EXPECT_EQ(reader.attribute<double>("time"), 0.25) << "byte " << at;
        const auto [first, count] = writers_rows();
        EXPECT_EQ(reader.distributed<double>("liquid/position").values, rows_of(first, count)) << "byte " << at;
    }
    EXPECT_LT(harmless, tried);
}

TEST(Checkpoint, WhatIsNotThereIsBadInput) {
    const TemporaryFolder folder(world());
    const auto path = checkpoint_path(folder, 1);
    write_sample(path, 0);
    const CheckpointReader reader(world(), path);
    EXPECT_THROW(reader.attribute<double>("temperature"), InputError);
    EXPECT_THROW(reader.attribute<double>("scene"), InputError);
    EXPECT_THROW(reader.replicated<std::int64_t>("history"), InputError);
    EXPECT_THROW(reader.distributed<std::int64_t>("liquid/position"), InputError);
    EXPECT_THROW(reader.distributed<double>("liquid/pressure"), InputError);
    EXPECT_FALSE(reader.has_attribute("temperature"));
    EXPECT_TRUE(reader.has_distributed("liquid/id"));
    EXPECT_NE(validate_checkpoint(world(), folder.path() / "none.h5"), "");
}

TEST(Checkpoint, ANameTwiceIsRefused) {
    const TemporaryFolder folder(world());
    CheckpointWriter writer(world(), checkpoint_path(folder, 1));
    writer.attribute("time", 1.0);
    EXPECT_THROW(writer.attribute("time", 2.0), std::logic_error);
}

TEST(Checkpoint, TheNewestWholeOneIsTakenAndBrokenOnesAreNamed) {
    const TemporaryFolder folder(world());
    for (const int step : {5, 20, 100}) write_sample(checkpoint_path(folder, step), 0.1 * step);
    on_root([&] {
        const auto newest = checkpoint_path(folder, 100);
        std::filesystem::resize_file(newest, std::filesystem::file_size(newest) / 2);
        std::ofstream(folder.path() / "checkpoint_000000200.h5.tmp") << "left by a killed run";
        std::ofstream(folder.path() / "checkpoint_notes.txt") << "of the user";
    });
    const auto found = newest_valid_checkpoint(world(), folder);
    EXPECT_EQ(found.path, checkpoint_path(folder, 20));
    ASSERT_EQ(found.skipped.size(), 1u);
    EXPECT_NE(found.skipped[0].find("checkpoint_000000100.h5"), std::string::npos);
    EXPECT_FALSE(newest_valid_checkpoint(world(), folder.path() / "none").path.has_value());
}

TEST(Checkpoint, TheLastOnesAreKeptAndLeftoversCleaned) {
    const TemporaryFolder folder(world());
    for (const int step : {5, 20, 100, 7}) write_sample(checkpoint_path(folder, step), 0);
    on_root([&] {
        std::ofstream(folder.path() / "checkpoint_000000200.h5.tmp") << "left by a killed run";
        std::ofstream(folder.path() / "notes.txt") << "of the user";
    });
    keep_last_checkpoints(world(), folder, 2);
    world().barrier();
    EXPECT_EQ(list_checkpoints(folder), (std::vector{checkpoint_path(folder, 100), checkpoint_path(folder, 20)}));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "checkpoint_000000200.h5.tmp"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "notes.txt"));
    world().barrier();
    remove_checkpoints_after(world(), folder, 20);
    world().barrier();
    EXPECT_EQ(list_checkpoints(folder), (std::vector{checkpoint_path(folder, 20)}));
}
