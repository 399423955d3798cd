#include "base/text/floating_point_traps.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <limits>

namespace treacle {
namespace {

// Numbers that the compiler does not know.
double hidden(double value) {
    volatile double out = value;
    return out;
}

void keep(double value) { [[maybe_unused]] volatile double out = value; }

TEST(FloatingPointTraps, end_the_process_where_a_number_is_not_finite) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto dies = testing::KilledBySignal(SIGFPE);
    EXPECT_EXIT((trap_non_finite(), keep(hidden(0) / hidden(0))), dies, "an invalid floating-point operation");
    EXPECT_EXIT((trap_non_finite(), keep(hidden(1) / hidden(0))), dies, "a floating-point division by zero");
    EXPECT_EXIT((trap_non_finite(), keep(hidden(1e300) * hidden(1e300))), dies, "a floating-point overflow");
}

TEST(FloatingPointTraps, leave_finite_numbers_and_infinities_that_are_copied) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto ends_well = testing::ExitedWithCode(0);
    EXPECT_EXIT((trap_non_finite(), keep(hidden(1) / hidden(3)), keep(hidden(std::numeric_limits<double>::infinity())),
                    std::exit(0)),
        ends_well, "");
}

} // namespace
} // namespace treacle
