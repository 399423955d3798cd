#include "study/lanes/lanes.hpp"

#include "../own_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace treacle::study {
namespace {

class LanesTest : public testing::Test {
protected:
    LaneTask task(std::int64_t number, const std::string& script) const {
        const auto folder = folder_.path() / std::to_string(number);
        std::filesystem::create_directories(folder / "run");
        return {number, folder, {"/bin/sh", "-c", "cd " + folder.string() + "; " + script}, {}};
    }
    std::string content(const std::filesystem::path& path) const {
        std::ifstream in(path);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    std::vector<LaneResult> all_of(Lanes& lanes) const {
        std::vector<LaneResult> out;
        const auto start = std::chrono::steady_clock::now();
        while (!lanes.idle() && std::chrono::steady_clock::now() - start < std::chrono::seconds(60)) {
            for (auto& one : lanes.wait(1)) out.push_back(one);
        }
        return out;
    }
    const test::OwnFolder folder_;
};

TEST_F(LanesTest, EndingsAreToldAsTheyWere) {
    Lanes lanes(3, {});
    lanes.start(task(1, "echo said; echo wrong >&2; exit 3"));
    lanes.start(task(2, "kill -SEGV $$"));
    lanes.start(task(3, "exit 0"));
    EXPECT_EQ(lanes.free(), 0);
    auto results = all_of(lanes);
    std::ranges::sort(results, {}, &LaneResult::number);
    ASSERT_EQ(results.size(), 3u);
    EXPECT_EQ(results[0].ending.exit_code, 3);
    EXPECT_EQ(results[1].ending.signal, SIGSEGV);
    EXPECT_EQ(results[2].ending.exit_code, 0);
    for (const auto& one : results) EXPECT_EQ(one.end, LaneEnd::none);
    EXPECT_EQ(content(folder_.path() / "1" / "log.txt"), "said\nwrong\n");
    EXPECT_NE(results[0].lane, results[1].lane);
}

TEST_F(LanesTest, AProgramThatIsNotThereIsAnError) {
    Lanes lanes(1, {});
    auto wrong = task(1, "");
    wrong.command = {"/no/such/launcher", "run"};
    EXPECT_THROW(lanes.start(wrong), std::exception);
    EXPECT_EQ(lanes.free(), 1);
}

// A run that ignores signals, and has started others.
TEST_F(LanesTest, ARunThatTakesTooLongIsEndedWithAllThatItStarted) {
    LaneLimits limits;
    limits.time = 0.3;
    Lanes lanes(1, limits);
    lanes.start(task(1, "sleep 100 & echo $! > child; sleep 100"));
    const auto results = all_of(lanes);
    ASSERT_EQ(results.size(), 1u);
    EXPECT_EQ(results[0].end, LaneEnd::time_limit);
    EXPECT_LT(results[0].seconds, 30);
    usleep(100'000);
    const int child = std::atoi(content(folder_.path() / "1" / "child").c_str());
    EXPECT_GT(child, 0);
    const auto state = content("/proc/" + std::to_string(child) + "/stat");
    EXPECT_TRUE(state.empty() || state.find(") Z") != std::string::npos) << state;
}

TEST_F(LanesTest, ARunWithoutNewStepsIsHungAndOneWithThemIsNot) {
    LaneLimits limits;
    limits.hang_factor = 3;
    limits.hang_least = 0.6;
    Lanes lanes(2, limits);
    const std::string head = "echo 'step,time [s],dt [s]' > run/steps.csv; ";
    lanes.start(task(1, head + "echo 1,0.1,0.1 >> run/steps.csv; trap '' TERM; sleep 100"));
    lanes.start(task(2, head + "for i in 1 2 3 4 5 6 7 8; do echo $i,0.$i,0.1 >> run/steps.csv; sleep 0.25; done"));
    auto results = all_of(lanes);
    std::ranges::sort(results, {}, &LaneResult::number);
    ASSERT_EQ(results.size(), 2u);
    EXPECT_EQ(results[0].end, LaneEnd::hang);
    EXPECT_EQ(results[1].end, LaneEnd::none);
    EXPECT_EQ(results[1].ending.exit_code, 0);
}

TEST_F(LanesTest, ARunThatHasFinishedMayBeComparedForLonger) {
    LaneLimits limits;
    limits.hang_factor = 3;
    limits.hang_least = 0.3;
    Lanes lanes(1, limits);
    lanes.start(task(1, "echo 'step,time [s],dt [s]' > run/steps.csv; echo 1,0.1,0.1 >> run/steps.csv; touch "
                        "run/summary.json; sleep 1.2"));
    const auto results = all_of(lanes);
    ASSERT_EQ(results.size(), 1u);
    EXPECT_EQ(results[0].end, LaneEnd::none);
}

TEST_F(LanesTest, ARunThatFillsTheMemoryIsEnded) {
    LaneLimits limits;
    limits.memory = 60e6;
    Lanes lanes(1, limits);
    lanes.start(task(1, "exec /usr/bin/python3 -c 'import time; a = bytearray(200_000_000); time.sleep(100)'"));
    const auto results = all_of(lanes);
    ASSERT_EQ(results.size(), 1u);
    EXPECT_EQ(results[0].end, LaneEnd::memory);
    EXPECT_GT(results[0].peak_bytes, 60e6);
}

TEST_F(LanesTest, ASignalAsksToStopAndTheRunsAreAskedInTurn) {
    Lanes lanes(1, {});
    lanes.start(task(1, "trap 'exit 5' TERM; while true; do sleep 0.05; done"));
    usleep(200'000);
    ::kill(::getpid(), SIGTERM);
    EXPECT_TRUE(lanes.wait(10).empty());
    EXPECT_TRUE(lanes.stop_asked());
    const auto results = lanes.stop(20);
    ASSERT_EQ(results.size(), 1u);
    EXPECT_EQ(results[0].end, LaneEnd::stop);
    EXPECT_EQ(results[0].ending.exit_code, 5);
}

TEST_F(LanesTest, ChildrenInheritNoJobStep) {
    ::setenv("SLURM_STEP_ID", "3", 1);
    ::setenv("OMPI_COMM_WORLD_SIZE", "4", 1);
    ::setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
    Lanes lanes(1, {});
    lanes.start(task(1, "env"));
    all_of(lanes);
    const auto text = content(folder_.path() / "1" / "log.txt");
    EXPECT_EQ(text.find("SLURM_STEP_ID"), std::string::npos);
    EXPECT_EQ(text.find("OMPI_COMM_WORLD_SIZE"), std::string::npos);
    EXPECT_NE(text.find("OMPI_MCA_rmaps_base_oversubscribe=1"), std::string::npos);
}

} // namespace
} // namespace treacle::study
