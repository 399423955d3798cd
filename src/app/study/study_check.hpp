#pragma once
#include "base/text/error.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace treacle::app {

// True when a file is a study: its top-level keys have `scenes`.
bool is_study(const std::filesystem::path& file);

// `treacle check STUDY`: everything short of running. Prints the scenes, parameters and figures, how many runs there are,
// and whether they fit in memory. Throws InputError with all that is wrong.
void check_study(const std::filesystem::path& file, const std::vector<std::string>& overrides);

} // namespace treacle::app
