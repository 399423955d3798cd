#pragma once
#include "app/input/input.hpp"

#include <cstdint>

namespace treacle::app {

// A dam break in 3D without any file: a block of liquid of 1 m x `sections` m x 1 m at the end of a tank
// of twice its length. The spacing is chosen for about `particles` liquid particles in each section.
Input bench_scene(std::int64_t particles, int sections, const std::vector<std::string>& overrides = {});

} // namespace treacle::app
