#include "identify/experiment/piv_files.hpp"

#include "../own_folder.hpp"
#include "io/hdf5/table_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace treacle::identify {
namespace {

class PivFilesTest : public testing::Test {
protected:
    io::TableFile session() const {
        io::TableFile out;
        for (const char* suffix : {"_0", "_1"}) {
            const std::string end = suffix;
            out.numbers.push_back({"x" + end, {4, 12, 20}});
            out.numbers.push_back({"y" + end, {4, 4, 4}});
            out.numbers.push_back({"u" + end, {1, 2, std::nan("")}});
            out.numbers.push_back({"v" + end, {0.5, 0.25, 0.125}});
            out.numbers.push_back({"typevector" + end, {0, 1, 1}});
        }
        out.texts.push_back({"note", {"cells and texts are left out"}});
        return out;
    }
    std::string refusal() const {
        try {
            read_piv(path_);
        } catch (const std::exception& error) {
            return error.what();
        }
        return "";
    }
    const test::OwnFolder folder_;
    const std::filesystem::path path_ = folder_.path() / "session.mat";
};

TEST_F(PivFilesTest, ASessionOfPivlabHasAFieldAFrame) {
    io::write_table_file(path_, session());
    const auto frames = read_piv(path_);
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_EQ(frames[1].format, "PIVlab");
    EXPECT_EQ(frames[1].length_unit, "px");
    EXPECT_EQ(frames[1].valid, (std::vector<std::uint8_t>{0, 1, 0}));
    EXPECT_EQ(frames[1].u[1], 2);
}

TEST_F(PivFilesTest, ItsCalibrationGivesMetres) {
    auto file = session();
    file.numbers.push_back({"calxy", {1e-4}});
    file.numbers.push_back({"caluv", {0.01}});
    io::write_table_file(path_, file);
    const auto field = read_piv(path_).front();
    EXPECT_EQ(field.velocity_unit, "m/s");
    EXPECT_DOUBLE_EQ(field.x[1], 12e-4);
    EXPECT_DOUBLE_EQ(field.u[1], 0.02);
}

TEST_F(PivFilesTest, WhatIsMissingIsNamed) {
    auto file = session();
    file.numbers.erase(file.numbers.begin() + 2);
    io::write_table_file(path_, file);
    EXPECT_NE(refusal().find("has no array u_0"), std::string::npos) << refusal();
    file = session();
    file.numbers[3].second.pop_back();
    io::write_table_file(path_, file);
    EXPECT_NE(refusal().find("v_0 has 2 values"), std::string::npos) << refusal();
    std::ofstream(path_) << "\x89HDF\r\n\x1a\n";
    EXPECT_NE(refusal(), "");
}

TEST_F(PivFilesTest, TextFilesHoldOneField) {
    std::ofstream(path_) << "16 16 -0.25 0.5 51\n";
    const auto frames = read_piv(path_);
    ASSERT_EQ(frames.size(), 1u);
    EXPECT_EQ(frames[0].v[0], 0.5);
}

} // namespace
} // namespace treacle::identify
