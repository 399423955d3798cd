#include "sample.hpp"
#include "study/model/readings.hpp"

#include "../own_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace treacle::study {
namespace {

TEST(StudyFile, ParametersHaveNumbersUnitsAndScales) {
    const auto study = study_of(header + "parameters:\n"
                                         "  - {key: liquids.honey.viscosity, range: [0.1 Pa.s, 100 Pa.s], scale: log}\n"
                                         "  - {name: how, key: method.kind, values: [sph, grid]}\n");
    const auto& viscosity = study.parameters[0];
    EXPECT_EQ(viscosity.name, "viscosity");
    EXPECT_EQ(viscosity.column(), "viscosity [Pa.s]");
    EXPECT_DOUBLE_EQ(viscosity.at(1.0 / 3), 1.0);
    EXPECT_EQ(viscosity.at(1), 100);
    EXPECT_EQ(viscosity.word(12.5), "12.5 Pa.s");
    EXPECT_EQ(viscosity.number("12.5 Pa.s"), 12.5);
    EXPECT_FALSE(viscosity.number("12.5 cP"));
    EXPECT_FALSE(study.parameters[1].numeric);
}

TEST(StudyFile, NumbersAreReadWithWhateverUnitStandsBehindThem) {
    const auto number = read_number_and_unit("1.5e-3 m2/s");
    ASSERT_TRUE(number);
    EXPECT_EQ(number->value, 1.5e-3);
    EXPECT_EQ(number->unit, "m2/s");
    EXPECT_EQ(read_number_and_unit("2e")->unit, "e");
    EXPECT_FALSE(read_number_and_unit("sph"));
    EXPECT_FALSE(read_number_and_unit("inf Pa.s"));
}

struct Refusal {
    std::string text, told;
};

TEST(StudyFile, WhatCannotBeMeantIsRefusedAtItsLine) {
    for (const auto& [text, told] : std::vector<Refusal>{
             {"parameters:\n  - {key: a.b, range: [1 Pa.s]}\n", "must be a lower and an upper end"},
             {"parameters:\n  - {key: a.b, range: [2, 1]}\n", "must have its lower end first"},
             {"parameters:\n  - {key: a.b, range: [1 mm, 2 kg]}\n", "must have units of one dimension"},
             {"parameters:\n  - {key: a.b, values: [1, 2 cm]}\n", "must have units of one dimension"},
             {"parameters:\n  - {key: a.b, range: [0, 2], scale: log}\n", "must be above 0"},
             {"parameters:\n  - {key: a.b, range: [1, 2], start: 3}\n", "must lie in the range"},
             {"parameters:\n  - {name: p, key: a.b, range: [1, 2]}\n  - {name: q, key: a.b, range: [1, 2]}\n",
                 "is set at study.yaml:5 too"},
             {"parameters:\n  - {key: a.b, range: [1, 2]}\n  - {key: c.b, range: [1, 2]}\n",
                 "b stands at study.yaml:5 too"},
             {"measured:\n  - {key: a.b, value: 1 g/cm3, plus_minus: 1 kg/m3}\n", "must have the unit of the value"},
             {"read:\n  - {measurement: front, table: steps, column: a}\n", "must be given, or a table"},
             {"read:\n  - {measurement: front, time: 3}\n", "has no effect"},
             {"sweep: {design: sobol}\n", "must be given"},
             {"runs: {ranks: 0}\n", "must be >= 1"},
             {"lanes: 2\n", "lanes"},
         }) {
        const auto complaint = complaint_of([&] { study_of(header + text); });
        EXPECT_NE(complaint.find("study.yaml:"), std::string::npos) << text << complaint;
        EXPECT_NE(complaint.find(told), std::string::npos) << text << complaint;
    }
}

TEST(StudyFile, ValuesOfOneDimensionTakeTheUnitOfTheFirst) {
    const auto study = study_of(
        header +
        "parameters:\n  - {key: a.b, values: [5 mm, 1 cm, 1.5e-2 m]}\n  - {key: a.c, range: [100 cP, 2 Pa.s]}\n");
    const auto& values = study.parameters[0];
    EXPECT_EQ(values.values, (std::vector<std::string>{"5 mm", "10 mm", "15 mm"}));
    EXPECT_EQ(values.column(), "b [mm]");
    EXPECT_EQ(values.number(values.values[1]), 10);
    EXPECT_EQ(study.parameters[1].lower, 100);
    EXPECT_EQ(study.parameters[1].upper, 2000);
    EXPECT_EQ(study.parameters[1].range[1], "2000 cP");
}

TEST(Readings, StatisticsOverTimeLeaveEmptyRowsOut) {
    const double none = std::nan("");
    const std::vector<double> t{0, 1, 2, 4}, v{0, none, 4, 8};
    EXPECT_EQ(statistic(t, v, Statistic::last), 8);
    EXPECT_EQ(statistic(t, v, Statistic::first), 0);
    EXPECT_EQ(statistic(t, v, Statistic::max), 8);
    EXPECT_EQ(statistic(t, v, Statistic::mean), (2 * 2 + 2 * 6) / 4.0);
    EXPECT_EQ(statistic(t, v, Statistic::at_time, 3), 6);
    EXPECT_EQ(statistic(t, v, Statistic::at_time, 9), 8);
    EXPECT_TRUE(std::isnan(statistic({0}, {none}, Statistic::last)));
}

TEST(Readings, FiguresComeFromTheTablesOfARun) {
    const test::OwnFolder folder;
    std::ofstream(folder.path() / "measurements.csv")
        << "step,time [s],front [m],height [m]\n0,0,1,5\n1,1,2,4\n2,2,3,3\n3,3,9";
    std::ofstream(folder.path() / "steps.csv") << "step,time [s],maximum speed [m/s]\n1,1,7\n2,2,6\n";
    const auto all = read_figures(study_of(header), folder.path());
    ASSERT_EQ(all.size(), 2u); // the row that was cut off is none
    EXPECT_EQ(all[0].name, "front [m]");
    EXPECT_EQ(all[0].value, 3);
    const auto some =
        read_figures(study_of(header + "read:\n  - {name: way, measurement: front, at: time, time: 1.5 s}\n"
                                       "  - {table: steps, column: maximum speed, at: max}\n"),
            folder.path());
    ASSERT_EQ(some.size(), 2u);
    EXPECT_EQ(some[0].name, "way [m]");
    EXPECT_EQ(some[0].value, 2.5);
    EXPECT_EQ(some[1].name, "maximum speed [m/s]");
    EXPECT_EQ(some[1].value, 7);
    const auto complaint = complaint_of(
        [&] { read_figures(study_of(header + "read:\n  - {table: steps, column: maximum sped}\n"), folder.path()); });
    EXPECT_NE(complaint.find("has no column maximum sped"), std::string::npos) << complaint;
}

} // namespace
} // namespace treacle::study
