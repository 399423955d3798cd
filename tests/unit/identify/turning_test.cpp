#include "identify/compare/turning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace treacle::identify {
namespace {

constexpr double frequency = 5.7, frame = 0.01; // [Hz], [s]

// From the side: a thread 9 px wide down to row 70 whose lower end goes round by `swing` px, on a heap of rows 70 to 90.
video::Mask thread_at(double time, double swing, double sense = 1) {
    video::Mask out{160, 100, std::vector<std::uint8_t>(16000, video::mask_background)};
    for (int r = 10; r < 90; ++r) {
        const double middle = 80 + sense * swing * std::sin(2 * std::numbers::pi * frequency * time + 0.3) *
                                       std::max(0.0, (r - 40) / 30.0);
        for (int c = 0; c < 160; ++c) {
            const bool heap = r >= 70 && std::abs(c - 80) <= 40;
            if (heap || (r < 70 && std::abs(c - middle) <= 4.5))
                out.pixels[std::size_t(r * 160 + c)] = video::mask_liquid;
        }
    }
    return out;
}

Turning turning(double swing, double sense = 1) {
    std::vector<double> times, positions;
    for (int k = 0; k < 100; ++k) {
        times.push_back(frame * k);
        positions.push_back(thread_column(thread_at(times.back(), swing, sense)));
    }
    return turning_of(times, positions);
}

TEST(ThreadPlace, IsItsMiddleAboveTheHeap) {
    const auto straight = thread_at(0, 0);
    EXPECT_NEAR(thread_column(straight), 80, 0.5);
    // Rows 49 to 64 of 70, by (r - 40) / 30 of the swing at the heap.
    const double swing = 12 * std::sin(0.3);
    EXPECT_NEAR(thread_column(thread_at(0, 12)), 80 + swing * (56.5 - 40) / 30, 0.5);
    EXPECT_TRUE(std::isnan(thread_column({8, 8, std::vector<std::uint8_t>(64, video::mask_background)})));
}

TEST(Turning, HasTheFrequencyOfAThreadThatGoesRound) {
    const auto rate = rate_between(turning(12), 0, 1);
    EXPECT_NEAR(rate.turns, 5, 1e-9);                    // 11 passages
    EXPECT_NEAR(rate.rate, frequency, 0.01 * frequency); // pixels and frames
    EXPECT_LT(turning(12).scatter, 0.03);
    EXPECT_NEAR(rate_between(turning(12), 0.3, 0.5).rate, frequency, 0.03 * frequency);
}

TEST(Turning, IsTheSameTheOtherWayRound) {
    const auto one = rate_between(turning(12), 0, 1), other = rate_between(turning(12, -1), 0, 1);
    EXPECT_NEAR(one.turns, other.turns, 0.01);
    EXPECT_NEAR(one.rate, other.rate, 1e-3 * one.rate);
}

TEST(Turning, OfAThreadThatStandsIsNone) {
    EXPECT_EQ(rate_between(turning(0), 0, 1).rate, 0);
    EXPECT_EQ(rate_between(turning(12), 0.95, 1.2).rate, 0); // no more seen
}

TEST(Turning, ScattersAsItsTurnsDo) {
    std::vector<double> times, positions;
    for (int k = 0; k < 1000; ++k) { // half turns of 0.08 and 0.12 s: turns are alike
        times.push_back(1e-3 * k);
        const double phase = std::fmod(times.back(), 0.2);
        positions.push_back(phase < 0.08 ? std::sin(std::numbers::pi * phase / 0.08)
                                         : -std::sin(std::numbers::pi * (phase - 0.08) / 0.12));
    }
    const auto found = turning_of(times, positions);
    EXPECT_LT(found.scatter, 0.01);
    EXPECT_NEAR(rate_between(found, 0, 1).rate, 5, 0.15);
    for (std::size_t k = 500; k < 1000; ++k)
        positions[k] = std::sin(2 * std::numbers::pi * 7.5 * (times[k] - 0.5)); // a half faster
    EXPECT_NEAR(turning_of(times, positions).scatter, 0.2, 0.1); // few turns of 0.2 and 0.13 s, and one between them
}

} // namespace
} // namespace treacle::identify
