#pragma once
#include "base/text/units.hpp"
#include "base/text/vec3.hpp"

#include <string>
#include <vector>

namespace treacle::app {

// Values of options on the command line. All throw InputError that names the option.

// Length with a unit, > 0 [m].
double read_length(const std::string& option, const std::string& text);
// Value of --wall-limit: a time with a unit, > 0; 0 for an empty text [s].
double read_wall_limit(const std::string& text);
// Three numbers, and perhaps a unit for all of them: "10 0 5 cm"; in SI.
Vec3 read_vector(const std::string& text, const Unit& unit, const std::string& option);
// The parts between the marks, one at least.
std::vector<std::string> split_at(const std::string& text, char mark);

} // namespace treacle::app
