#include "sample.hpp"
#include "study/lanes/journal.hpp"

#include "../own_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

namespace treacle::study {
namespace {

class JournalTest : public testing::Test {
protected:
    std::filesystem::path file() const { return folder_.path() / Journal::file_name; }
    std::string content() const {
        std::ifstream in(file());
        return {std::istreambuf_iterator<char>(in), {}};
    }
    void two_runs() const {
        auto journal = Journal::open(folder_.path(), owner_);
        journal.ask("weir", {"1 Pa.s", "sph"}, "aa");
        journal.ask("weir", {"2 Pa.s", "sph"}, "bb", {"a.b={c: 1, d: 2}", "e=3"});
        RunOutcome outcome{1, RunStatus::done, "", {{"front [m]", 1.0 / 3}, {"gone", std::nan("")}}, 2.5, 1e6, 2e3, 1,
            "then", "here", ""};
        journal.finish(outcome);
        outcome = {2, RunStatus::hung, "took no step, \"really\"\n", {}, 2.5, 1e6, 2e3, 0, "then", "here", ""};
        journal.finish(outcome);
    }
    const test::OwnFolder folder_;
    const JournalOwner owner_{"study", "program"};
};

TEST_F(JournalTest, WhatIsWrittenIsReadBackBitForBit) {
    two_runs();
    const auto journal = Journal::read(folder_.path());
    ASSERT_EQ(journal.runs().size(), 2u);
    EXPECT_EQ(journal.find("bb")->number, 2);
    EXPECT_EQ(journal.find("cc"), nullptr);
    EXPECT_EQ(journal.runs()[0].values, (Point{"1 Pa.s", "sph"}));
    EXPECT_TRUE(journal.runs()[0].changes.empty());
    EXPECT_EQ(journal.runs()[1].changes, (std::vector<std::string>{"a.b={c: 1, d: 2}", "e=3"}));
    const auto& first = *journal.outcome(1);
    EXPECT_EQ(first.figures[0].value, 1.0 / 3);
    EXPECT_TRUE(std::isnan(first.figures[1].value));
    EXPECT_EQ(journal.outcome(2)->status, RunStatus::hung);
    EXPECT_EQ(journal.outcome(2)->reason, "took no step, \"really\"\n");
}

TEST_F(JournalTest, TheLastOutcomeOfARunHolds) {
    two_runs();
    {
        auto journal = Journal::open(folder_.path(), owner_);
        journal.finish({2, RunStatus::done, "", {{"front [m]", 7}}, 1, 0, 0, 0, "", "", ""});
    }
    EXPECT_EQ(Journal::read(folder_.path()).outcome(2)->figures[0].value, 7);
}

// Whatever byte a kill stops at: the lines before it hold, and the journal goes on.
TEST_F(JournalTest, ALineThatWasCutOffIsDropped) {
    two_runs();
    const auto whole = content();
    const auto second_line = whole.find('\n') + 1;
    for (std::size_t length = second_line; length < whole.size(); length += 7) {
        std::ofstream(file(), std::ios::trunc) << whole.substr(0, length);
        const auto lines = std::count(whole.begin(), whole.begin() + std::ptrdiff_t(length), '\n');
        auto journal = Journal::open(folder_.path(), owner_);
        EXPECT_EQ(std::ptrdiff_t(journal.runs().size()), std::min<std::ptrdiff_t>(lines - 1, 2)) << length;
        journal.ask("weir", {"3 Pa.s", "sph"}, "cc");
        journal.sync();
        EXPECT_NO_THROW(Journal::read(folder_.path())) << length;
    }
}

TEST_F(JournalTest, AnotherStudysOrProgramsJournalIsRefused) {
    two_runs();
    EXPECT_NE(complaint_of([&] {
        Journal::open(folder_.path(), {"other", "program"});
    }).find("journal.jsonl:1: is the journal of another study"),
        std::string::npos);
    EXPECT_NE(complaint_of([&] {
        Journal::open(folder_.path(), {"study", "newer"});
    }).find("was written by program"),
        std::string::npos);
}

TEST_F(JournalTest, ALineThatWasChangedIsNamed) {
    two_runs();
    auto text = content();
    text.replace(text.find("weir") - 2, 4, "}}}}");
    std::ofstream(file(), std::ios::trunc) << text;
    EXPECT_NE(complaint_of([&] { Journal::open(folder_.path(), owner_); }).find("journal.jsonl:2: cannot be read"),
        std::string::npos);
    EXPECT_EQ(content(), text);
}

} // namespace
} // namespace treacle::study
