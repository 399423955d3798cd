#include "scene/materials.hpp"

#include <gtest/gtest.h>

#include <set>

namespace treacle::scene {
namespace {

TEST(Materials, AreLiquidsWithASource) {
    std::set<std::string_view> names;
    for (const auto& material : materials()) {
        EXPECT_TRUE(names.insert(material.name).second) << material.name << " stands twice";
        // Bounds that no liquid of a kitchen or laboratory crosses: a slip of a unit does.
        EXPECT_GT(material.density, 700) << material.name;
        EXPECT_LT(material.density, 2000) << material.name;
        EXPECT_GT(material.viscosity, 1e-4) << material.name;
        EXPECT_LT(material.viscosity, 1e4) << material.name;
        EXPECT_GT(material.surface_tension, 0.01) << material.name;
        EXPECT_LT(material.surface_tension, 0.1) << material.name;
        EXPECT_GT(material.temperature, 273) << material.name;
        EXPECT_LT(material.temperature, 373) << material.name;
        EXPECT_FALSE(material.source.empty()) << material.name;
    }
}

TEST(Materials, SiliconeOilsHaveTheViscosityOfTheirGrade) {
    for (const auto& material : materials()) {
        const std::string_view prefix = "silicone_oil_";
        if (!material.name.starts_with(prefix)) continue;
        const double grade = std::stod(std::string(material.name.substr(prefix.size()))); // [cSt]
        // The table gives three digits.
        EXPECT_NEAR(material.viscosity / material.density * 1e6 / grade, 1, 5e-3) << material.name;
    }
}

TEST(Materials, AreFoundByName) {
    ASSERT_NE(find_material("honey"), nullptr);
    EXPECT_EQ(find_material("honey")->viscosity, 10);
    EXPECT_EQ(find_material("hony"), nullptr);
    EXPECT_EQ(find_material("none"), nullptr);
}

TEST(Materials, TheTableHasEachOfThem) {
    const auto table = materials_table();
    for (const auto& material : materials()) {
        EXPECT_NE(table.find("\n" + std::string(material.name) + " "), std::string::npos) << material.name;
    }
    EXPECT_NE(table.find("[Pa s]"), std::string::npos);
}

} // namespace
} // namespace treacle::scene
