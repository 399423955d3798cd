#include "base/text/error.hpp"
#include "io/checkpoint/checkpoint.hpp"
#include "io/frame.hpp"
#include "sample.hpp"
#include "temporary_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <sys/mount.h>
#include <sys/resource.h>

using namespace treacle;
using namespace treacle::io;

namespace {
Comm world() { return Comm::world(); }

// Holds the size that any file of this process may reach, as a disk quota would.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) {
        std::signal(SIGXFSZ, SIG_IGN);
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit now{std::min(bytes, before_.rlim_max), before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &now);
    }
    ~FileSizeLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }

private:
    rlimit before_{};
};

void commit(const std::filesystem::path& path, std::size_t rows) {
    const std::vector<double> values(3 * rows, 0.5);
    CheckpointWriter writer(world(), path);
    writer.attribute("time", 1.0);
    writer.distributed("position", 3, std::span(values));
    writer.commit();
}

void expect_simulation_error(const std::function<void()>& work) {
    try {
        work();
        ADD_FAILURE() << "wrote more than there is space";
    } catch (const SimulationError& error) {
        EXPECT_EQ(error.code(), ExitCode::simulation_failed);
    }
}

void expect_only_the_old_one(const std::filesystem::path& folder) {
    world().barrier();
    const auto files = std::distance(std::filesystem::directory_iterator(folder), {});
    EXPECT_EQ(files, 1) << "the temporary is gone";
    EXPECT_EQ(validate_checkpoint(world(), checkpoint_path(folder, 1)), "");
}
} // namespace

TEST(DiskFull, ACheckpointPastTheFileSizeLimitThrowsOnAllRanksAndTheOldOneStands) {
    const TemporaryFolder folder(world());
    commit(checkpoint_path(folder, 1), 1000);
    {
        const FileSizeLimit limit(1 << 20);
        expect_simulation_error([&] { commit(checkpoint_path(folder, 2), 100000); });
        // The one that stands may not be lost by writing it again.
        expect_simulation_error([&] { commit(checkpoint_path(folder, 1), 100000); });
    }
    expect_only_the_old_one(folder);
    commit(checkpoint_path(folder, 2), 100000);
    EXPECT_EQ(validate_checkpoint(world(), checkpoint_path(folder, 2)), "");
}

// A file system of its own over the folder; the tests are skipped where mounting is not allowed.
class OwnDisk : public testing::Test {
protected:
    void mount(const char* type, const char* options) {
        std::int64_t mounted = 0;
        if (world().is_root()) mounted = ::mount(type, folder_.path().c_str(), type, 0, options) == 0;
        mounted_ = world().any(mounted != 0);
        if (!mounted_) GTEST_SKIP() << "mounting a file system needs more rights";
    }
    void TearDown() override {
        world().barrier();
        if (mounted_ && world().is_root()) ::umount(folder_.path().c_str());
    }
    TemporaryFolder folder_{world()};
    bool mounted_ = false;
};

class SmallDisk : public OwnDisk {
protected:
    void SetUp() override { mount("tmpfs", "size=1m"); }
};

// ramfs cannot reserve space: a failure shows only when the values are written.
class DiskWithoutReservation : public OwnDisk {
protected:
    void SetUp() override { mount("ramfs", ""); }
};

TEST_F(DiskWithoutReservation, ARankThatCannotWriteFailsAllRanksAndNoneHangs) {
    if (world().size() == 1) GTEST_SKIP() << "needs two ranks";
    commit(checkpoint_path(folder_, 1), 1000);
    const FileSizeLimit limit(world().rank() == 1 ? 1 << 16 : RLIM_INFINITY);
    expect_simulation_error([&] { commit(checkpoint_path(folder_, 2), 100000); });
    expect_only_the_old_one(folder_);
}

TEST_F(DiskWithoutReservation, AFileThatFitsIsWritten) {
    commit(checkpoint_path(folder_, 1), 100000);
    EXPECT_EQ(validate_checkpoint(world(), checkpoint_path(folder_, 1)), "");
}

TEST_F(SmallDisk, ACheckpointThatDoesNotFitThrowsOnAllRanksAndTheOldOneStands) {
    commit(checkpoint_path(folder_, 1), 1000);
    expect_simulation_error([&] { commit(checkpoint_path(folder_, 2), 100000); });
    expect_only_the_old_one(folder_);
}

TEST_F(SmallDisk, ADiskWithoutASingleFreeBlockThrowsOnAllRanks) {
    commit(checkpoint_path(folder_, 1), 1000);
    if (world().is_root()) {
        std::ofstream fill(folder_.path() / "fill");
        const std::string block(4096, 'x');
        while (fill.write(block.data(), 4096).flush()) {
        }
    }
    world().barrier();
    expect_simulation_error([&] { commit(checkpoint_path(folder_, 2), 10); });
    FrameWriter frames(world(), folder_, "liquid");
    expect_simulation_error([&] { frames.write(0, 0, Sample(0, 10).block()); });
    world().barrier();
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 2);
    EXPECT_EQ(validate_checkpoint(world(), checkpoint_path(folder_, 1)), "");
}

TEST_F(SmallDisk, AFrameThatDoesNotFitLeavesTheEarlierFramesAndTheSeries) {
    FrameWriter frames(world(), folder_, "liquid");
    frames.write(0, 0, Sample(0, 10).block());
    expect_simulation_error([&] { frames.write(1, 0.1, Sample(0, 100000).block()); });
    EXPECT_EQ(read_series(folder_.path() / "liquid.hdf.series").size(), 1u);
    frames.write(1, 0.1, Sample(0, 20).block());
    EXPECT_EQ(read_series(folder_.path() / "liquid.hdf.series").size(), 2u);
}
