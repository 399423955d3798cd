#include "identify/compare/series_comparison.hpp"

#include "../own_folder.hpp"
#include "../refusal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace treacle::identify {
namespace {

class SeriesTest : public testing::Test {
protected:
    std::filesystem::path write(const std::string& text) const {
        std::ofstream(folder_.path() / "front.csv") << text;
        return folder_.path() / "front.csv";
    }
    std::string said(const std::string& text) const {
        return test::refusal([&] { observed_values(experiment_, write(text), "m"); });
    }
    Experiment experiment_;
    const test::OwnFolder folder_;
};

TEST_F(SeriesTest, ValuesAreInTheRunsUnitAndTime) {
    experiment_.time_zero = 0.5;
    experiment_.from = 0.09;
    experiment_.every = 2;
    const auto values = observed_values(
        experiment_, write("time [ms],value [cm],plus_minus [mm]\n500,1,1\n600,2,1\n700,3,1\n800,4,0.5\n"), "m");
    ASSERT_EQ(values.size(), 2u);
    EXPECT_EQ(values[1].number, 3);
    EXPECT_NEAR(values[1].time, 0.3, 1e-12);
    EXPECT_NEAR(values[1].value, 0.04, 1e-15);
    EXPECT_NEAR(values[1].deviation, 5e-4, 1e-15);
}

TEST_F(SeriesTest, ResidualsAreInDeviationsWithTheirDerivatives) {
    const std::vector<ObservedValue> observed{{0, 0.15, 0.30, 0.01}, {1, 0.4, 0.8, 0.01}, {2, 0.6, 9, 0.01}};
    const auto found = compare_series(observed, {0.1, 0.2, 0.5}, {0.2, 0.4, 1.0});
    EXPECT_NEAR(found.segments[0].displacement, 0, 1e-12);
    EXPECT_NEAR(found.segments[1].displacement, 0, 1e-12);
    EXPECT_EQ(found.segments[2].points, 0); // beyond the run
    EXPECT_TRUE(std::isnan(found.segments[2].displacement));
    EXPECT_NEAR(found.segments[0].by_view[series_time], -2 / 0.01, 1e-9);
    EXPECT_NEAR(found.segments[1].by_view[series_offset], -100, 1e-9);
    EXPECT_NEAR(found.segments[1].by_view[series_scale], -80, 1e-9);
    const auto late = compare_series({{0, 0.15 + 0.02, 0.30, 0.01}}, {0.1, 0.2, 0.5}, {0.2, 0.4, 1.0});
    EXPECT_NEAR(late.segments[0].displacement + 0.02 * late.segments[0].by_view[series_time], 0, 1e-9);
}

TEST_F(SeriesTest, WhatIsWrongIsSaidWithItsLine) {
    EXPECT_NE(said("time [s],value,plus_minus [m]\n0,1,1\n").find("front.csv:1: column value has no unit"),
        std::string::npos);
    EXPECT_NE(said("time [s],value [s],plus_minus [m]\n0,1,1\n").find("is not in a unit of m"), std::string::npos);
    EXPECT_NE(said("time [s],front [m],plus_minus [m]\n0,1,1\n").find("has no column value"), std::string::npos);
    EXPECT_NE(said("time [s],value [m],plus_minus [m]\n0,1,1\n1,1,0\n").find("front.csv:3: plus_minus must be > 0"),
        std::string::npos);
    experiment_.from = 5;
    EXPECT_NE(said("time [s],value [m],plus_minus [m]\n0,1,1\n").find("no value is between"), std::string::npos);
}

} // namespace
} // namespace treacle::identify
