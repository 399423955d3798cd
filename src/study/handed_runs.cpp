#include "study/handed_runs.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "study/lanes/forward_files.hpp"
#include "study/lanes/lanes.hpp"

#include <algorithm>

namespace treacle::study {

namespace {
bool same_figures(const std::vector<Figure>& a, const std::vector<Figure>& b) {
    return std::ranges::equal(a, b, [](const Figure& x, const Figure& y) {
        return x.name == y.name && (x.value == y.value || (x.value != x.value && y.value != y.value));
    });
}

// One folder; throws InputError for one that is left alone.
void take_one(const Study& study, Journal& journal, const std::filesystem::path& folder, TakenIn& taken) {
    const auto where = folder.string();
    const auto request = read_request(folder);
    const auto* run = journal.find(request.run.key);
    if (request.study != study.path || !run) {
        throw InputError({where, "asks for no run of this study",
            "it was written for " + request.study.string() + ", or its scene has changed since", ""});
    }
    if (run->number != request.run.number)
        throw InputError(
            {where, "has the number of another run", "this study's has number " + std::to_string(run->number), ""});
    const auto* known = journal.outcome(run->number);
    RunOutcome outcome{run->number, RunStatus::failed, read_failure(folder), {}, 0, 0, 0, 0, utc_now(), "", where};
    const auto result = read_result(folder, run->key);
    if (!result && std::filesystem::exists(folder / "result.json")) {
        throw InputError({where, "has the result of another run", "its key is not that of its params.yaml",
            "remove result.json, and run it again"});
    }
    if (result) {
        take_result(*result, outcome);
        outcome.seconds = result->seconds;
    } else if (outcome.reason.empty()) {
        ++(known ? taken.known : taken.open);
        return;
    }
    if (known && known->status == RunStatus::done) {
        if (result && !same_figures(known->figures, outcome.figures))
            throw InputError({where, "has other figures than the run had before", "those count", ""});
        ++taken.known;
        return;
    }
    if (known && !result && known->reason == outcome.reason) {
        ++taken.known;
        return;
    }
    journal.finish(outcome);
    ++(result ? taken.done : taken.failed);
}
} // namespace

std::vector<std::int64_t> hand_out(const Study& study, const Journal& journal, std::span<const std::int64_t> runs,
    int count, const std::filesystem::path& folder, bool retry_failed) {
    std::vector<std::int64_t> out;
    for (const auto number : runs) {
        if (int(out.size()) == count) break;
        const auto* outcome = journal.outcome(number);
        const bool again = outcome && ((retry_failed && is_failure(outcome->status)) || !outcome->answers(no_cut));
        const auto own = folder / request_folder(number);
        if (outcome ? !again : std::filesystem::exists(own / "params.yaml")) continue;
        std::filesystem::remove_all(own);
        write_request(own, request_of(study, journal.runs()[std::size_t(number - 1)]));
        out.push_back(number);
    }
    return out;
}

TakenIn take_in(const Study& study, Journal& journal, const std::filesystem::path& folder) {
    if (!std::filesystem::is_directory(folder)) {
        throw InputError({folder.string(), "is no folder", "the folders of runs stand in it", "name that of --to"});
    }
    std::vector<std::filesystem::path> folders;
    for (const auto& entry :
        std::filesystem::directory_iterator(std::filesystem::absolute(folder).lexically_normal())) {
        if (entry.is_directory()) folders.push_back(entry.path());
    }
    std::ranges::sort(folders);
    TakenIn taken;
    for (const auto& one : folders) {
        try {
            take_one(study, journal, one, taken);
        } catch (const InputError& error) {
            for (const auto& problem : error.diagnostics()) taken.left.push_back(problem.text());
        }
    }
    return taken;
}

} // namespace treacle::study
