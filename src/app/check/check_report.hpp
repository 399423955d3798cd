#pragma once
#include "app/render/preview.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace treacle::app {

// A scene that was found good.
struct CheckedScene {
    const Input& input;
    const Geometry& geometry;
    std::filesystem::path path;
    int ranks;
    const Preview& preview;
};

// The lines that `treacle check` prints, warnings last.
std::vector<std::string> check_report(const CheckedScene& scene);

} // namespace treacle::app
