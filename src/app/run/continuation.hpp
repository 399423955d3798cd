#pragma once
#include "app/input/input.hpp"

#include <string>
#include <vector>

namespace treacle::app {

// Hash of an input without what may change when a run goes on: time.end, output but its name, cameras, max_lost_fraction. A
// checkpoint belongs to all inputs of one hash.
std::string state_hash(Input input);

// The input of a run that goes on, from the text of its effective.yaml. Throws InputError, as parse() and for changes of
// what the state or the tables of the run depend on.
Input continued_input(const std::string& text, const std::string& name, const std::vector<Change>& changes);

} // namespace treacle::app
