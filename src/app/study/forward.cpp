#include "app/study/forward.hpp"

#include "app/compare/experiments.hpp"
#include "app/compare/mismatch_watch.hpp"
#include "app/run/run.hpp"
#include "app/study/study_scenes.hpp"
#include "study/lanes/child_process.hpp"
#include "study/lanes/forward_files.hpp"
#include "study/model/readings.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <sys/resource.h>

namespace treacle::app {

namespace {
struct Asked {
    study::ForwardRequest request;
    identify::StudyFile file;
    const study::StudyScene* scene = nullptr; // of the file
    InputSource source;
};

void read_asked(const std::filesystem::path& folder, Asked& out) {
    out.request = study::read_request(folder);
    const auto where = (folder / "params.yaml").string();
    out.file = identify::load_study_file(out.request.study, out.request.overrides);
    const auto& study = out.file.study;
    const auto scene = std::ranges::find(study.scenes, out.request.run.scene, &study::StudyScene::name);
    std::vector<std::string> names;
    for (const auto& parameter : study.parameters) names.push_back(parameter.name);
    if (scene == study.scenes.end() || names != out.request.parameters) {
        throw InputError({where, "does not fit " + out.request.study.string(),
            "the study's scenes or parameters have changed since it was written", "ask for the runs again"});
    }
    out.scene = &*scene;
    const StudyScenes scenes(out.file);
    const auto path = study.scene_file(*scene);
    const auto assignments = study::assignments_of(study, *scene, out.request.run.values, out.request.run.changes);
    out.source = scenes.source(path, assignments);
    const auto key = study::run_key(scenes.read(path, assignments), study.runs.ranks, study::program_identity());
    if (out.request.run.key.empty()) out.request.run.key = key;
    if (out.request.run.key != key) {
        throw InputError({where, "asks for another run than its scene gives now",
            "the scene, a mesh, the study or this program has changed since", "ask for the runs again"});
    }
}

double peak_bytes(const Comm& comm) {
    struct rusage usage {};
    getrusage(RUSAGE_SELF, &usage);
    return comm.sum(1024.0 * double(usage.ru_maxrss));
}

// None where a column is not there: the run is good all the same, and the study's reading can be mended without another.
std::vector<study::Figure> figures_of(const study::Study& study, const std::filesystem::path& run) {
    try {
        return study::read_figures(study, run);
    } catch (const InputError& error) {
        std::fprintf(stderr, "warning: %s\n", error.what());
        return {};
    }
}

ExitCode run_asked(const Comm& comm, const std::filesystem::path& folder, const Asked& asked, const Company& company) {
    const auto start = std::chrono::steady_clock::now();
    RunRequest request;
    request.source = asked.source;
    request.out = folder / "run";
    request.existing = io::ExistingFiles::overwrite;
    request.command = {"treacle", "forward", folder.string()};
    request.company = company;
    std::optional<MismatchWatch> watch;
    if (asked.request.cut < study::no_cut) {
        watch.emplace(comm, asked.file, *asked.scene, folder, asked.request.cut);
        request.company.told_enough = [&] { return watch->look(); };
    }
    const auto code = run_scene(comm, request);
    if (code != ExitCode::ok) return code;
    const auto bound = watch ? watch->bound() : std::nullopt;
    if (!bound)
        compare_with_experiments(comm, asked.file, *asked.scene, folder, watch ? &watch->comparisons() : nullptr);
    const double peak = peak_bytes(comm);
    comm.guard_root([&] {
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const auto figures = bound ? std::vector<study::Figure>() : figures_of(asked.file.study, folder / "run");
        study::write_result(folder, {asked.request.run.number, asked.request.run.key, figures, seconds, peak, bound});
    });
    return code;
}

void check_ranks(const Comm& comm, const std::filesystem::path& folder, const Asked& asked) {
    if (comm.size() == asked.file.study.runs.ranks) return;
    const auto ranks = std::to_string(asked.file.study.runs.ranks);
    throw InputError({folder.string(), "is run on " + std::to_string(comm.size()) + " ranks",
        "the study's runs have " + ranks + " (runs.ranks), and digits may differ between numbers of ranks",
        "start it with mpiexec -n " + ranks + ", or change the study"});
}

ExitCode answer(const Comm& comm, const std::filesystem::path& folder, const Company& company) {
    Asked asked;
    bool done = false;
    comm.guard([&] {
        read_asked(folder, asked);
        check_ranks(comm, folder, asked);
        const auto result = study::read_result(folder, asked.request.run.key);
        done = result && (!result->bound || *result->bound > asked.request.cut);
    });
    if (done) {
        if (comm.is_root()) std::printf("%s is done\n", folder.c_str());
        return ExitCode::ok;
    }
    comm.guard_root([&] { std::filesystem::remove(folder / "FAIL"); });
    return run_asked(comm, folder, asked, company);
}
} // namespace

ExitCode forward_run(const Comm& comm, const std::filesystem::path& folder, const Company& company) {
    study::end_with_parent();
    try {
        return answer(comm, folder, company);
    } catch (const Error& error) {
        if (comm.is_root() && std::filesystem::exists(folder / "params.yaml"))
            study::write_failure(folder, error.what());
        throw;
    }
}

} // namespace treacle::app
