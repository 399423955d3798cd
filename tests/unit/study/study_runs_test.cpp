#include "base/text/file.hpp"
#include "sample.hpp"
#include "study/lanes/forward_files.hpp"
#include "study/plots/table.hpp"
#include "study/study_runs.hpp"

#include "../own_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <sys/wait.h>
#include <unistd.h>

namespace treacle::study {
namespace {

// Stands for the program: its figure is the square of the value; some values fail in their ways.
constexpr const char* stand_in = R"(#!/bin/sh
folder=$2
echo run >> $folder/../../count
value=$(sed -n 's/^ *values: \[*"*\([0-9.]*\).*/\1/p; s/^ *- "*\([0-9.]*\).*/\1/p' $folder/params.yaml | tail -1)
key=$(sed -n 's/^key: "*\([0-9a-f]*\).*/\1/p' $folder/params.yaml)
case $value in
3) echo "no good" > $folder/FAIL; exit 3;;
4) kill -9 $$;;
5) sleep 100;;
6) exit 4;;
7) echo "last words"; exit 2;;
8) if [ -e $folder/../../mended ]; then value=8; else exit 3; fi;;
esac
sleep ${PAUSE:-0}
mkdir -p $folder/run/frames
echo "{\"number\": 0, \"key\": \"$key\", \"figures\": {\"square\": $((value * value))}, \"seconds\": 1, \"peak_bytes\": 1000}" > $folder/result.json.tmp
mv $folder/result.json.tmp $folder/result.json
)";

class StudyRunsTest : public testing::Test {
protected:
    StudyRunsTest() {
        std::ofstream(program_) << stand_in;
        std::filesystem::permissions(program_, std::filesystem::perms::owner_all);
        study_ = study_of(header + "parameters:\n  - {key: a.b, range: [1, 9]}\nruns: {lanes: 2, time_limit: 1 s}\n");
    }
    // The scene takes whatever it is given.
    static SceneFacts facts(const std::filesystem::path&, const std::vector<Assignment>& assignments) {
        SceneFacts out;
        for (const auto& one : assignments) out.content += one.text + "\n";
        return out;
    }
    std::vector<std::int64_t> ask(StudyRuns& runs, const std::vector<std::string>& values) const {
        std::vector<Point> points;
        for (const auto& value : values) points.push_back({value});
        std::vector<std::int64_t> numbers;
        for (const auto& candidate : candidates_of(study_, points, facts)) numbers.push_back(runs.ask(candidate));
        return numbers;
    }
    std::size_t starts() const {
        std::ifstream in(out_ / "count");
        return std::size_t(std::count(std::istreambuf_iterator<char>(in), {}, '\n'));
    }
    StudySetup setup() const { return {out_, program_, {}}; }

    const test::OwnFolder folder_;
    const std::filesystem::path program_ = folder_.path() / "program", out_ = folder_.path() / "out";
    Study study_;
    Log log_{LogOutput::disabled};
};

TEST_F(StudyRunsTest, FailuresAreRecordedWithTheirReasonsAndTheOthersAreRight) {
    StudyRuns runs(study_, setup(), log_);
    const auto numbers = ask(runs, {"1", "2", "3", "4", "5", "6", "7", "9"});
    EXPECT_EQ(runs.run(numbers), StudyEnd::complete);
    const std::vector<RunStatus> expected{RunStatus::done, RunStatus::done, RunStatus::failed, RunStatus::killed,
        RunStatus::timed_out, RunStatus::out_of_memory, RunStatus::bad_input, RunStatus::done};
    const std::vector<std::string> reasons{"", "", "no good", "was ended by signal 9 (Killed)",
        "took longer than the time limit of 1.0 s", "ended with exit code 4", "last words", ""};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const auto* outcome = runs.journal().outcome(numbers[i]);
        ASSERT_NE(outcome, nullptr);
        EXPECT_EQ(outcome->status, expected[i]) << i;
        EXPECT_NE(outcome->reason.find(reasons[i]), std::string::npos) << outcome->reason;
    }
    EXPECT_EQ(runs.journal().outcome(numbers[7])->figures[0].value, 81);
    const auto table = table_of(study_, runs.journal(), numbers);
    EXPECT_EQ(table.header, (std::vector<std::string>{"run", "b", "status", "square", "seconds [s]", "reason"}));
    EXPECT_EQ(table.rows[1][3], "4");
    EXPECT_EQ(table.rows[2][3], "");
    EXPECT_FALSE(std::filesystem::exists(runs.run_folder(1) / "run" / "frames"));
}

TEST_F(StudyRunsTest, IdleLanesSpeculateAndTheResultsWaitUntilAskedFor) {
    setenv("PAUSE", "0.2", 1);
    StudyRuns runs(study_, setup(), log_);
    const auto offer = [&](const std::vector<Point>& points) { runs.offer(candidates_of(study_, points, facts)); };
    offer({{"2"}, {"3"}});
    runs.run(ask(runs, {"1"}));
    EXPECT_EQ(runs.journal().runs().size(), 1u) << "what is speculated about is not asked for";
    offer({{"2"}, {"3"}});
    runs.run(ask(runs, {"9"}));
    unsetenv("PAUSE");
    const auto before = starts();
    EXPECT_GE(before, 3u);
    const auto numbers = ask(runs, {"2"});
    EXPECT_EQ(numbers, std::vector<std::int64_t>{3});
    runs.run(numbers);
    EXPECT_EQ(starts(), before) << "it had been started";
    EXPECT_EQ(runs.journal().outcome(3)->figures[0].value, 4);
    EXPECT_TRUE(std::filesystem::exists(runs.run_folder(3) / "result.json"));
    runs.run(ask(runs, {"3"}));
    EXPECT_EQ(runs.journal().outcome(4)->reason, "no good") << "what failed is done again for its reason";
    runs.offer({});
    EXPECT_EQ(folder_bytes(out_ / "speculative"), 0);
}

TEST_F(StudyRunsTest, RunsThatAreAskedForTakeTheLanesOfSpeculation) {
    study_.runs.time_limit = 20;
    StudyRuns runs(study_, setup(), log_);
    runs.offer(candidates_of(study_, {{"5"}}, facts)); // sleeps
    setenv("PAUSE", "0.2", 1);
    runs.run(ask(runs, {"1"}));
    unsetenv("PAUSE");
    EXPECT_GT(folder_bytes(out_ / "speculative"), 0);
    runs.run(ask(runs, {"2", "9"}));
    EXPECT_EQ(folder_bytes(out_ / "speculative"), 0) << "it was ended for them";
    EXPECT_EQ(runs.journal().outcome(3)->figures[0].value, 81);
}

TEST_F(StudyRunsTest, NothingIsRunTwiceAndFailuresOnlyWhenAsked) {
    {
        StudyRuns runs(study_, setup(), log_);
        runs.run(ask(runs, {"1", "8", "1"}));
        EXPECT_EQ(starts(), 2u);
    }
    StudyRuns runs(study_, setup(), log_);
    const auto numbers = ask(runs, {"8", "2", "1"});
    EXPECT_EQ(numbers, (std::vector<std::int64_t>{2, 3, 1}));
    runs.run(numbers);
    EXPECT_EQ(starts(), 3u);
    std::ofstream(out_ / "mended") << "";
    runs.run(numbers, true);
    EXPECT_EQ(starts(), 4u);
    EXPECT_EQ(runs.journal().outcome(2)->status, RunStatus::done);
    EXPECT_EQ(runs.journal().outcome(2)->figures[0].value, 64);
}

TEST_F(StudyRunsTest, ARunWithChangesIsAnotherRunThatItsRequestTells) {
    StudyRuns runs(study_, setup(), log_);
    const std::vector<std::string> changes{"a.law={n: 2}", "a.b=7"};
    const auto plain = runs.ask(candidate_of(study_, study_.scenes.front(), {"2"}, facts));
    const auto changed = runs.ask(candidate_of(study_, study_.scenes.front(), {"2"}, facts, changes));
    EXPECT_NE(plain, changed);
    EXPECT_EQ(runs.ask(candidate_of(study_, study_.scenes.front(), {"2"}, facts, changes)), changed);
    runs.run(std::vector{plain, changed});
    EXPECT_TRUE(read_request(runs.run_folder(plain)).run.changes.empty());
    EXPECT_EQ(read_request(runs.run_folder(changed)).run.changes, changes);
    const auto last = assignments_of(study_, study_.scenes.front(), {"2"}, changes).back();
    EXPECT_EQ(last.text, "a.b=7"); // after the parameter, and so it counts
    const auto rows = table_of(study_, runs.journal(), std::vector{plain, changed}).rows;
    EXPECT_EQ(rows[0].back(), "");
    EXPECT_EQ(rows[1].back(), "with a.law={n: 2}; a.b=7");
}

// A study killed at any moment goes on from its journal; a result that was there counts although the journal lacks it.
TEST_F(StudyRunsTest, AKilledStudyLosesNoFinishedRun) {
    ::setenv("PAUSE", "0.1", 1);
    for (int round = 0; round < 4; ++round) {
        const pid_t child = ::fork();
        if (child == 0) {
            study_.runs.lanes = 1 + round % 3;
            StudyRuns runs(study_, setup(), log_);
            runs.run(ask(runs, {"1", "2", "9", "11", "12", "13", "14"}));
            ::_exit(0);
        }
        usleep(150'000 + 60'000 * unsigned(round));
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        usleep(50'000);
    }
    ::unsetenv("PAUSE");
    StudyRuns runs(study_, setup(), log_);
    const auto numbers = ask(runs, {"1", "2", "9", "11", "12", "13", "14"});
    EXPECT_EQ(runs.run(numbers), StudyEnd::complete);
    const std::vector<double> expected{1, 4, 81, 121, 144, 169, 196};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        EXPECT_EQ(numbers[i], std::int64_t(i) + 1);
        EXPECT_EQ(runs.journal().outcome(numbers[i])->figures[0].value, expected[i]);
    }
    // A kill takes at most the runs under way with it: those of 1, 2, 3 and 1 lanes.
    EXPECT_LE(starts(), numbers.size() + 7);
}

TEST_F(StudyRunsTest, RunsOfAnotherStudyCount) {
    {
        StudyRuns runs(study_, setup(), log_);
        runs.run(ask(runs, {"1", "2"}));
    }
    study_.runs.reuse = {out_.string()};
    StudyRuns runs(study_, {folder_.path() / "second", program_, {}}, log_);
    const auto numbers = ask(runs, {"2", "9"});
    runs.run(numbers);
    EXPECT_EQ(runs.journal().outcome(1)->figures[0].value, 4);
    EXPECT_EQ(runs.journal().outcome(1)->folder, (out_ / "runs" / "0002").string());
    EXPECT_EQ(starts(), 2u);
}

TEST_F(StudyRunsTest, OneStudyHoldsAFolder) {
    StudyRuns runs(study_, setup(), log_);
    EXPECT_NE(complaint_of([&] { StudyRuns second(study_, setup(), log_); }), "");
}

} // namespace
} // namespace treacle::study
