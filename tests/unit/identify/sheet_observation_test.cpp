#include "identify/compare/sheet_observation.hpp"

#include "../own_folder.hpp"
#include "../refusal.hpp"
#include "identify/compare/ball_track.hpp"
#include "identify/experiment/study_file.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace treacle::identify {
namespace {

class SheetTest : public testing::Test {
protected:
    void write(const std::string& name, const std::string& text) const { std::ofstream(folder_.path() / name) << text; }

    // A field of 6 x 5 vectors, with y downwards in pixels of 0.1 mm and displacements over 1 ms.
    void write_field(const std::string& name, double u, const char* head = "# x y u v flags mask\n") const {
        std::string text = head;
        for (int i = 0; i < 30; ++i) {
            text += std::to_string(10 * (i % 6)) + "\t" + std::to_string(10 * (i / 6)) + "\t" +
                    (i == 7 ? "nan" : std::to_string(u)) + "\t" + (i == 15 ? "-9" : "2") + "\t0\t0\n";
        }
        write(name, text);
    }
    Experiment experiment(const std::string& keys, const std::string& outer = "") const {
        write("study.yaml", "schema_version: 1\nscenes: [{file: scene.yaml}]\nexperiments:\n  - piv: {" + keys +
                                "}\n    " + outer + "\n");
        return load_study_file(folder_.path() / "study.yaml").experiments.front();
    }
    ObservedSheet observe(const Experiment& one, const Touches& touches = {}) const {
        return observe_sheet(
            one, [&](const std::string& name) { return folder_.path() / name; }, touches);
    }
    const std::string position_ =
        "origin: [0.1, 0, 0.2], right: [1, 0, 0], up: [0, 0, 1], y: down, window: 2 mm, noise: 10 mm/s";
    const std::string scale_ = ", pixel: 0.1 mm, pair_interval: 1 ms";
    const test::OwnFolder folder_;
};

TEST_F(SheetTest, FieldsAreInTheSheetsAxesAndOutliersAreCounted) {
    for (int f = 0; f < 4; ++f) write_field("f" + std::to_string(f) + ".txt", 1 + 0.01 * f);
    const auto one = experiment("files: [\"f*.txt\"], interval: 20 ms, " + position_ + scale_, "from: 10 ms");
    EXPECT_EQ(one.kind, ExperimentKind::piv);
    EXPECT_EQ(one.name, "piv");
    const auto sheet = observe(one);
    ASSERT_EQ(sheet.fields.size(), 3u);
    EXPECT_EQ(sheet.fields[0].number, 1);
    EXPECT_DOUBLE_EQ(sheet.fields[0].time, 0.02);
    EXPECT_EQ(sheet.counts.vectors, 90u);
    EXPECT_EQ(sheet.counts.missing, 3u);
    EXPECT_EQ(sheet.counts.outliers, 3u);
    EXPECT_EQ(sheet.counts.kept(), 84u);
    const auto& last = sheet.fields[0].vectors.back();
    EXPECT_NEAR(last.x, 5e-3, 1e-12);
    EXPECT_NEAR(last.y, -4e-3, 1e-12);
    EXPECT_NEAR(last.u, 0.101, 1e-9);
    EXPECT_NEAR(last.v, -0.2, 1e-9); // v as y
    const auto point = one.piv.point(last.x, last.y);
    EXPECT_NEAR(point[0], 0.105, 1e-12);
    EXPECT_NEAR(point[2], 0.196, 1e-12);
    EXPECT_NEAR(observe(experiment("files: [\"f*.txt\"], interval: 20 ms, v: up, " + position_ + scale_))
                    .fields[0]
                    .vectors.back()
                    .v,
        0.2, 1e-9);
}

TEST_F(SheetTest, MasksAndTheMeasuredBallTakeVectorsAway) {
    write_field("f.txt", 1);
    const auto one = experiment(
        "files: [f.txt], interval: 1 s, mask: [{box: {min: [0.1045, -1, -1], max: [1, 1, 1]}}], " + position_ + scale_);
    const auto sheet = observe(one, [](const Vec3& x, double) { return x[2] < 0.1965; });
    EXPECT_EQ(sheet.counts.masked, 5u);
    EXPECT_EQ(sheet.counts.touching, 5u);
    EXPECT_EQ(sheet.counts.kept(), 18u);
}

TEST_F(SheetTest, WhatIsMissingIsSaidWithItsPlaceAndCure) {
    write_field("f.txt", 1);
    const auto said = [&](const std::string& keys, const std::string& outer = "") {
        return test::refusal([&] { observe(experiment(keys, outer)); });
    };
    EXPECT_NE(said("files: [f.txt], interval: 1 s, " + position_).find("study.yaml:4"), std::string::npos);
    EXPECT_NE(said("files: [f.txt], interval: 1 s, " + position_).find("does not say its units"), std::string::npos);
    EXPECT_NE(said("files: [f.txt], " + position_ + scale_).find("interval"), std::string::npos);
    EXPECT_NE(
        said("files: [g*.txt], interval: 1 s, " + position_ + scale_).find("g*.txt is not there"), std::string::npos);
    EXPECT_NE(said("files: [f.txt], interval: 1 s, " + position_ + scale_, "from: 2 s").find("no field is between"),
        std::string::npos);
    for (const char* key : {"right", "up", "y", "window", "noise"}) {
        EXPECT_NE(said("files: [f.txt], interval: 1 s, origin: [0, 0, 0]" + scale_)
                      .find("piv." + std::string(key) + " is missing"),
            std::string::npos)
            << key;
    }
    EXPECT_NE(
        said("files: [f.txt], interval: 1 s, " + position_ + scale_, "masks: film").find("masks"), std::string::npos);
}

TEST_F(SheetTest, TheBallsTrackIsInTheFieldsAxesWithUnits) {
    write("track.csv", "time [ms],x [px],y [px],plus_minus [mm]\n0,10,20,0\n20,10,30,0\n40,10,50,0\n");
    Sheet sheet;
    sheet.origin = {0.1, 0, 0.2};
    sheet.y = Upward::down;
    sheet.pixel = 1e-4;
    const BallTrack track(sheet, folder_.path() / "track.csv");
    EXPECT_NEAR(track.at(0.02)[0], 0.101, 1e-12);
    EXPECT_NEAR(track.at(0.02)[2], 0.197, 1e-12);
    EXPECT_DOUBLE_EQ(track.last(), 0.04);
    const auto said = [&](const std::string& text) {
        write("bad.csv", text);
        return test::refusal([&] { BallTrack(sheet, folder_.path() / "bad.csv"); });
    };
    EXPECT_NE(said("time,x [px],y [px],plus_minus [mm]\n0,1,1,1\n").find("bad.csv:1: column time has no unit"),
        std::string::npos);
    EXPECT_NE(said("time [s],x [px],y [px]\n0,1,1\n").find("no column plus_minus"), std::string::npos);
    EXPECT_NE(
        said("time [s],x [px],y [px],plus_minus [mm]\n0,1,1,1\n0,1,1,1\n").find("times that grow"), std::string::npos);
}

} // namespace
} // namespace treacle::identify
