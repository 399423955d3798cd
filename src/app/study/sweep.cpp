#include "app/study/sweep.hpp"

#include "app/study/study_memory.hpp"
#include "base/text/log.hpp"
#include "base/text/text.hpp"
#include "io/hdf5/table_file.hpp"
#include "study/lanes/status.hpp"
#include "study/plots/plots.hpp"

#include <numeric>
#include <set>

namespace treacle::app {

namespace {
io::TableFile hdf5_of(const study::Table& table) {
    io::TableFile out;
    for (std::size_t i = 0; i < table.header.size(); ++i) {
        const auto numbers = study::numbers_of(table, table.header[i]);
        std::vector<std::string> words;
        bool numeric = !table.rows.empty();
        for (std::size_t k = 0; k < table.rows.size(); ++k) {
            words.push_back(table.rows[k][i]);
            numeric = numeric && (numbers[k] == numbers[k] || words.back().empty());
        }
        if (numeric && table.header[i] != "reason") {
            out.numbers.push_back({table.header[i], numbers});
        } else {
            out.texts.push_back({table.header[i], words});
        }
    }
    return out;
}

// Those of the table's runs that failed, a line each.
void tell_failures(Log& log, const study::Journal& journal, const std::vector<std::int64_t>& runs) {
    for (const auto number : runs) {
        const auto* outcome = journal.outcome(number);
        if (!outcome || !study::is_failure(outcome->status)) continue;
        log.warn("run " + std::to_string(number) + " (" + join(journal.runs()[std::size_t(number - 1)].values, ", ") +
                 ") " + study::word(outcome->status) + ": " + outcome->reason);
    }
}
} // namespace

std::filesystem::path this_program() { return std::filesystem::read_symlink("/proc/self/exe"); }

void write_tables(const std::filesystem::path& folder, const study::Table& table) {
    study::write_table(folder / "table.csv", table);
    io::write_table_file(folder / "table.h5", hdf5_of(table));
}

std::filesystem::path find_study(const std::filesystem::path& name) {
    auto path = std::filesystem::is_directory(name) ? name / "study.yaml" : name;
    if (std::filesystem::exists(path)) return path;
    throw InputError({path.string(), "there is no such file", "a study is a YAML file, or a folder with study.yaml",
        "`treacle schema --study` describes it"});
}

std::vector<study::Candidate> sweep_candidates(const identify::StudyFile& file) {
    return study::candidates_of(file.study, study::sweep_points(file.study), StudyScenes(file).reader());
}

std::filesystem::path study_folder(const std::filesystem::path& study, const std::filesystem::path& out) {
    if (!out.empty()) return std::filesystem::absolute(out).lexically_normal();
    const auto name =
        study.stem() == "study" ? std::filesystem::absolute(study).parent_path().filename() : study.stem();
    return std::filesystem::absolute(std::filesystem::path("out") / name).lexically_normal();
}

std::vector<std::int64_t> ask_once(study::StudyRuns& runs, const std::vector<study::Candidate>& candidates) {
    std::vector<std::int64_t> numbers;
    std::set<std::int64_t> seen;
    for (const auto& candidate : candidates) {
        const auto number = runs.ask(candidate);
        if (seen.insert(number).second) numbers.push_back(number);
    }
    return numbers;
}

ExitCode write_results(const study::Study& study, const study::Journal& journal, const std::vector<std::int64_t>& runs,
    const std::filesystem::path& folder, Log& log) {
    const auto table = table_of(study, journal, runs);
    write_tables(folder, table);
    study::write_plots(folder / "plots", study, table);
    const auto status = count_runs(journal, runs);
    write_status(folder / "status.json", status);
    tell_failures(log, journal, runs);
    log.line(std::to_string(status.done) + " of " + std::to_string(runs.size()) + " runs done, " +
             std::to_string(status.failed) + " failed; " + (folder / "table.csv").string());
    if (status.done + status.failed < runs.size()) return ExitCode::stopped;
    if (status.failed == 0) return ExitCode::ok;
    log.line("`--retry failed` does those again");
    return ExitCode::simulation_failed;
}

ExitCode sweep_study(const SweepRequest& request) {
    const auto file = load_checked_study(request.study, request.overrides);
    const auto& study = file.study;
    const auto candidates = sweep_candidates(file);
    study::check_launcher(study);
    check_memory(study, candidates);
    const auto folder = study_folder(study.path, request.out);

    Log log(LogOutput::enabled);
    std::vector<std::int64_t> numbers;
    const study::StudyRuns* under_way = nullptr;
    const auto tell_table = [&] { write_tables(folder, table_of(study, under_way->journal(), numbers)); };
    study::StudyRuns runs(study, {folder, this_program(), tell_table}, log);
    under_way = &runs;
    numbers = ask_once(runs, candidates);
    log.line(
        std::to_string(numbers.size()) + " runs on " + std::to_string(runs.lanes()) + " lanes in " + folder.string());
    const auto end = runs.run(numbers, request.retry_failed);
    const auto code = write_results(study, runs.journal(), numbers, folder, log);
    return end == study::StudyEnd::stopped ? ExitCode::stopped : code;
}

} // namespace treacle::app
