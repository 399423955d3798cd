#include "video/piv/piv_field.hpp"

#include "../own_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

namespace treacle::video {
namespace {

class PivFieldTest : public testing::Test {
protected:
    PivField read(const std::string& text) const {
        std::ofstream(path_) << text;
        return read_piv_text(path_);
    }
    std::string refusal(const std::string& text) const {
        try {
            read(text);
        } catch (const std::exception& error) {
            return error.what();
        }
        return "";
    }
    static std::string unit_refusal(const PivField& field, const PivScale& scale) {
        try {
            in_si(field, scale, "piv.txt");
        } catch (const std::exception& error) {
            return error.what();
        }
        return "";
    }
    const test::OwnFolder folder_;
    const std::filesystem::path path_ = folder_.path() / "piv.txt";
};

TEST_F(PivFieldTest, DavisHasUnitsDecimalCommasAndZerosForWhatWasNotMeasured) {
    const auto field =
        read("#DaVis 8.1.6 2D-vector 32 2 2 \"position\" \"mm\" \"position\" \"mm\" \"velocity\" \"m/s\"\n"
             "-14,9635\t32,4113\t0\t-0\n-14,3424\t32,4113\t0,25\t-1,5e-1\n");
    EXPECT_EQ(field.format, "DaVis");
    EXPECT_EQ(field.x, (std::vector{-14.9635, -14.3424}));
    EXPECT_EQ(field.valid, (std::vector<std::uint8_t>{0, 1}));
    const auto si = in_si(field, {}, "piv.txt");
    EXPECT_NEAR(si.x[1], -0.0143424, 1e-12);
    EXPECT_EQ(si.u[1], 0.25);
    EXPECT_EQ(si.v[1], -0.15);
}

TEST_F(PivFieldTest, InsightHasItsVariablesInTheTitleAndItsVerdictInTheLastColumn) {
    const auto field = read("TITLE=\"C:\\a b.vec\" VARIABLES=\"X pixel\", \"Y pixel\", \"U pixel\", \"V pixel\", "
                            "\"CHC\", DATASETAUXDATA Application=\"PIV\" "
                            "ZONE I=2, J=1, F=POINT\n1539.0, 1546.0, 0.5, -0.25, -1\n1571.0, 1546.0, -2.0, 1.0, 1\n");
    EXPECT_EQ(field.format, "Insight");
    EXPECT_EQ(field.length_unit, "pixel");
    EXPECT_EQ(field.valid, (std::vector<std::uint8_t>{0, 1}));
    const auto si = in_si(field, {1e-4, 0.01}, "piv.txt");
    EXPECT_NEAR(si.x[1], 0.1571, 1e-12);
    EXPECT_NEAR(si.u[1], -0.02, 1e-12);
    EXPECT_NE(unit_refusal(field, {}).find("whose size is not given"), std::string::npos);
    EXPECT_NE(unit_refusal(field, {1e-4, 0}).find("the interval of the frames is not given"), std::string::npos);
}

TEST_F(PivFieldTest, OpenPivMarksByNanFlagsAndMask) {
    const auto field = read("# "
                            "x\ty\tu\tv\tflags\tmask\n1.0e+00\t2.0\tnan\tnan\t1.0\t0.0\n3.0\t2.0\t0.5\t0.25\t0.0\t0."
                            "0\n5.0\t2.0\t0.5\t0.25\t0.0\t1.0\n7.0\t2.0\t0.5\t0.25\t1.0\t0.0\n");
    EXPECT_EQ(field.format, "OpenPIV");
    EXPECT_EQ(field.valid, (std::vector<std::uint8_t>{0, 1, 0, 0}));
    EXPECT_EQ(field.count_valid(), 1u);
    EXPECT_NE(unit_refusal(field, {}).find("does not say its units"), std::string::npos);
    EXPECT_NEAR(in_si(field, {0.001, 0.1}, "").u[1], 0.005, 1e-12);
}

TEST_F(PivFieldTest, OpenPivOfOldHasNoHeader) {
    const auto field = read(" 16  16 -0.2660  0.0000 51.1181\n 32  16 -0.2141  5.3176 46.4536\n");
    EXPECT_EQ(field.format, "OpenPIV without header");
    EXPECT_EQ(field.count_valid(), 2u);
    EXPECT_EQ(field.v[1], 5.3176);
}

TEST_F(PivFieldTest, CsvGoesByNamesAndUnits) {
    const auto field = read("v [cm/s], u [cm/s], x [mm], y [mm], valid\n1,2,3,4,1\n5,6,7,8,0\n");
    const auto si = in_si(field, {}, "");
    EXPECT_EQ(si.valid, (std::vector<std::uint8_t>{1, 0}));
    EXPECT_NEAR(si.u[0], 0.02, 1e-15);
    EXPECT_NEAR(si.y[1], 0.008, 1e-15);
    EXPECT_NE(unit_refusal(read("x [kg],y [kg],u [m/s],v [m/s]\n1,1,1,1\n"), {}).find("which is no length"),
        std::string::npos);
}

TEST_F(PivFieldTest, WhatIsNoneOfTheseIsRefusedWithItsLine) {
    EXPECT_NE(refusal("").find("is empty"), std::string::npos);
    EXPECT_NE(refusal("hello\n").find("piv.txt:1: is no header"), std::string::npos);
    EXPECT_NE(refusal("x,y,u\n1,2,3\n").find("has no columns x, y, u and v"), std::string::npos);
    EXPECT_NE(refusal("x,y,u,v\n1,2,3,4\n1,2,3\n").find("piv.txt:3: has 3 values"), std::string::npos);
    EXPECT_NE(refusal("x,y,u,v\n1,2,3,fast\n").find("piv.txt:2: fast is no number"), std::string::npos);
    EXPECT_NE(refusal("x,y,u,v\n").find("holds no vector"), std::string::npos);
    EXPECT_NE(refusal("TITLE=\"a\" VARIABLES=\"X mm\", \"U mm\"\n1, 2\n").find("lacks one of"), std::string::npos);
}

// 5 % of the samples of a smooth flow are outliers of its size: 95 % of them are found, and their neighbours in time at most
// with them.
TEST(RejectSudden, FindsOutliersOfASmoothFlow) {
    constexpr int count = 400, times = 30;
    std::mt19937 generator(3);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    std::vector<PivField> frames(times);
    std::vector<std::vector<bool>> bad(times, std::vector<bool>(count, false));
    std::size_t outliers = 0;
    for (int f = 0; f < times; ++f) {
        auto& field = frames[std::size_t(f)];
        for (int i = 0; i < count; ++i) {
            const double speed = 0.1 * (1 + 0.5 * std::sin(0.1 * f + 0.02 * i)), noise = 0.02 * speed;
            bad[std::size_t(f)][std::size_t(i)] = uniform(generator) < 0.05;
            outliers += bad[std::size_t(f)][std::size_t(i)];
            const double angle = bad[std::size_t(f)][std::size_t(i)] ? 2 + 2 * uniform(generator) : 0;
            field.x.push_back(i);
            field.y.push_back(0);
            field.u.push_back(speed * std::cos(angle) + noise * normal(generator));
            field.v.push_back(speed * std::sin(angle) + noise * normal(generator));
            field.valid.push_back(1);
        }
    }
    const auto marked = reject_sudden(frames, 0.3, 1e-4);
    std::size_t found = 0, wrongly = 0;
    for (int f = 0; f < times; ++f) {
        for (int i = 0; i < count; ++i) {
            const bool rejected = !frames[std::size_t(f)].valid[std::size_t(i)],
                       outlier = bad[std::size_t(f)][std::size_t(i)];
            found += rejected && outlier;
            const bool beside = (f > 0 && bad[std::size_t(f - 1)][std::size_t(i)]) ||
                                (f + 1 < times && bad[std::size_t(f + 1)][std::size_t(i)]) || f == 0 || f + 1 == times;
            wrongly += rejected && !outlier && !beside;
        }
    }
    EXPECT_GE(double(found), 0.95 * double(outliers));
    EXPECT_LE(double(wrongly), 0.01 * count * times);
    EXPECT_GE(marked, found);
}

} // namespace
} // namespace treacle::video
