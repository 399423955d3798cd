#include "app/sweep.hpp"

#include "base/log.hpp"
#include "base/text.hpp"
#include "io/table_file.hpp"
#include "study/plots.hpp"
#include "study/status.hpp"

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
        if (!outcome || outcome->status == study::RunStatus::done) continue;
        log.warn("run " + std::to_string(number) + " (" + join(journal.runs()[std::size_t(number - 1)].values, ", ") + ") " +
                 study::word(outcome->status) + ": " + outcome->reason);
    }
}
} // namespace

std::filesystem::path this_program() { return std::filesystem::read_symlink("/proc/self/exe"); }

void write_tables(const std::filesystem::path& folder, const study::Table& table) {
    study::write_table(folder / "table.csv", table);
    io::write_table_file(folder / "table.h5", hdf5_of(table));
}

std::filesystem::path study_folder(const std::filesystem::path& study, const std::filesystem::path& out) {
    if (!out.empty()) return std::filesystem::absolute(out).lexically_normal();
    const auto name = study.stem() == "study" ? std::filesystem::absolute(study).parent_path().filename() : study.stem();
    return std::filesystem::absolute(std::filesystem::path("out") / name).lexically_normal();
}

ExitCode sweep_study(const SweepRequest& request) {
    const auto file = load_checked_study(request.study, request.overrides);
    const auto& study = file.study;
    const StudyScenes scenes(file);
    const auto points = study::sweep_points(study);
    const auto candidates = study::candidates_of(study, points, scenes.reader());
    const auto folder = study_folder(study.path, request.out);

    Log log(Voice::speaks);
    study::StudyRuns runs(study, {folder, this_program()}, log);
    std::vector<std::int64_t> numbers;
    std::set<std::int64_t> seen; // points that give the same run are one row
    for (const auto& candidate : candidates) {
        const auto number = runs.ask(candidate);
        if (seen.insert(number).second) numbers.push_back(number);
    }
    log.line(std::to_string(numbers.size()) + " runs on " + std::to_string(runs.lanes()) + " lanes in " + folder.string());
    const auto end = runs.run(numbers, request.retry_failed);
    const auto table = table_of(study, runs.journal(), numbers);
    write_tables(folder, table);
    study::write_plots(folder / "plots", study, table);

    const auto status = count_runs(runs.journal(), numbers);
    tell_failures(log, runs.journal(), numbers);
    log.line(std::to_string(status.done) + " of " + std::to_string(numbers.size()) + " runs done, " + std::to_string(status.failed) +
             " failed; " + (folder / "table.csv").string());
    if (end == study::StudyEnd::stopped) return ExitCode::stopped;
    if (status.failed == 0) return ExitCode::ok;
    log.line("`treacle sweep " + request.study.string() + " --retry failed` does those again");
    return ExitCode::simulation_failed;
}

} // namespace treacle::app
