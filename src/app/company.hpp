#pragma once
#include "base/log.hpp"

#include <functional>

namespace treacle::app {

// Companions of a run.
struct Company {
    Voice voice = Voice::speaks;         // of rank 0
    std::function<void()> between_steps; // called on every rank after each step; may be empty
};

} // namespace treacle::app
