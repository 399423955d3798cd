#include "identify/compare/mismatch_sum.hpp"

#include <gtest/gtest.h>

namespace treacle::identify {
namespace {

const FilmMismatches front{4, {0.1, 0.2, 0.3, 0.4}, {0.04, 0.08, 0.12, 0.16}};
const FilmMismatches side{2, {0.15, 0.3}, {0.1, 0.02}};

TEST(MismatchSum, IsWhatTheFirstFrameAboveTheCutMakesIt) {
    EXPECT_FALSE(mismatch_bound({front}, 0.2)) << "a mean of .1";
    EXPECT_DOUBLE_EQ(*mismatch_bound({front}, 0.02), 0.03);
    EXPECT_DOUBLE_EQ(*mismatch_bound({front}, 0.03 - 1e-9), 0.03);
    EXPECT_DOUBLE_EQ(*mismatch_bound({front}, 0.03 + 1e-9), 0.06) << "a sum at the cut is not above it";
}

TEST(MismatchSum, AddsFilmsInTheOrderOfTime) {
    EXPECT_DOUBLE_EQ(*mismatch_bound({front, side}, 0.055), 0.06); // 0.01, then 0.05
    EXPECT_DOUBLE_EQ(*mismatch_bound({side, front}, 0.075), 0.08); // 0.02 more
    EXPECT_DOUBLE_EQ(*mismatch_bound({front, side}, 0.115), 0.12) << "of frames at one time the first film's";
}

TEST(MismatchSum, IsTheSameWheneverItIsAsked) {
    auto so_far = front;
    so_far.times.resize(2);
    so_far.mismatches.resize(2);
    so_far.next = 0.3;
    EXPECT_EQ(mismatch_bound({so_far, side}, 0.075), mismatch_bound({front, side}, 0.075));
    EXPECT_FALSE(mismatch_bound({so_far, side}, 0.084)) << "at 0.3 s a frame of the first film is missing";
    auto late = side;
    late.times.clear();
    late.mismatches.clear();
    late.next = 0.15;
    EXPECT_FALSE(mismatch_bound({front, late}, 0.02)) << "what follows 0.15 s is not looked at";
}

} // namespace
} // namespace treacle::identify
