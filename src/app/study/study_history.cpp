#include "app/study/study_history.hpp"

#include "app/study/sweep.hpp"
#include "base/text/text.hpp"
#include "io/folder_lock.hpp"
#include "study/lanes/forward_files.hpp"
#include "study/plots/table.hpp"

#include <cstdio>
#include <numeric>

namespace treacle::app {

namespace {
using study::Journal;
using study::RunStatus;

// The study of a folder of results, from the request of its first run; without that its parameters go by numbers.
study::Study study_of_folder(const std::filesystem::path& folder, const Journal& journal) {
    const auto first = folder / "runs" / study::request_folder(1);
    if (std::filesystem::exists(first / "params.yaml")) {
        const auto request = study::read_request(first);
        if (std::filesystem::exists(request.study)) return identify::load_study_file(request.study).study;
    }
    study::Study out;
    if (!journal.runs().empty()) out.parameters.resize(journal.runs().front().values.size());
    for (std::size_t i = 0; i < out.parameters.size(); ++i)
        out.parameters[i].name = "parameter " + std::to_string(i + 1);
    return out;
}

// Finished runs of the other study that this one lacks; the place of their files stays recorded.
int merge(Journal& journal, const std::filesystem::path& other_folder) {
    const auto other = Journal::read(other_folder);
    if (other.owner().study != journal.owner().study || other.owner().program != journal.owner().program) {
        throw InputError(
            {(other_folder / Journal::file_name).string() + ":1", "is the journal of another study or program",
                "its runs have other parameters, or were done by " + other.owner().program,
                "runs of equal scenes count by their content: write its folder into runs.reuse"});
    }
    int taken = 0;
    for (const auto& run : other.runs()) {
        const auto* outcome = other.outcome(run.number);
        if (!outcome || outcome->status != RunStatus::done) continue;
        const auto* known = journal.find(run.key);
        const auto* here = known ? journal.outcome(known->number) : nullptr;
        if (here && here->status == RunStatus::done) continue;
        auto copy = *outcome;
        copy.number = known ? known->number : journal.ask(run.scene, run.values, run.key, run.changes).number;
        if (copy.folder.empty())
            copy.folder = (std::filesystem::absolute(other_folder) / "runs" / study::request_folder(run.number))
                              .lexically_normal()
                              .string();
        journal.finish(copy);
        ++taken;
    }
    return taken;
}

int drop(Journal& journal, const std::filesystem::path& folder, const std::string& which) {
    const auto wanted = read_number(which);
    if (which != "failed" && (!wanted || *wanted < 1 || *wanted > double(journal.runs().size()))) {
        throw InputError({"--drop " + which, "is no run of " + folder.string(),
            "they go from 1 to " + std::to_string(journal.runs().size()), "give a number, or failed"});
    }
    int dropped = 0;
    for (const auto& run : journal.runs()) {
        const auto* outcome = journal.outcome(run.number);
        if (!outcome || (wanted ? double(run.number) != *wanted : !study::is_failure(outcome->status))) continue;
        journal.drop(run.number);
        journal.sync();
        std::filesystem::remove_all(
            folder / "runs" / study::request_folder(run.number)); // or its result would be found again
        ++dropped;
    }
    return dropped;
}

void change(const HistoryRequest& request, const std::filesystem::path& folder) {
    const io::FolderLock lock(folder);
    auto journal = Journal::open(folder, Journal::read(folder).owner());
    if (!request.merge.empty())
        std::printf("%d runs taken over from %s\n", merge(journal, request.merge), request.merge.c_str());
    if (!request.drop.empty()) std::printf("%d runs dropped\n", drop(journal, folder, request.drop));
    journal.sync();
}
} // namespace

ExitCode show_history(const HistoryRequest& request) {
    const bool by_file = !std::filesystem::exists(request.study / Journal::file_name);
    const auto folder = by_file ? study_folder(find_study(request.study), request.out) : request.study;
    if (!request.merge.empty() || !request.drop.empty()) change(request, folder);
    const auto journal = Journal::read(folder);
    const auto study =
        by_file ? identify::load_study_file(find_study(request.study)).study : study_of_folder(folder, journal);
    std::vector<std::int64_t> numbers(journal.runs().size());
    std::iota(numbers.begin(), numbers.end(), std::int64_t{1});
    const auto table = table_of(study, journal, numbers);
    for (const auto& line : lines_of(table)) std::printf("%s\n", line.c_str());
    if (!request.csv.empty()) write_table(request.csv, table);
    return ExitCode::ok;
}

} // namespace treacle::app
