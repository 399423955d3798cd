#include "app/study_commands.hpp"

#include "app/forward.hpp"
#include "app/identify.hpp"
#include "app/sweep.hpp"

#include <CLI/CLI.hpp>

#include <cstdlib>
#include <memory>

namespace treacle::app {

namespace {
using Command = std::function<ExitCode(const Comm&)>;

// A study's file, or the study.yaml in a folder.
std::filesystem::path find_study(const std::string& name) {
    std::filesystem::path path = name;
    if (std::filesystem::is_directory(path)) path /= "study.yaml";
    if (std::filesystem::exists(path)) return path;
    throw InputError({path.string(), "there is no such file", "a study is a YAML file, or a folder with study.yaml",
                      "`treacle schema --study` describes it"});
}

struct SweepWords {
    std::string study, out, retry;
    std::vector<std::string> overrides;
};

void add_sweep(CLI::App& program, const ChooseStudyCommand& choose) {
    auto words = std::make_shared<SweepWords>();
    auto& app = *program.add_subcommand("sweep", "Run a study: its scenes at every point of its parameters, several runs at once, "
                                                 "into one table. The same command goes on where it was stopped.");
    app.add_option("study", words->study, "YAML file, or a folder with study.yaml")->required()->type_name("STUDY");
    app.add_option("--out", words->out, "Folder for the results (default: out/NAME)")->type_name("DIR");
    app.add_option("--set", words->overrides, "Override a key of the study: runs.lanes=2. May be given several times.")->allow_extra_args(false);
    app.add_option("--retry", words->retry, "failed: do the runs again that have failed")->check(CLI::IsMember({"failed"}))->type_name("WHICH");
    app.callback([words, choose] {
        const auto sweep = [words] { return sweep_study({find_study(words->study), words->out, words->overrides, !words->retry.empty()}); };
        choose.alone(sweep);
        choose.on_ranks([]() -> Command {
            return [](const Comm&) -> ExitCode {
                throw InputError({"treacle sweep", "is started on ranks", "it starts a process for each run itself",
                                  "start it without mpiexec; runs.ranks is the number of ranks of each run"});
            };
        });
    });
}

void add_identify(CLI::App& program, const ChooseStudyCommand& choose) {
    auto words = std::make_shared<SweepWords>();
    auto& app = *program.add_subcommand("identify", "Find the parameters with which a study's scenes look like its films, with an interval. The same "
                                                    "command goes on where it was stopped.");
    app.add_option("study", words->study, "YAML file, or a folder with study.yaml")->required()->type_name("STUDY");
    app.add_option("--out", words->out, "Folder for the results (default: out/NAME)")->type_name("DIR");
    app.add_option("--set", words->overrides, "Override a key of the study: search.evaluations=30. May be given several times.")->allow_extra_args(false);
    app.callback([words, choose] {
        choose.alone([words] { return identify_study({find_study(words->study), words->out, words->overrides, false}); });
        choose.on_ranks([]() -> Command {
            return [](const Comm&) -> ExitCode {
                throw InputError({"treacle identify", "is started on ranks", "it starts a process for each run itself",
                                  "start it without mpiexec; runs.ranks is the number of ranks of each run"});
            };
        });
    });
}

void add_forward(CLI::App& program, const ChooseStudyCommand& choose) {
    auto folder = std::make_shared<std::string>();
    auto& app = *program.add_subcommand("forward", "One run of a study, as the params.yaml of its folder asks for it; the figures go into its "
                                                   "result.json and results.out.");
    app.add_option("folder", *folder, "Folder with params.yaml")->required()->type_name("DIR");
    app.callback([folder, choose] {
        choose.on_ranks([folder]() -> Command { return [folder](const Comm& comm) { return forward_run(comm, *folder); }; });
    });
}
} // namespace

bool started_on_ranks() {
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"}) {
        if (std::getenv(name) != nullptr) return true;
    }
    return false;
}

void add_study_commands(CLI::App& program, const ChooseStudyCommand& choose) {
    add_sweep(program, choose);
    add_identify(program, choose);
    add_forward(program, choose);
}

} // namespace treacle::app
