#include "scene/scene.hpp"
#include "sph/model/particles.hpp"

#include <gtest/gtest.h>

#include <algorithm>

using namespace treacle;

TEST(FrameFields, TheSceneTakesWhatTheLiquidHas) {
    const sph::LiquidParticles liquid;
    std::vector<std::string> names{"id"}; // always written
    for (const auto& field : liquid.store.fields()) {
        if (field.output && field.name != "id") names.push_back(field.name);
    }
    auto known = scene::frame_fields();
    std::ranges::sort(names);
    std::ranges::sort(known);
    EXPECT_EQ(names, known);
}
