#include "base/text/progress.hpp"
#include "file_content.hpp"

#include <gtest/gtest.h>
#include <regex>

namespace treacle {
namespace {

using test::content;

TEST(Progress, EndsWithALineForScriptsWhereThereIsNoTerminal) {
    std::FILE* file = std::tmpfile();
    Log log(LogOutput::enabled, file);
    Progress progress(log, "film", "frames");
    progress.report(1, 4); // too soon for a line
    progress.report(4, 4);
    EXPECT_EQ(content(file), "");
    progress.finish();
    const std::regex line(R"(progress film done=4 total=4 seconds=\d+(\.\d)? remaining=0\n)");
    EXPECT_TRUE(std::regex_match(content(file), line)) << content(file);
    std::fclose(file);
}

TEST(Progress, SaysNothingWhereNothingWasDoneOrOnOtherRanks) {
    std::FILE* file = std::tmpfile();
    Log log(LogOutput::enabled, file), silent(LogOutput::disabled, file);
    Progress(log, "film", "frames").finish();
    Progress other(silent, "film", "frames");
    other.report(1, 1);
    other.finish();
    EXPECT_EQ(content(file), "");
    std::fclose(file);
}

} // namespace
} // namespace treacle
