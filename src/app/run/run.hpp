#pragma once
#include "app/input/company.hpp"
#include "app/run/continuation.hpp"
#include "base/text/error.hpp"
#include "io/run_folder.hpp"
#include "mpi/comm.hpp"

namespace treacle::app {

// Arguments of `treacle run`.
struct RunRequest {
    InputSource source;                                     // scene file, and the changes to it
    std::filesystem::path out;                              // default: out/<name of the scene's folder or file>
    io::ExistingFiles existing = io::ExistingFiles::refuse; // treatment of files of an earlier run in the folder
    double wall_limit = 0;                                  // [s] of the clock, 0: none; then exit code 5
    std::vector<std::string> command;                       // the command line, for the manifest
    Company company;                                        // log and callbacks of a caller in the same process
};

// `treacle run`. Collective; returns the exit code, ok or stopped; throws Error for the others.
ExitCode run_scene(const Comm& comm, const RunRequest& request);

// Arguments of `treacle resume`.
struct ResumeRequest {
    std::filesystem::path folder;     // of the run; its effective.yaml is the scene
    std::vector<Change> changes;      // of the scene
    double wall_limit = 0;            // [s]
    std::vector<std::string> command; // the command line, for the manifest
};

// `treacle resume`: goes on from the newest valid checkpoint of a run's folder, on any number of ranks. Changes go into
// effective.yaml and manifest.json.
ExitCode resume_run(const Comm& comm, const ResumeRequest& request);

} // namespace treacle::app
