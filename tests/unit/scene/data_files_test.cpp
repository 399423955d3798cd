#include "../own_folder.hpp"
#include "base/text/error.hpp"
#include "scene/data_files.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

namespace treacle::scene {
namespace {

namespace fs = std::filesystem;

class DataFiles : public testing::Test {
protected:
    DataFiles() {
        for (const char* folder : {"scene", "data", "variable"}) fs::create_directories(root_ / folder);
        ::unsetenv("TREACLE_DATA");
    }
    ~DataFiles() override { ::unsetenv("TREACLE_DATA"); }

    fs::path add(const std::string& name) const {
        std::ofstream(root_ / name) << "mesh";
        return root_ / name;
    }
    std::vector<fs::path> search_path() const {
        return data_search_path(root_ / "scene" / "scene.yaml", {root_ / "data"});
    }

    static Scene scene_with(const std::string& file) {
        Scene scene;
        scene.bodies.emplace_back();
        auto& shape = scene.bodies[0].shape;
        shape.kind = ShapeKind::mesh;
        shape.file = file;
        shape.where = "scene.yaml:7";
        return scene;
    }

    const test::OwnFolder folder_;
    const fs::path& root_ = folder_.path();
};

TEST_F(DataFiles, AreLookedUpBesideTheSceneThenInDataThenInTheVariable) {
    ::setenv("TREACLE_DATA", (":/nowhere:" + (root_ / "variable").string()).c_str(), 1);
    EXPECT_EQ(find_data_file("a.ply", search_path()), "");
    const auto third = add("variable/a.ply");
    EXPECT_EQ(find_data_file("a.ply", search_path()), third);
    const auto second = add("data/a.ply");
    EXPECT_EQ(find_data_file("a.ply", search_path()), second);
    const auto first = add("scene/a.ply");
    EXPECT_EQ(find_data_file("a.ply", search_path()), first);
}

TEST_F(DataFiles, AnAbsoluteNameIsLookedUpAsItIs) {
    const auto path = add("variable/a.ply");
    EXPECT_EQ(find_data_file(path, {}), path);
    EXPECT_EQ(find_data_file(root_ / "a.ply", search_path()), "");
}

TEST_F(DataFiles, AFolderIsNoDataFile) { EXPECT_EQ(find_data_file("data", {root_}), ""); }

TEST_F(DataFiles, ASceneBesideTheWorkingFolderIsSearchedThere) {
    EXPECT_EQ(data_search_path("scene.yaml", {}).at(0), ".");
}

TEST_F(DataFiles, AFoundMeshGetsItsPath) {
    const auto path = add("scene/a.ply");
    auto scene = scene_with("a.ply");
    EXPECT_TRUE(resolve_data_files(scene, search_path()).empty());
    EXPECT_EQ(scene.bodies[0].shape.file, path.string());
}

TEST_F(DataFiles, AMissingMeshIsReplacedByItsFallbackWithAMessage) {
    auto scene = scene_with("a.ply");
    Shape sphere;
    sphere.kind = ShapeKind::sphere;
    sphere.radius = 2;
    scene.bodies[0].shape.fallback.push_back(sphere);
    const auto messages = resolve_data_files(scene, search_path());
    ASSERT_EQ(messages.size(), 1u);
    EXPECT_EQ(messages[0].rfind("scene.yaml:7: the mesh a.ply was not found", 0), 0u);
    EXPECT_EQ(scene.bodies[0].shape.kind, ShapeKind::sphere);
    EXPECT_EQ(scene.bodies[0].shape.radius, 2);
}

TEST_F(DataFiles, AllMissingMeshesWithoutAFallbackAreErrorsWithTheFoldersSearched) {
    auto scene = scene_with("a.ply");
    scene.liquids.emplace_back();
    scene.liquids[0].shapes = {scene.bodies[0].shape};
    try {
        resolve_data_files(scene, search_path());
        FAIL();
    } catch (const InputError& error) {
        ASSERT_EQ(error.diagnostics().size(), 2u);
        EXPECT_EQ(error.diagnostics()[1].where, "scene.yaml:7");
        EXPECT_EQ(error.diagnostics()[1].reason,
            "looked in " + (root_ / "scene").string() + ", " + (root_ / "data").string());
    }
}

} // namespace
} // namespace treacle::scene
