#include "base/timers.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <thread>

namespace {
std::atomic<long> allocations{0};
}

void* operator new(std::size_t size) {
    ++allocations;
    if (void* memory = std::malloc(size)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace treacle {
namespace {

TEST(PhaseTimers, AddsSecondsAndCallsPerPhase) {
    PhaseTimers timers;
    for (int i = 0; i < 3; ++i) {
        const auto scope = timers.scope("solve");
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    EXPECT_EQ(timers.calls("solve"), 3);
    EXPECT_GE(timers.seconds("solve"), 6e-3); // sleep_for never sleeps less
    EXPECT_EQ(timers.calls("other"), 0);
    EXPECT_EQ(timers.seconds("other"), 0);
}

TEST(PhaseTimers, AnInnerPhaseCountsInBoth) {
    PhaseTimers timers;
    {
        const auto outer = timers.scope("step");
        const auto inner = timers.scope("solve");
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    EXPECT_GE(timers.seconds("step"), timers.seconds("solve"));
    EXPECT_GE(timers.seconds("solve"), 2e-3);
    ASSERT_EQ(timers.phases().size(), 2u);
    EXPECT_EQ(timers.phases()[0].name, "step");
}

TEST(PhaseTimers, AllocatesAtTheFirstUseOnly) {
    PhaseTimers timers;
    { const auto scope = timers.scope("a phase whose name is longer than the small strings"); }
    const long before = allocations;
    { const auto scope = timers.scope("a phase whose name is longer than the small strings"); }
    EXPECT_EQ(allocations, before);
}

TEST(PhaseTimers, ResetKeepsTheNames) {
    PhaseTimers timers;
    { const auto scope = timers.scope("solve"); }
    timers.reset();
    EXPECT_EQ(timers.calls("solve"), 0);
    EXPECT_EQ(timers.seconds("solve"), 0);
    EXPECT_EQ(timers.phases().size(), 1u);
}

} // namespace
} // namespace treacle
