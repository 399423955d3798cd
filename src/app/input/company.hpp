#pragma once
#include "base/text/log.hpp"

#include <functional>

namespace treacle::app {

// Log and callbacks of the caller of a run.
struct Company {
    LogOutput log_output = LogOutput::enabled; // of rank 0
    std::function<void()> between_steps;       // called on every rank after each step; may be empty
    // Called on every rank after each frame but the last. True: the caller has all that it needs, and the run ends here
    // without a checkpoint. May be empty.
    std::function<bool()> told_enough = {};
};

} // namespace treacle::app
