#include "identify/material/material.hpp"

#include "../own_folder.hpp"
#include "../refusal.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace treacle::identify {
namespace {

class MaterialTest : public testing::Test {
protected:
    std::vector<Material> read(const std::string& text) const {
        const auto path = folder_.path() / "result.yaml";
        std::ofstream(path) << text;
        return read_materials(path);
    }
    std::string refused(const std::string& text) const {
        return test::refusal([&] { read(text); });
    }
    const test::OwnFolder folder_;
};

Material lotion() {
    Material out;
    out.name = "lotion";
    out.density = 987.6;
    out.viscosity = 31.4159265358979;
    out.rheology.law = scene::ViscosityModelKind::herschel_bulkley;
    out.rheology.exponent = 0.37;
    out.rheology.yield_stress = 21.5;
    out.temperature = "22.5 C +- 0.5 C";
    out.found = {"K = 31.4, 90 % interval 28 to 34, well determined", "lotion: \"sheared\" at 1 to 9 1/s"};
    out.well_determined = false;
    return out;
}

TEST_F(MaterialTest, ComesBackAsItWasWrittenBesideOtherKeys) {
    const auto written = lotion();
    const auto all = read("schema_version: 1\nidentified:\n  - {name: K, anything: [1, 2]}\n" +
                          yaml({written, written}) + "trials: 12\n");
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[1].name, written.name);
    EXPECT_EQ(all[1].density, written.density);
    EXPECT_EQ(all[1].viscosity, written.viscosity);
    EXPECT_EQ(all[1].rheology.law, written.rheology.law);
    EXPECT_EQ(all[1].rheology.exponent, written.rheology.exponent);
    EXPECT_EQ(all[1].rheology.yield_stress, written.rheology.yield_stress);
    EXPECT_EQ(all[1].temperature, written.temperature);
    EXPECT_EQ(all[1].found, written.found);
    EXPECT_FALSE(all[1].well_determined);
}

TEST_F(MaterialTest, AFileWithoutMaterialsIsRefused) {
    EXPECT_EQ(yaml({}), "");
    EXPECT_NE(refused("schema_version: 1\ntrials: 12\n").find("has no materials"), std::string::npos);
}

TEST_F(MaterialTest, WhatIsWrongInAMaterialIsToldWithItsLine) {
    const auto said = refused("trials: 12\nmaterials:\n  - {name: oil, density: 900, viscosity: 1, rheology: {law: "
                              "cros}}\n  - {name: oil, density: 900, viskosity: 1}\n");
    EXPECT_NE(said.find("result.yaml:3: materials.oil.rheology.law = cros"), std::string::npos) << said;
    EXPECT_NE(said.find("result.yaml:4: materials.oil.viskosity is not a known key"), std::string::npos) << said;
    EXPECT_NE(said.find("viscosity is missing"), std::string::npos) << said;
}

} // namespace
} // namespace treacle::identify
