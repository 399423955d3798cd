#pragma once
#include "app/input/input.hpp"
#include "base/text/error.hpp"

#include <vector>

namespace treacle::app {

// Adds what differs between the two sides of the domain's mirrors: shapes that cross a mirror unevenly, and motions across it.
void check_symmetry(const Input& input, std::vector<Diagnostic>& problems);

} // namespace treacle::app
