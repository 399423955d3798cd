#include "app/study/handed_study.hpp"

#include "base/text/file.hpp"
#include "base/text/log.hpp"
#include "base/text/text.hpp"
#include "io/folder_lock.hpp"
#include "study/dakota.hpp"
#include "study/handed_runs.hpp"
#include "study/lanes/forward_files.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>

namespace treacle::app {

namespace {
// A study whose runs others do, with the runs of its sweep in its journal.
struct HandedStudy {
    explicit HandedStudy(const SweepRequest& request) : file(load_checked_study(request.study, request.overrides)) {
        const auto candidates = sweep_candidates(file);
        folder = study_folder(study.path, request.out);
        std::filesystem::create_directories(folder);
        lock = std::make_unique<io::FolderLock>(folder);
        journal =
            std::make_unique<study::Journal>(study::Journal::open(folder, owner_of(study, study::program_identity())));
        for (const auto& one : candidates) {
            const auto* known = journal->find(one.key);
            const auto number = known ? known->number : journal->ask(one.scene, one.values, one.key).number;
            if (std::ranges::find(numbers, number) == numbers.end()) numbers.push_back(number);
        }
        journal->sync();
    }
    identify::StudyFile file;
    const study::Study& study = file.study;
    std::filesystem::path folder;
    std::unique_ptr<io::FolderLock> lock;
    std::unique_ptr<study::Journal> journal;
    std::vector<std::int64_t> numbers;
};

// The folder of the request that Dakota's parameters state.
std::filesystem::path write_dakota_request(const DakotaRequest& request) {
    const auto file = load_checked_study(request.study);
    const auto& study = file.study;
    const auto read = study::read_dakota_parameters(request.parameters);
    if (study.scenes.size() != 1)
        throw InputError({study.path.string(), "has several scenes", "an evaluation of Dakota's is one run",
            "write a study for each"});
    study::RunRequest run{read.evaluation, study.scenes.front().name, {}, ""};
    for (const auto& parameter : study.parameters) {
        const auto found =
            std::ranges::find(read.variables, parameter.name, &std::pair<std::string, std::string>::first);
        if (found == read.variables.end()) {
            throw InputError({request.parameters.string(), "has no variable " + parameter.name,
                parameter.where + " asks for it", "name Dakota's descriptors after the study's parameters"});
        }
        const auto number = read_number(found->second);
        run.values.push_back(number ? parameter.word(*number) : found->second);
    }
    run.key = candidate_of(study, study.scenes.front(), run.values, StudyScenes(file).reader()).key;
    auto folder = std::filesystem::absolute(request.results);
    folder += ".run";
    study::write_request(folder, request_of(study, run));
    return folder;
}
} // namespace

ExitCode ask_runs(const SweepRequest& request, int count, const std::filesystem::path& folder) {
    const HandedStudy handed(request);
    const auto given = study::hand_out(handed.study, *handed.journal, handed.numbers, count,
        std::filesystem::absolute(folder).lexically_normal(), request.retry_failed);
    Log log(LogOutput::enabled);
    if (given.empty()) {
        log.line("no run is left to hand out");
        return ExitCode::ok;
    }
    std::string list;
    for (const auto number : given) list += (list.empty() ? "" : ",") + std::to_string(number);
    log.line(std::to_string(given.size()) + " runs in " + folder.string() + ": " + list);
    return ExitCode::ok;
}

ExitCode tell_runs(const SweepRequest& request, const std::filesystem::path& folder) {
    const HandedStudy handed(request);
    const auto taken = study::take_in(handed.study, *handed.journal, folder);
    Log log(LogOutput::enabled);
    for (const auto& one : taken.left) log.warn(one);
    log.line(std::to_string(taken.done) + " runs done, " + std::to_string(taken.failed) + " failed, " +
             std::to_string(taken.known) + " known before, " + std::to_string(taken.open) + " still out, " +
             std::to_string(taken.left.size()) + " folders left alone");
    return write_results(handed.study, *handed.journal, handed.numbers, handed.folder, log);
}

ExitCode evaluate_for_dakota(const Comm& comm, const DakotaRequest& request) {
    const auto fail = [&] { write_file_atomically(request.results, "FAIL\n"); };
    std::string folder;
    auto code = ExitCode::ok;
    try {
        comm.guard_root([&] { folder = write_dakota_request(request).string(); });
        folder = comm.broadcast(folder);
        code = forward_run(comm, folder);
    } catch (const Error&) {
        if (comm.is_root()) fail();
        throw;
    }
    comm.guard_root([&] {
        if (code != ExitCode::ok) return fail();
        std::filesystem::copy_file(std::filesystem::path(folder) / "results.out", request.results,
            std::filesystem::copy_options::overwrite_existing);
    });
    return code;
}

std::filesystem::path folder_of_array_task(const std::filesystem::path& folder) {
    for (const char* name : {"SLURM_ARRAY_TASK_ID", "PBS_ARRAY_INDEX", "PBS_ARRAYID"}) {
        const char* text = std::getenv(name);
        const auto number = text ? read_number(text) : std::nullopt;
        if (number && *number >= 0) return folder / study::request_folder(std::int64_t(*number));
    }
    throw InputError({"--array-task", "is no task of a job array",
        "neither SLURM_ARRAY_TASK_ID nor PBS_ARRAY_INDEX is set", "name the run's folder itself"});
}

} // namespace treacle::app
