#include "base/text/log.hpp"
#include "file_content.hpp"

#include <gtest/gtest.h>

namespace treacle {
namespace {

using test::content;

TEST(Log, WritesLinesAndWarnings) {
    std::FILE* file = std::tmpfile();
    Log log(LogOutput::enabled, file);
    log.line("one");
    log.warn("two");
    EXPECT_EQ(content(file), "one\nwarning: two\n");
    std::fclose(file);
}

TEST(Log, DrawsNoBarIntoAFile) {
    std::FILE* file = std::tmpfile();
    {
        Log log(LogOutput::enabled, file);
        EXPECT_FALSE(log.is_terminal());
        log.progress(0.5, "half");
    }
    EXPECT_EQ(content(file), "");
    std::fclose(file);
}

TEST(Log, IsSilentOnOtherRanks) {
    std::FILE* file = std::tmpfile();
    Log log(LogOutput::disabled, file);
    log.line("one");
    log.warn("two");
    EXPECT_EQ(content(file), "");
    std::fclose(file);
}

TEST(ProgressBar, HasTheSameLengthAtAnyShare) {
    const auto half = progress_bar(0.5, "");
    EXPECT_EQ(half, "[###############...............]  50 %  ");
    for (const double fraction : {0.0, 1.0, -3.0, 7.0, 0.0 / 0.0}) {
        EXPECT_EQ(progress_bar(fraction, "").size(), half.size()) << fraction;
    }
}

} // namespace
} // namespace treacle
