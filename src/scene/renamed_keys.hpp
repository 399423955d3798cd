#pragma once
#include "base/options/document.hpp"

#include <span>

namespace treacle::scene {

// Keys and words of scene files and of a study's materials that earlier versions had, and that such files may still have.
std::span<const Renamed> renamed_keys();

} // namespace treacle::scene
