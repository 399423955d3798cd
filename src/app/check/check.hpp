#pragma once
#include "app/input/input.hpp"
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <filesystem>

namespace treacle::app {

// Arguments of `treacle check`.
struct CheckRequest {
    InputSource source;            // scene file, and the changes to it
    std::filesystem::path picture; // PNG of the particles at the start; empty: none
};

// `treacle check`: everything short of running. Prints what the scene is made of, what a run of it needs, and
// what is doubtful about it. Collective. Throws InputError with all that is wrong.
ExitCode check_scene(const Comm& comm, const CheckRequest& request);

} // namespace treacle::app
