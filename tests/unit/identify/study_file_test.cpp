#include "identify/report/report.hpp"

#include "../own_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace treacle::identify {
namespace {

class StudyFileTest : public testing::Test {
protected:
    StudyFile load(const std::string& text) const {
        const auto path = folder_.path() / "study.yaml";
        std::ofstream(path) << "schema_version: 1\nscenes:\n  - {name: slump, file: scene.yaml}\n" << text;
        return load_study_file(path);
    }
    std::string refusal(const std::string& text) const {
        try {
            load(text);
        } catch (const std::exception& error) {
            return error.what();
        }
        return "";
    }
    const test::OwnFolder folder_;
};

TEST_F(StudyFileTest, MeasuredValuesAndTheSpacingFollowTheParameters) {
    const auto file = load("parameters:\n  - {key: liquids.syrup.viscosity, range: [1 Pa.s, 9 Pa.s]}\n"
                           "measured:\n  - {key: liquids.syrup.density, value: 1.4 g/cm3, plus_minus: 0.02 g/cm3}\n"
                           "experiments:\n  - {masks: films/one}\nsearch: {rungs: [8 mm, 4 mm]}\n");
    EXPECT_EQ(file.searched, 1u);
    EXPECT_EQ(file.measured, 1u);
    EXPECT_TRUE(file.has_rungs());
    ASSERT_EQ(file.study.parameters.size(), 3u);
    EXPECT_EQ(file.study.parameters[1].word(1.42), "1.42 g/cm3");
    EXPECT_EQ(file.study.parameters[2].key, "domain.spacing");
    EXPECT_EQ(file.deviations, std::vector<double>{0.02});
    EXPECT_EQ(file.experiments[0].name, "one");
    EXPECT_EQ(file.scene_of(file.experiments[0]).name, "slump");
}

TEST_F(StudyFileTest, WithoutExperimentsMeasuredValuesStayAsTheyAre) {
    const auto file = load("measured:\n  - {key: liquids.syrup.density, value: 1.4 g/cm3, plus_minus: 0.02 g/cm3}\n");
    EXPECT_EQ(file.study.measured.size(), 1u);
    EXPECT_TRUE(file.study.parameters.empty());
}

TEST_F(StudyFileTest, ClipsOfOneSetUpAreRepeatsAndOneAloneIsSaidToBe) {
    const auto once = load("experiments:\n  - {masks: one, readout: 20 ms, plus_minus: {readout: 5 ms}}\n");
    EXPECT_DOUBLE_EQ(once.experiments[0].readout, 0.02);
    ASSERT_EQ(notes(once).size(), 1u);
    EXPECT_NE(notes(once)[0].find("Observed once: one."), std::string::npos);
    const auto thrice =
        load("experiments:\n  - {masks: one}\n  - {masks: two, repeats: one}\n  - {masks: three, repeats: one}\n");
    EXPECT_TRUE(notes(thrice).empty());
    EXPECT_NE(refusal("experiments:\n  - {masks: one}\n  - {masks: two, repeats: three}\n")
                  .find("must repeat an experiment above"),
        std::string::npos);
    EXPECT_NE(
        refusal("experiments:\n  - {masks: one}\n  - {masks: two, repeats: one}\n  - {masks: three, repeats: two}\n")
            .find("repeats another one itself"),
        std::string::npos);
    EXPECT_NE(refusal("experiments:\n  - {series: {file: front.csv, measurement: front}, readout: 20 ms}\n")
                  .find("belongs to masks"),
        std::string::npos);
}

TEST_F(StudyFileTest, WhatDoesNotFitIsRefused) {
    const std::string experiment = "experiments:\n  - {masks: m}\n";
    EXPECT_NE(
        refusal("experiments:\n  - {masks: m, scene: other}\n").find("there is no scene other"), std::string::npos);
    EXPECT_NE(refusal("experiments:\n  - {masks: m}\n  - {masks: n/m/}\n").find("m stands at"), std::string::npos);
    EXPECT_NE(refusal("experiments:\n  - {camera: c}\n").find("masks"), std::string::npos);
    EXPECT_NE(refusal(experiment + "search: {rungs: [4 mm, 8 mm]}\n").find("the coarsest first"), std::string::npos);
    EXPECT_NE(refusal(experiment + "search: {rungs: [8 mm, 0.4 kg]}\n").find("spacings as rungs"), std::string::npos);
    EXPECT_NE(refusal("parameters:\n  - {key: domain.spacing, range: [1 mm, 2 mm]}\n" + experiment +
                      "search: {rungs: [8 mm, 4 mm]}\n")
                  .find("sets it too"),
        std::string::npos);
}

TEST_F(StudyFileTest, RunsStopEarlyWhereTheObjectiveOnlyGrows) {
    const std::string parameter = "parameters:\n  - {key: liquids.syrup.viscosity, range: [1 Pa.s, 9 Pa.s]}\n",
                      masks = "experiments:\n  - {masks: m}\n";
    const auto stops = [&](const std::string& search) {
        return load(parameter + masks + "search: " + search + "\n").search.stops_early();
    };
    EXPECT_FALSE(stops("{method: cma_es}")) << "the best view of a run is known at its end";
    EXPECT_TRUE(stops("{method: cma_es, objective: mismatch}"));
    EXPECT_TRUE(stops("{method: dissertation, objective: mismatch, early_stop: true}"));
    EXPECT_FALSE(stops("{method: cma_es, objective: mismatch, early_stop: false}"));
    EXPECT_FALSE(stops("{method: gauss_newton, early_stop: true}"))
        << "studies that are written with all their values are read again";
    EXPECT_NE(refusal(masks + "search: {method: gauss_newton, objective: mismatch}\n").find("must be displacements"),
        std::string::npos);
    EXPECT_NE(refusal("experiments:\n  - {series: {file: front.csv, measurement: front}}\nsearch: {method: cma_es, "
                      "objective: mismatch}\n")
                  .find("must have objective: displacements"),
        std::string::npos);
}

TEST_F(StudyFileTest, OccupancyBelongsToMasks) {
    const auto file =
        load("experiments:\n  - {masks: m, occupancy: {windows: 6, levels: [0.2, 0.8], mirror: x, mirror_at: 1 cm}}\n");
    const auto& one = file.experiments.front();
    EXPECT_EQ(one.kind, ExperimentKind::occupancy);
    EXPECT_EQ(one.occupancy.windows, 6);
    EXPECT_EQ(one.occupancy.mirror, MirrorAxis::x);
    EXPECT_EQ(one.occupancy.mirror_at, 0.01);
    EXPECT_EQ(load("experiments:\n  - {masks: m}\n").experiments.front().kind, ExperimentKind::contours);
    EXPECT_NE(refusal("experiments:\n  - {series: {file: f.csv, measurement: front}, occupancy: {windows: 6}}\n")
                  .find("belongs to masks"),
        std::string::npos);
    EXPECT_NE(refusal("experiments:\n  - {masks: m, occupancy: {levels: [0.5, 0.2]}}\n")
                  .find("each higher than the one before"),
        std::string::npos);
    EXPECT_NE(refusal("experiments:\n  - {masks: m, occupancy: {windows: 1}}\n").find("windows"), std::string::npos);
}

TEST_F(StudyFileTest, RungsTakeTheUnitOfTheFirst) {
    const auto file = load("experiments:\n  - {masks: m}\nsearch: {rungs: [8 mm, 0.4 cm]}\n");
    EXPECT_EQ(file.search.rungs, (std::vector<std::string>{"8 mm", "4 mm"}));
    EXPECT_EQ(file.study.parameters.back().values, file.search.rungs);
}

TEST_F(StudyFileTest, ATemperatureEntersByWhatAKelvinDoes) {
    const std::string experiment = "experiments:\n  - {masks: m}\n";
    const auto file = load(experiment + "temperature: {value: 22.5 C, plus_minus: 0.5 C, per_kelvin: -8 %}\n");
    EXPECT_NEAR(file.temperature.deviation(), 0.04, 1e-12);
    EXPECT_EQ(load(experiment).temperature.deviation(), 0);
    EXPECT_NE(refusal(experiment + "temperature: {value: 22.5 C}\n").find("must be given with plus_minus"),
        std::string::npos);
    EXPECT_NE(refusal(experiment + "temperature: {value: 22.5 F, plus_minus: 1 F}\n").find("the unit C or K"),
        std::string::npos);
    EXPECT_NE(
        refusal(experiment + "temperature: {per_kelvin: 5 %}\n").find("no temperature is stated"), std::string::npos);
}

TEST_F(StudyFileTest, AQuickStudyHasTwoRungsAndVariesNoMeasuredValue) {
    auto file =
        load("measured:\n  - {key: liquids.syrup.density, value: 1.4 g/cm3, plus_minus: 0.02 g/cm3, exponent: 1}\n"
             "experiments:\n  - {masks: m}\nsearch: {rungs: [8 mm, 6 mm, 4 mm], evaluations: 30}\n");
    EXPECT_EQ(file.exponents, std::vector<double>{1});
    file.make_quick();
    EXPECT_EQ(file.study.parameters.back().values, (std::vector<std::string>{"8 mm", "4 mm"})); // 6 mm is too near
    EXPECT_EQ(file.search.rungs, file.study.parameters.back().values);
    EXPECT_EQ(file.deviations, std::vector<double>{0});
    EXPECT_EQ(file.search.evaluations, 10);
    EXPECT_EQ(file.search.noise_runs, 1);
}

TEST_F(StudyFileTest, IdentifiabilityIsSaidInWords) {
    const auto file = load("parameters:\n  - {key: liquids.syrup.viscosity, range: [1 Pa.s, 100 Pa.s], scale: "
                           "log}\nexperiments:\n  - {masks: m}\n");
    const auto words = [&](double low, double value, double high) {
        Identification found;
        found.values = {value};
        found.low = {low};
        found.high = {high};
        return identifiability(file, found, 0);
    };
    EXPECT_EQ(words(9, 10, 11), "well determined");
    EXPECT_EQ(words(3, 10, 30).substr(0, 6), "poorly");
    EXPECT_NE(words(0.2, 10, 300).find("not identifiable"), std::string::npos);
    EXPECT_NE(words(0.5, 3, 9).find("an upper limit alone"), std::string::npos);
    EXPECT_NE(words(30, 60, 110).find("a lower limit alone"), std::string::npos);
    EXPECT_NE(words(0.9, 1.01, 1.1).find("at the lower end"), std::string::npos);
    EXPECT_NE(words(90, 99, 110).find("at the upper end"), std::string::npos);
}

TEST(ViewInformation, IsTheInverseOfTheVariances) {
    ViewUncertainty uncertainty;
    uncertainty.time_zero = 0.1;
    uncertainty.turn = 0.01;
    const auto without = information_of(uncertainty, {}, 0);
    EXPECT_NEAR(without(view_time, view_time), 100, 1e-9);
    EXPECT_NEAR(without(view_turn + 1, view_turn + 1), 1e4, 1e-6);
    Eigen::Matrix<double, 6, 6> pose = Eigen::Matrix<double, 6, 6>::Identity() * 4e-6;
    pose(0, 1) = pose(1, 0) = 1e-6;
    const auto with = information_of(uncertainty, pose, 0.002);
    EXPECT_NEAR(with(view_focal, view_focal), 250000, 1e-3);
    EXPECT_TRUE((with.block<6, 6>(view_turn, view_turn) * pose).isIdentity(1e-6));
}

} // namespace
} // namespace treacle::identify
