#pragma once
#include "base/text/error.hpp"

#include <filesystem>
#include <string>

namespace treacle::app {

// Arguments of `treacle study history`.
struct HistoryRequest {
    std::filesystem::path study; // a study's file, or the folder of its results
    std::filesystem::path out;   // of the study's results, where `study` is a file
    std::filesystem::path csv;   // a copy of the table; empty: none
    std::filesystem::path merge; // folder of another study of the same scenes and parameters; empty: none
    std::string drop;            // number of a run, or "failed"; empty: none
};

// `treacle study history`: what a study's journal holds, as a table. Before that takes over another study's finished runs
// that this one lacks, and drops runs, whose folders it removes: by lines behind the journal's others. Throws InputError.
ExitCode show_history(const HistoryRequest& request);

} // namespace treacle::app
