#include "../own_folder.hpp"
#include "base/text/csv.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <sys/resource.h>
#include <unistd.h>

namespace treacle {
namespace {

class CsvTest : public testing::Test {
protected:
    std::string content() const {
        std::ifstream file(path_);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    void write(const std::string& text) const { std::ofstream(path_) << text; }

    const std::vector<std::string> columns_{"step", "time [s]"};
    const test::OwnFolder own_;
    const std::filesystem::path& folder_ = own_.path();
    const std::filesystem::path path_ = folder_ / "steps.csv";
};

TEST_F(CsvTest, RowsHaveFullPrecision) {
    auto table = CsvTable::create(path_, columns_);
    table.append(std::vector{0.0, 1.0 / 3});
    table.append(std::vector{1.0, 1e-300});
    table.flush();
    EXPECT_EQ(content(), "step,time [s]\n0," + format_number(1.0 / 3) + "\n1,1e-300\n");
}

TEST_F(CsvTest, CreatingReplacesAnOldTable) {
    write("old\n1\n");
    CsvTable::create(path_, columns_);
    EXPECT_EQ(content(), "step,time [s]\n");
}

TEST_F(CsvTest, ResumingDropsLaterAndCutOffRowsAndGoesOn) {
    write("step,time [s]\n0,0\n1,0.1\n2,0.2\n3,0.3\n2,0.");
    auto table = CsvTable::resume(path_, columns_, 2);
    table.append(std::vector{3.0, 0.35});
    table.flush();
    EXPECT_EQ(content(), "step,time [s]\n0,0\n1,0.1\n2,0.2\n3,0.35\n");
}

TEST_F(CsvTest, ResumingKnowsTheLastRowThatItKept) {
    write("step,time [s]\n0,0\n1,nan\n2,0.2\n");
    const auto table = CsvTable::resume(path_, columns_, 1);
    ASSERT_EQ(table.last_row().size(), 2u);
    EXPECT_EQ(table.last_row()[0], 1);
    EXPECT_NE(table.last_row()[1], table.last_row()[1]);
    EXPECT_TRUE(CsvTable::resume(path_, columns_, -1).last_row().empty());
}

TEST_F(CsvTest, RowsAreInTheFileOnceTheyAreSynced) {
    auto table = CsvTable::create(path_, columns_);
    table.append(std::vector{0.0, 0.5});
    EXPECT_EQ(content(), "step,time [s]\n"); // in memory
    table.sync();
    EXPECT_EQ(content(), "step,time [s]\n0,0.5\n");
}

TEST_F(CsvTest, ResumingWithoutAFileStartsOne) {
    CsvTable::resume(path_, columns_, 7);
    EXPECT_EQ(content(), "step,time [s]\n");
}

TEST_F(CsvTest, ResumingAnotherTableIsAnInputErrorAndLeavesIt) {
    const std::string old = "step,mass [kg]\n0,1\n";
    write(old);
    try {
        CsvTable::resume(path_, columns_, 2);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("steps.csv:1: the header is not"), std::string::npos);
    }
    EXPECT_EQ(content(), old);
}

TEST_F(CsvTest, AColumnNameWithACommaIsRejected) {
    EXPECT_THROW(CsvTable::create(path_, {"a,b"}), InputError);
    EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(CsvTest, ARowOfAnotherLengthIsRejected) {
    auto table = CsvTable::create(path_, columns_);
    EXPECT_THROW(table.append(std::vector{1.0}), std::invalid_argument);
}

TEST_F(CsvTest, AFolderThatIsNotThereIsASimulationError) {
    EXPECT_THROW(CsvTable::create(folder_ / "no" / "steps.csv", columns_), SimulationError);
}

// RLIMIT_FSIZE makes writes beyond it fail as on a full disk, with another errno.
TEST_F(CsvTest, AWriteThatFailsIsASimulationError) {
    auto table = CsvTable::create(path_, columns_);
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit old{};
    getrlimit(RLIMIT_FSIZE, &old);
    const rlimit small{100, old.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    const auto fill = [&] {
        for (int i = 0; i < 100; ++i) table.append(std::vector{1.0, 0.1});
        table.flush();
    };
    EXPECT_THROW(fill(), SimulationError);
    setrlimit(RLIMIT_FSIZE, &old);
}

} // namespace
} // namespace treacle
