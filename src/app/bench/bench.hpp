#pragma once
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace treacle::app {

// Subject of `treacle bench`.
enum class BenchKind {
    kernels, // every phase of the step against one product with the pressure matrix, and memory
    strong,  // for comparing numbers of ranks: the same liquid for all of them
    weak,    // likewise: the same liquid per rank
};

// Arguments of `treacle bench`.
struct BenchRequest {
    BenchKind kind = BenchKind::kernels; // strong and weak print one line each for a table over ranks
    std::int64_t particles = 300'000;    // about; of the dam break that is built in; weak: per rank
    int steps = 8;                       // measured ones, after those that bring the particles into disorder
    std::filesystem::path scene;         // empty: the dam break that is built in
    std::vector<std::string> overrides;  // "a.b.c=value"
    std::filesystem::path json;          // file for the figures; empty: none
};

// `treacle bench`: runs some steps and prints what they cost. Collective. Throws InputError as `run` does.
ExitCode run_bench(const Comm& comm, const BenchRequest& request);

} // namespace treacle::app
