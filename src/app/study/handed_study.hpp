#pragma once
#include "app/study/forward.hpp"
#include "app/study/sweep.hpp"

namespace treacle::app {

// `treacle sweep --ask N --to DIR`: folders of the next runs, for others to do.
ExitCode ask_runs(const SweepRequest& request, int count, const std::filesystem::path& folder);
// `treacle sweep --tell DIR`: their results into the journal, and the table.
ExitCode tell_runs(const SweepRequest& request, const std::filesystem::path& folder);

// `treacle forward --study --params --results`: one evaluation of Dakota's, by its own files. Collective.
struct DakotaRequest {
    std::filesystem::path study, parameters, results;
};
ExitCode evaluate_for_dakota(const Comm& comm, const DakotaRequest& request);

// DIR/0007 of the task of the job array that this process is part of. Throws InputError outside of one.
std::filesystem::path folder_of_array_task(const std::filesystem::path& folder);

} // namespace treacle::app
