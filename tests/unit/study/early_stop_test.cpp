#include "sample.hpp"
#include "search/cma_es/cma_es.hpp"
#include "study/plots/table.hpp"
#include "study/study_runs.hpp"

#include "../own_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <sys/wait.h>
#include <unistd.h>

namespace treacle::study {
namespace {

// Stands for the program: its objective is |value - 4.2|, of which each of ten frames has a tenth, and it stops at the first frame with
// which the sum so far is above the cut.
constexpr const char* stand_in = R"(#!/bin/sh
folder=$2
sleep ${PAUSE:-0}
awk '
/^values:/ { gsub(/[^0-9.]/, ""); value = $0 + 0 }
/^ *- / { gsub(/[^0-9.]/, ""); value = $0 + 0 }
/^key:/ { gsub(/"/, "", $2); key = $2 }
/^cut:/ { cut = $2 + 0 }
END {
  whole = value > 4.2 ? value - 4.2 : 4.2 - value
  frames = 10
  for (k = 1; k < 10 && frames == 10; ++k) if (cut > 0 && whole * k / 10 > cut) frames = k
  bound = frames < 10 ? sprintf(", \"bound\": %.15g", whole * frames / 10) : ""
  figures = frames < 10 ? "" : sprintf("\"objective\": %.15g", whole)
  printf "{\"number\": 0, \"key\": \"%s\", \"figures\": {%s}, \"seconds\": %d, \"peak_bytes\": 1000%s}", key, figures, frames, bound
}' $folder/params.yaml > $folder/result.json.tmp
echo run >> $folder/../../count
mv $folder/result.json.tmp $folder/result.json
)";

class EarlyStop : public testing::Test {
protected:
    EarlyStop() {
        std::ofstream(program_) << stand_in;
        std::filesystem::permissions(program_, std::filesystem::perms::owner_all);
        study_ = study_of(header + "parameters:\n  - {key: a.b, range: [1, 99]}\nruns: {lanes: 2}\n");
    }
    static SceneFacts facts(const std::filesystem::path&, const std::vector<Assignment>& assignments) {
        SceneFacts out;
        for (const auto& one : assignments) out.content += one.text + "\n";
        return out;
    }
    Candidate candidate(double value, double cut = no_cut) const {
        auto out = candidate_of(study_, study_.scenes.front(), {study_.parameters.front().word(value)}, facts);
        out.cut = cut;
        return out;
    }
    const RunOutcome& outcome_of(StudyRuns& runs, double value, double cut = no_cut) const {
        const auto number = runs.ask(candidate(value, cut));
        runs.run(std::span(&number, 1));
        return *runs.journal().outcome(number);
    }
    std::size_t starts(const std::filesystem::path& out) const {
        std::ifstream in(out / "count");
        return std::size_t(std::count(std::istreambuf_iterator<char>(in), {}, '\n'));
    }
    StudySetup setup(const std::string& name = "out") const { return {folder_.path() / name, program_, {}}; }

    // Searches by CMA-ES, two generations beyond the first; the points of `ask`, and the values of `tell`.
    std::vector<double> search(StudyRuns& runs) const {
        search::Axis axis{std::log(1.0), std::log(99.0), std::log(20.0), 1, 0.001};
        search::CmaOptions options;
        options.limits.evaluations = 24;
        search::CmaEs search({axis}, options);
        std::vector<double> trace;
        while (!search.stopped()) {
            std::vector<std::int64_t> numbers;
            const auto points = search.ask();
            for (std::size_t k = 0; k < points.size(); ++k)
                numbers.push_back(runs.ask(candidate(std::exp(points[k][0]), search.cut(k))));
            runs.run(numbers);
            std::vector<search::Value> values;
            for (std::size_t k = 0; k < points.size(); ++k) {
                const auto* outcome = runs.journal().outcome(numbers[k]);
                const bool early = outcome->status == RunStatus::stopped_early;
                values.push_back(early ? search::Value::at_least(outcome->bound)
                                       : search::Value::measured(outcome->figures.at(0).value));
                trace.insert(trace.end(), {points[k][0], values.back().value(), double(early)});
            }
            search.tell(values);
        }
        return trace;
    }
    // All but the seconds.
    std::vector<std::vector<std::string>> rows(const StudyRuns& runs) const {
        std::vector<std::int64_t> numbers;
        for (const auto& run : runs.journal().runs()) numbers.push_back(run.number);
        auto table = table_of(study_, runs.journal(), numbers);
        for (auto& row : table.rows) row.erase(row.end() - 2);
        return table.rows;
    }

    const test::OwnFolder folder_;
    const std::filesystem::path program_ = folder_.path() / "program";
    Study study_;
    Log log_{LogOutput::disabled};
};

TEST_F(EarlyStop, ABoundIsThatOfTheFirstFrameAboveTheCutAndStandsInJournalAndTable) {
    StudyRuns runs(study_, setup(), log_);
    const auto& outcome = outcome_of(runs, 14.2, 2.5);
    EXPECT_EQ(outcome.status, RunStatus::stopped_early);
    EXPECT_EQ(outcome.bound, 3); // three of ten frames of 10
    EXPECT_TRUE(outcome.figures.empty());
    EXPECT_EQ(outcome_of(runs, 6.2, 2.5).status, RunStatus::done);
    const auto known = Journal::read(folder_.path() / "out");
    EXPECT_EQ(known.outcome(1)->status, RunStatus::stopped_early);
    EXPECT_EQ(known.outcome(1)->bound, 3);
    const auto table = rows(runs);
    EXPECT_EQ(table[0], (std::vector<std::string>{"1", "14.2", "stopped early", "", "objective >= 3"}));
    EXPECT_EQ(table[1], (std::vector<std::string>{"2", "6.2", "done", "2", ""}));
}

TEST_F(EarlyStop, ABoundIsNoValueAndAnswersOnlyCutsBelowIt) {
    StudyRuns runs(study_, setup(), log_);
    outcome_of(runs, 14.2, 2.5);
    for (const double cut : {2.5, 1.0, 2.9}) EXPECT_EQ(outcome_of(runs, 14.2, cut).bound, 3);
    EXPECT_EQ(starts(folder_.path() / "out"), 1u);
    EXPECT_EQ(outcome_of(runs, 14.2, 3).bound, 4) << "not above the new cut";
    EXPECT_EQ(starts(folder_.path() / "out"), 2u);
    EXPECT_EQ(outcome_of(runs, 14.2).figures.at(0).value, 10);
    EXPECT_EQ(outcome_of(runs, 14.2, 1).status, RunStatus::done) << "a value that is known stays one";
    EXPECT_EQ(starts(folder_.path() / "out"), 3u);
    outcome_of(runs, 24.2, 2.5);
    study_.runs.reuse = {(folder_.path() / "out").string()};
    StudyRuns other(study_, setup("other"), log_);
    EXPECT_EQ(outcome_of(other, 24.2, 2.5).folder, "") << "another study's bounds may be of other films";
    EXPECT_NE(outcome_of(other, 14.2).folder, "");
}

// Lanes that idle have no cut: what they have done must not show in what is recorded.
TEST_F(EarlyStop, SpeculativeRunsDoNotTakeThePlaceOfThoseWithACut) {
    StudyRuns runs(study_, setup(), log_);
    setenv("PAUSE", "0.1", 1);
    runs.offer({candidate(14.2), candidate(24.2)});
    outcome_of(runs, 5);
    unsetenv("PAUSE");
    EXPECT_EQ(outcome_of(runs, 14.2, 2.5).bound, 3);
    EXPECT_EQ(outcome_of(runs, 24.2).status, RunStatus::done);
    runs.offer({});
}

TEST_F(EarlyStop, ASearchGoesTheSameWayOnAnyLanesAndAfterKills) {
    std::vector<double> first;
    std::vector<std::vector<std::string>> table;
    for (const int lanes : {1, 2, 3}) {
        study_.runs.lanes = lanes;
        StudyRuns runs(study_, setup("lanes" + std::to_string(lanes)), log_);
        const auto trace = search(runs);
        if (lanes == 1) {
            first = trace;
            table = rows(runs);
            int early = 0;
            for (std::size_t i = 2; i < trace.size(); i += 3) early += trace[i] == 1;
            EXPECT_GE(early, 3) << "of 16 that have a cut";
        }
        EXPECT_EQ(trace, first);
        EXPECT_EQ(rows(runs), table);
    }
    setenv("PAUSE", "0.02", 1);
    for (int round = 0; round < 3; ++round) {
        const pid_t child = ::fork();
        if (child == 0) {
            study_.runs.lanes = 1 + round;
            StudyRuns runs(study_, setup("killed"), log_);
            search(runs);
            ::_exit(0);
        }
        usleep(150'000 + 70'000 * unsigned(round));
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        usleep(50'000);
    }
    unsetenv("PAUSE");
    StudyRuns runs(study_, setup("killed"), log_);
    EXPECT_EQ(search(runs), first);
    EXPECT_EQ(rows(runs), table);
}

} // namespace
} // namespace treacle::study
