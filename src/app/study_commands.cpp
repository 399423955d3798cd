#include "app/study_commands.hpp"

#include "app/identify/identify.hpp"
#include "app/identify/new_study.hpp"
#include "app/identify/next.hpp"
#include "app/study/handed_study.hpp"
#include "app/study/split_sweep.hpp"
#include "app/study/study_history.hpp"
#include "app/study/study_plan.hpp"
#include "app/study/sweep.hpp"

#include <CLI/CLI.hpp>

#include <cstdlib>
#include <memory>

namespace treacle::app {

namespace {
using Command = std::function<ExitCode(const Comm&)>;

Command refuse_ranks(const std::string& command) {
    return [command](const Comm&) -> ExitCode {
        throw InputError({command, "is started on ranks", "it starts a process for each run itself",
            "start it without mpiexec; runs.ranks is the number of ranks of each run"});
    };
}

struct SweepWords {
    SweepRequest request;
    std::string retry;
    int ask = 0;
    std::filesystem::path to, tell;

    ExitCode run() {
        request.study = find_study(request.study);
        request.retry_failed = !retry.empty();
        if (!tell.empty()) return tell_runs(request, tell);
        return ask > 0 ? ask_runs(request, ask, to) : sweep_study(request);
    }

    ExitCode run_on_ranks(const Comm& comm) {
        if (ask == 0 && tell.empty()) {
            comm.guard([&] { request.study = find_study(request.study); });
            request.retry_failed = !retry.empty();
            return sweep_on_groups(comm, request);
        }
        std::int64_t code = 0;
        comm.guard_root([&] { code = std::int64_t(run()); });
        comm.broadcast(std::span(&code, 1));
        return static_cast<ExitCode>(code);
    }
};

void add_sweep(CLI::App& program, const ChooseStudyCommand& choose) {
    auto words = std::make_shared<SweepWords>();
    auto& app = *program.add_subcommand("sweep",
        "Run a study: its scenes at every point of its parameters, several runs at once, "
        "into one table. The same command goes on where it was stopped.");
    app.add_option("study", words->request.study, "YAML file, or a folder with study.yaml")
        ->required()
        ->type_name("STUDY");
    app.add_option("--out", words->request.out, "Folder for the results (default: out/NAME)")->type_name("DIR");
    app.add_option(
           "--set", words->request.overrides, "Override a key of the study: runs.lanes=2. May be given several times.")
        ->allow_extra_args(false);
    app.add_option("--retry", words->retry, "failed: do the runs again that have failed")
        ->check(CLI::IsMember({"failed"}))
        ->type_name("WHICH");
    auto* ask = app.add_option("--ask", words->ask,
                       "Run nothing: write folders of the next runs for others to do, so many at most")
                    ->check(CLI::Range(1, 1'000'000))
                    ->type_name("NUMBER");
    ask->needs(app.add_option("--to", words->to, "Where those stand: DIR/0007, for `treacle forward DIR/0007`")
                   ->needs(ask)
                   ->type_name("DIR"));
    app.add_option("--tell", words->tell, "Run nothing: take in the results of such folders")
        ->excludes(ask)
        ->type_name("DIR");
    app.callback([words, choose] {
        choose.alone([words] { return words->run(); });
        choose.on_ranks(
            [words]() -> Command { return [words](const Comm& comm) { return words->run_on_ranks(comm); }; });
    });
}

void add_identify(CLI::App& program, const ChooseStudyCommand& choose) {
    auto request = std::make_shared<IdentifyRequest>();
    auto& app = *program.add_subcommand("identify",
        "Find the parameters with which a study's scenes look like its films, with an interval. The same "
        "command goes on where it was stopped.");
    app.add_option("study", request->study, "YAML file, or a folder with study.yaml")->required()->type_name("STUDY");
    app.add_option("--out", request->out, "Folder for the results (default: out/NAME)")->type_name("DIR");
    app.add_option("--set", request->overrides,
           "Override a key of the study: search.evaluations=30. May be given several times.")
        ->allow_extra_args(false);
    app.add_option("--compare-curve", request->compared_curve,
           "A rheometer's table with columns \"shear rate [1/s]\" and \"viscosity [Pa.s]\": how far the answer is from "
           "it, and one more run with it beside that at the answer. "
           "Where several liquids are identified, with its liquid: oil=FILE.csv")
        ->type_name("[LIQUID=]FILE.csv");
    app.add_flag("--hidden", request->hidden,
        "Draw pressure and speed at the best values into the report; the best run is done again where its frames are "
        "gone");
    app.add_flag("--quick", request->quick,
        "A first answer of some 14 runs: two rungs, and an interval without the measured values' part");
    app.callback([request, choose] {
        choose.alone([request] {
            auto found = *request;
            found.study = find_study(found.study);
            return identify_study(found);
        });
        choose.on_ranks([]() -> Command { return refuse_ranks("treacle identify"); });
    });
}

void add_next(CLI::App& program, const ChooseStudyCommand& choose) {
    struct NextWords {
        NextRequest request;
        std::vector<double> rates{1, 30};
    };
    auto words = std::make_shared<NextWords>();
    auto& request = words->request;
    auto& app = *program.add_subcommand("next",
        "Which of a study's candidates to film next: how narrow the band of the flow curve would be with each, by what "
        "is "
        "identified so far and a few coarse runs of each. The same command goes on where it was stopped.");
    app.add_option("study", request.study, "YAML file, or a folder with study.yaml, with candidates")
        ->required()
        ->type_name("STUDY");
    app.add_option("--rates", words->rates, "Shear rates [1/s] from and to which the curve is asked for (default 1 30)")
        ->expected(2)
        ->check(CLI::PositiveNumber)
        ->type_name("LOW HIGH");
    app.add_option("--out", request.out, "Folder of the study's results (default: out/NAME)")->type_name("DIR");
    app.add_option("--set", request.overrides, "Override a key of the study: runs.lanes=2. May be given several times.")
        ->allow_extra_args(false);
    app.add_flag("--quick", request.quick, "Start from the answer of `treacle identify --quick`");
    app.callback([words, choose] {
        choose.alone([words] {
            auto found = words->request;
            found.study = find_study(found.study);
            found.low = words->rates.front();
            found.high = words->rates.back();
            if (!(found.low < found.high))
                throw InputError({"treacle next", "--rates: the first must be the lower one",
                    "they are the ends of a range", "write --rates 1 30"});
            return propose_next(found);
        });
        choose.on_ranks([]() -> Command { return refuse_ranks("treacle next"); });
    });
}

void add_new(CLI::App& program, const ChooseStudyCommand& choose) {
    auto request = std::make_shared<NewStudyRequest>();
    auto& app = *program.add_subcommand("new", "A ready study of an experiment: its scene, a form of what to measure, "
                                               "how to film. Without a template: the list of them.");
    app.add_option("template", request->name, "The experiment")->type_name("TEMPLATE");
    app.add_option("folder", request->folder, "New folder for the study")->type_name("DIR");
    app.add_option(
           "--set", request->form, "An entry of the form: \"length=7 cm +- 0.05 cm\". May be given several times.")
        ->allow_extra_args(false);
    for (const auto& sight : sight_options()) {
        app.add_option_function<std::string>(
               std::string("--") + sight.name,
               [request, sight](const std::string& text) { request->sight[sight.name] = text; }, sight.doc)
            ->type_name(sight.type);
    }
    app.callback([request, choose] {
        choose.alone([request] { return new_study(*request); });
        choose.on_ranks([]() -> Command { return refuse_ranks("treacle new"); });
    });
}

// `history` and `plan` in the place of two commands, as `bench` has its kinds.
void add_study(CLI::App& program, const ChooseStudyCommand& choose) {
    struct StudyWords {
        std::string kind;
        HistoryRequest history;
        std::vector<std::string> overrides;
    };
    auto words = std::make_shared<StudyWords>();
    auto& app = *program.add_subcommand("study", "What a study holds, and what it will take.");
    app.add_option("kind", words->kind,
           "history: the journal as a table; plan: runs, core-hours and bytes of the sweep, from one coarse run that "
           "is "
           "done for it")
        ->required()
        ->check(CLI::IsMember({"history", "plan"}))
        ->type_name("KIND");
    app.add_option(
           "study", words->history.study, "YAML file, or a folder with study.yaml; history: or the folder of results")
        ->required()
        ->type_name("STUDY|DIR");
    app.add_option("--out", words->history.out, "Folder of the study's results (default: out/NAME)")->type_name("DIR");
    app.add_option(
           "--set", words->overrides, "plan: override a key of the study: runs.lanes=2. May be given several times.")
        ->allow_extra_args(false);
    app.add_option("--csv", words->history.csv, "history: write the table into this file as well")->type_name("FILE");
    app.add_option(
           "--merge", words->history.merge, "history: take over the finished runs of another study's folder first")
        ->type_name("DIR");
    app.add_option("--drop", words->history.drop,
           "history: a run, or all that failed, lose their outcome and are done again by the next sweep")
        ->type_name("RUN|failed");
    app.callback([words, choose] {
        const auto run = [words] {
            if (words->kind == "history") return show_history(words->history);
            return plan_study(find_study(words->history.study), words->history.out, words->overrides);
        };
        choose.alone(run);
        choose.on_ranks([]() -> Command { return refuse_ranks("treacle study"); });
    });
}

struct ForwardWords {
    std::filesystem::path folder;
    bool array_task = false;
    DakotaRequest dakota;

    ExitCode run(const Comm& comm) const {
        if (!dakota.study.empty()) return evaluate_for_dakota(comm, dakota);
        if (folder.empty())
            throw InputError({"treacle forward", "has nothing to run", "a folder with params.yaml says what",
                "name it, or --study, --params and --results"});
        return forward_run(comm, array_task ? folder_of_array_task(folder) : folder);
    }
};

void add_forward(CLI::App& program, const ChooseStudyCommand& choose) {
    auto words = std::make_shared<ForwardWords>();
    auto& app = *program.add_subcommand("forward",
        "One run of a study, as the params.yaml of its folder asks for it; the figures go into its "
        "result.json and results.out.");
    auto* folder = app.add_option("folder", words->folder, "Folder with params.yaml")->type_name("DIR");
    app.add_flag(
           "--array-task", words->array_task, "DIR/0007 of DIR, by the number of this task of a job array (Slurm, PBS)")
        ->needs(folder);
    auto* study = app.add_option("--study", words->dakota.study,
                         "In the place of a folder: the run of this study that --params asks for")
                      ->excludes(folder)
                      ->type_name("STUDY");
    auto* params = app.add_option("--params", words->dakota.parameters, "Dakota's parameters file")
                       ->needs(study)
                       ->type_name("FILE");
    auto* results = app.add_option("--results", words->dakota.results,
                           "Dakota's results file, or FAIL in it; the run's folder is FILE.run")
                        ->needs(study)
                        ->type_name("FILE");
    study->needs(params)->needs(results);
    app.callback([words, choose] {
        choose.on_ranks([words]() -> Command { return [words](const Comm& comm) { return words->run(comm); }; });
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
    add_new(program, choose);
    add_sweep(program, choose);
    add_identify(program, choose);
    add_next(program, choose);
    add_study(program, choose);
    add_forward(program, choose);
}

} // namespace treacle::app
