#pragma once
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace treacle::app {

// Arguments of `treacle bench pressure`.
struct PressureBenchRequest {
    std::int64_t particles = 300'000;         // about; of the dam break that is built in
    std::vector<std::string> preconditioners; // words of method.pressure.preconditioner; empty: a choice
    std::vector<double> residuals;            // relative; empty: 1e-3, 1e-4, 1e-6
    int sweeps = 0;                           // of x += M r, each preconditioner by itself
    std::vector<std::string> overrides;       // "a.b.c=value"
    std::filesystem::path json;               // file for the figures; empty: none
};

// `treacle bench pressure`: solves the pressure system of a dam break at its start, with particles out of place at
// random, from zero, with each preconditioner to each residual. Collective. Throws InputError as `run` does.
ExitCode run_pressure_bench(const Comm& comm, const PressureBenchRequest& request);

} // namespace treacle::app
