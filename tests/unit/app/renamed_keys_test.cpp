#include "app/input/input.hpp"
#include "base/options/options.hpp"
#include "base/text/split.hpp"
#include "base/text/text.hpp"
#include "scene/renamed_keys.hpp"

#include <gtest/gtest.h>

namespace treacle::app {
namespace {

TEST(RenamedKeys, AllLeadToKeysAndWordsOfToday) {
    for (const auto& one : scene::renamed_keys()) {
        auto parts = split(one.path, '.');
        if (parts[0] == "materials") continue; // no key of a scene
        std::erase(parts, "*");
        if (one.word.empty()) parts.back() = one.now;
        std::string told;
        EXPECT_NO_THROW(told = manual(Input{}, join(parts, "."))) << one.path;
        EXPECT_NE(told.find(one.now), std::string::npos) << one.path << " " << told;
    }
}

} // namespace
} // namespace treacle::app
