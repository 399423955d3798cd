#pragma once
#include "app/run/run.hpp"
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <filesystem>

namespace treacle::app {

// `treacle forward DIR`: the run of a study that DIR/params.yaml states, into DIR/run; its figures go into
// DIR/result.json, or DIR/FAIL has the reason why there are none. Does nothing when the result is there. Collective.
// Throws InputError when the study or its scene has changed since the request.
ExitCode forward_run(const Comm& comm, const std::filesystem::path& folder, const Company& company = {});

} // namespace treacle::app
