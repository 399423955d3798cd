#include "sample.hpp"
#include "study/model/points.hpp"

#include "../own_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

namespace treacle::study {
namespace {

const std::string two = "parameters:\n  - {name: eta, key: a.b, range: [1 Pa.s, 100 Pa.s], scale: log, points: 3}\n"
                        "  - {name: how, key: method.kind, values: [sph, grid]}\n";
const std::string ranges = "parameters:\n  - {name: eta, key: a.b, range: [1 Pa.s, 100 Pa.s], scale: log}\n"
                           "  - {name: size, key: a.c, range: [0, 1]}\n";

TEST(SweepPoints, AGridHasEveryCombinationTheLastFastest) {
    const auto points = sweep_points(study_of(header + two + "sweep: grid\n"));
    const std::vector<Point> expected{{"1 Pa.s", "sph"}, {"1 Pa.s", "grid"}, {"10 Pa.s", "sph"}, {"10 Pa.s", "grid"},
        {"100 Pa.s", "sph"}, {"100 Pa.s", "grid"}};
    EXPECT_EQ(points, expected);
}

TEST(SweepPoints, AListIsTakenAsItStands) {
    const auto points =
        sweep_points(study_of(header + two + "sweep: {design: list, rows: [\"3 Pa.s, sph\", \"4 Pa.s,grid\"]}\n"));
    EXPECT_EQ(points, (std::vector<Point>{{"3 Pa.s", "sph"}, {"4 Pa.s", "grid"}}));
    const auto complaint =
        complaint_of([] { sweep_points(study_of(header + two + "sweep: {design: list, rows: [\"3 Pa.s\"]}\n")); });
    EXPECT_NE(complaint.find("there are 2 parameters"), std::string::npos) << complaint;
}

TEST(SweepPoints, AFileGoesByTheNamesOfItsColumnsAndTheirUnits) {
    const test::OwnFolder folder;
    auto study = study_of(header + two + "sweep: {design: file, file: rows.csv}\n");
    study.path = folder.path() / "study.yaml";
    std::ofstream(folder.path() / "rows.csv") << "# mine\nnote,how,eta [Pa.s]\na,sph,3\nb,grid,40 P\n";
    EXPECT_EQ(sweep_points(study), (std::vector<Point>{{"3 Pa.s", "sph"}, {"40 P", "grid"}}));
    std::ofstream(folder.path() / "rows.csv") << "how\nsph\n";
    EXPECT_NE(complaint_of([&] { sweep_points(study); }).find("rows.csv:1: has no column eta"), std::string::npos);
    std::ofstream(folder.path() / "rows.csv") << "how,eta\nsph\n";
    EXPECT_NE(complaint_of([&] { sweep_points(study); }).find("rows.csv:2: has 1 values"), std::string::npos);
}

// Each of n equal parts of every range has one point.
TEST(SweepPoints, ALatinHypercubeHasAPointInEachPartOfEveryRange) {
    const auto study = study_of(header + ranges + "sweep: {design: latin_hypercube, runs: 20, seed: 3}\n");
    const auto points = sweep_points(study);
    ASSERT_EQ(points.size(), 20u);
    for (std::size_t p = 0; p < 2; ++p) {
        std::set<int> parts;
        for (const auto& point : points) {
            const double value = *study.parameters[p].number(point[p]);
            parts.insert(int(20 * (p == 0 ? std::log(value) / std::log(100.0) : value)));
        }
        EXPECT_EQ(parts.size(), 20u);
    }
    EXPECT_EQ(points, sweep_points(study));
    auto other = study;
    other.sweep.seed = 4;
    EXPECT_NE(points, sweep_points(other));
}

// Of the first 2^k points each half, quarter, ... of a range has its share; 1/n would be its error of the mean.
TEST(SweepPoints, ASobolSequenceFillsTheRangesEvenly) {
    const auto study = study_of(header + ranges + "sweep: {design: sobol, runs: 64}\n");
    const auto points = sweep_points(study);
    std::set<Point> different(points.begin(), points.end());
    EXPECT_EQ(different.size(), 64u);
    std::vector<int> counts(16, 0);
    for (const auto& point : points) {
        const double u = std::log(*study.parameters[0].number(point[0])) / std::log(100.0),
                     v = *study.parameters[1].number(point[1]);
        ++counts[std::size_t(std::min(3, int(4 * u)) * 4 + std::min(3, int(4 * v)))];
    }
    for (const int count : counts) EXPECT_NEAR(count, 4, 1);
    auto further = study;
    further.sweep.seed = 2;
    for (const auto& point : sweep_points(further)) EXPECT_FALSE(different.contains(point));
}

TEST(SweepPoints, DesignsThatNeedRangesSayWhichParameterHasNone) {
    const auto complaint =
        complaint_of([] { sweep_points(study_of(header + two + "sweep: {design: sobol, runs: 4}\n")); });
    EXPECT_NE(complaint.find("study.yaml:6: how has no range"), std::string::npos) << complaint;
    EXPECT_NE(complaint_of([] { sweep_points(study_of(header + two)); }).find("names no points"), std::string::npos);
}

} // namespace
} // namespace treacle::study
