#include "study/study_runs.hpp"

#include "base/text/error.hpp"
#include "base/text/file.hpp"
#include "base/text/text.hpp"
#include "io/manifest.hpp"
#include "study/lanes/forward_files.hpp"
#include "study/lanes/status.hpp"
#include "study/model/readings.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <thread>
#include <unistd.h>

namespace treacle::study {

namespace {
constexpr const char* session_folder = "session";
constexpr std::uintmax_t least_space = 16'000'000; // [bytes] of the disk: what the start of a run's ranks takes

// The last line of a run's log that is not empty: the error that ended it.
std::string last_words(const std::filesystem::path& log) {
    std::ifstream file(log);
    std::string line, last;
    while (std::getline(file, line)) {
        if (line.find_first_not_of(" \t\r-") != std::string::npos) last = line;
    }
    return last;
}

std::string reason_of(const LaneResult& result, const RunOptions& options, const std::filesystem::path& folder) {
    switch (result.end) {
    case LaneEnd::time_limit: return "took longer than the time limit of " + format_duration(options.time_limit);
    case LaneEnd::hang: return "took no step for " + format_number(options.hang_factor) + " mean steps";
    case LaneEnd::memory: return "held more than " + format_bytes(std::uint64_t(options.memory * 1e9)) + " of memory";
    default: break;
    }
    auto told = read_failure(folder);
    if (!told.empty()) return told;
    auto words = last_words(folder / "log.txt");
    if (result.ending.signal == 0 && !words.empty()) return words;
    return describe(result.ending) + (words.empty() ? "" : ", last: " + words);
}

RunStatus status_of(const LaneResult& result) {
    switch (result.end) {
    case LaneEnd::time_limit: return RunStatus::timed_out;
    case LaneEnd::hang: return RunStatus::hung;
    case LaneEnd::memory: return RunStatus::out_of_memory;
    default: break;
    }
    if (result.ending.signal != 0) return RunStatus::killed;
    switch (static_cast<ExitCode>(result.ending.exit_code)) {
    case ExitCode::bad_input: return RunStatus::bad_input;
    case ExitCode::out_of_memory: return RunStatus::out_of_memory;
    default: break;
    }
    // Exit code of a launcher for the signal of a rank.
    return result.ending.exit_code > 128 && result.ending.exit_code < 160 ? RunStatus::killed : RunStatus::failed;
}

const std::filesystem::path& made(const std::filesystem::path& folder) {
    std::error_code failed;
    std::filesystem::create_directories(folder / "runs", failed);
    if (failed)
        throw InputError({folder.string(), "cannot be made", failed.message(), "choose another folder with --out"});
    return folder;
}
} // namespace

int lane_count(const RunOptions& options) {
    const int cores = std::max(1, int(std::thread::hardware_concurrency()));
    return options.lanes > 0 ? options.lanes : std::max(1, cores / options.ranks);
}

void check_launcher(const Study& study) {
    const auto words = study.runs.launch_words();
    if (words.empty() || !find_program(words.front()).empty()) return;
    throw InputError({study.runs.launcher_where, "runs.launcher = " + words.front() + ": there is no such program",
        study.runs.launcher.empty() ? "it starts the " + std::to_string(study.runs.ranks) + " ranks of each run"
                                    : "it is in front of each run's command",
        "check its name and the PATH, or load its module"});
}

StudyRuns::StudyRuns(const Study& study, StudySetup setup, Log& log)
    : study_(study), setup_(std::move(setup)), log_(log), lock_(made(setup_.folder)),
      journal_(Journal::open(setup_.folder, owner_of(study, program_identity()))), lane_count_(lane_count(study.runs)),
      speculation_(study, setup_.folder / "speculative"), start_(std::chrono::steady_clock::now()),
      last_report_(start_ - std::chrono::seconds(1)) { // the first is due at once
    if (!lock_.warning().empty()) log_.warn(lock_.warning());
    for (const auto& other : study_.runs.reuse) {
        const auto folder = std::filesystem::path(other).is_absolute() ? std::filesystem::path(other)
                                                                       : study_.path.parent_path() / other;
        others_.emplace_back(folder, Journal::read(folder));
    }
}

std::filesystem::path StudyRuns::run_folder(std::int64_t number) const {
    return setup_.folder / "runs" / request_folder(number);
}

std::filesystem::path StudyRuns::folder_of(std::int64_t number) const {
    const auto* outcome = journal_.outcome(number);
    return outcome && !outcome->folder.empty() ? std::filesystem::path(outcome->folder) : run_folder(number);
}

std::int64_t StudyRuns::ask(const Candidate& candidate) {
    simulated_end_ = candidate.end;
    const auto* known = journal_.find(candidate.key);
    const auto number = known
                            ? known->number
                            : journal_.ask(candidate.scene, candidate.values, candidate.key, candidate.changes).number;
    work_[number] = candidate.work;
    cuts_.erase(number);
    if (candidate.cut < no_cut) cuts_[number] = candidate.cut;
    return number;
}

double StudyRuns::cut(std::int64_t number) const {
    const auto found = cuts_.find(number);
    return found == cuts_.end() ? no_cut : found->second;
}

// A result that is there although the journal has none: this program was ended in between, or it was speculated about.
bool StudyRuns::adopt_finished(std::int64_t number) {
    const auto& run = request(number);
    auto result = read_result(run_folder(number), run.key);
    if (result && result->bound && *result->bound <= cut(number)) result.reset();
    // Speculative runs have no cut. Where one is requested with a cut, what is recorded would depend on what lanes had
    // time for.
    const bool may_take = cut(number) == no_cut;
    if (!result && may_take && speculation_.take(run.key, run_folder(number)))
        result = read_result(run_folder(number), run.key);
    if (result) {
        tidy(run_folder(number));
        RunOutcome outcome{number, RunStatus::done, "", {}, result->seconds, 0, folder_bytes(run_folder(number)), 0,
            utc_now(), io::host_name(), ""};
        take_result(*result, outcome);
        journal_.finish(outcome);
        return true;
    }
    for (const auto& [folder, other] : others_) {
        const auto* same = other.find(run.key);
        const auto* outcome = same ? other.outcome(same->number) : nullptr;
        if (!outcome || outcome->status != RunStatus::done) continue;
        auto copy = *outcome;
        copy.number = number;
        if (copy.folder.empty()) copy.folder = (folder / "runs" / request_folder(same->number)).string();
        journal_.finish(copy);
        return true;
    }
    return false;
}

void StudyRuns::write_request(std::int64_t number) const {
    check_disk();
    std::filesystem::remove_all(run_folder(number));
    // One that is lost with the machine's power is written again.
    auto asked = request_of(study_, request(number));
    asked.cut = cut(number);
    study::write_request(run_folder(number), asked, Durability::cached);
}

// A run that fails on a full disk has no outcome: it would be as good as any once there is space.
void StudyRuns::check_space(const RunOutcome& outcome) const {
    std::error_code unknown;
    const auto space = std::filesystem::space(setup_.folder, unknown);
    if (!is_failure(outcome.status) || unknown || space.available >= least_space) return;
    throw SimulationError({setup_.folder.string(), "the disk is full: " + format_bytes(space.available) + " are free",
        "run " + std::to_string(outcome.number) + " " + word(outcome.status) + " there (" + outcome.reason + ")",
        "free some space, then start again: the same command goes on, and what is done stays"});
}

void StudyRuns::finish(const LaneResult& result) {
    const auto outcome = settle(result);
    check_space(outcome);
    journal_.finish(outcome);
    read_again(result.number);
    changed_ = true;
}

namespace {
// Programs of Open MPI that start and end at the same time remove each other's session folder below /tmp.
std::vector<std::string> session_of_its_own(const RunOptions& options, const std::filesystem::path& folder) {
    if (!options.launcher.empty()) return {};
    std::filesystem::create_directories(folder / session_folder);
    return {"OMPI_MCA_orte_tmpdir_base=" + (folder / session_folder).string()};
}
} // namespace

Lanes& StudyRuns::open_lanes() {
    if (!lanes_) {
        lanes_ = std::make_unique<Lanes>(lane_count_, LaneLimits{study_.runs.time_limit, study_.runs.hang_factor,
                                                          study_.runs.hang_least, study_.runs.memory * 1e9});
    }
    return *lanes_;
}

void StudyRuns::start(LaneTask task) {
    task.command = study_.runs.launch_words();
    task.command.insert(task.command.end(), {setup_.program.string(), "forward", task.folder.string()});
    task.environment = session_of_its_own(study_.runs, task.folder);
    open_lanes().start(task);
}

// Removes what the study does not keep.
void StudyRuns::tidy(const std::filesystem::path& folder) const {
    std::error_code ignored;
    std::filesystem::remove_all(folder / session_folder, ignored);
    if (study_.runs.keep == Keep::everything) return;
    const auto run = folder / "run";
    if (study_.runs.keep == Keep::nothing) std::filesystem::remove_all(run, ignored);
    for (const char* name : {"frames", "checkpoints"}) std::filesystem::remove_all(run / name, ignored);
}

RunOutcome StudyRuns::settle(const LaneResult& result) const {
    const auto folder = run_folder(result.number);
    const auto& run = request(result.number);
    RunOutcome out;
    out.number = result.number;
    out.seconds = result.seconds;
    out.peak_bytes = result.peak_bytes;
    out.lane = result.lane;
    out.started = result.started;
    out.host = io::host_name();
    std::optional<ForwardResult> read;
    if (result.end == LaneEnd::none && result.ending.signal == 0 && result.ending.exit_code == 0)
        read = read_result(folder, run.key);
    if (read) {
        take_result(*read, out);
    } else {
        out.status = status_of(result);
        out.reason = reason_of(result, study_.runs, folder);
    }
    tidy(folder);
    out.bytes = folder_bytes(folder);
    return out;
}

void StudyRuns::read_again(std::int64_t number) {
    const auto* outcome = journal_.outcome(number);
    if (!outcome || outcome->status != RunStatus::done || are_read(study_, outcome->figures)) return;
    const auto run = folder_of(number) / "run";
    if (!std::filesystem::exists(run / "steps.csv")) {
        log_.warn(
            "run " + std::to_string(number) + " has other figures than the study reads, and its tables were not kept");
        return;
    }
    auto fresh = *outcome;
    fresh.figures = read_figures(study_, run);
    if (fresh.figures.empty()) return;
    journal_.finish(fresh);
}

void StudyRuns::check_disk() const {
    if (study_.runs.disk <= 0) return;
    double sum = speculation_.bytes();
    for (const auto& run : journal_.runs()) {
        if (const auto* outcome = journal_.outcome(run.number); outcome && outcome->folder.empty())
            sum += outcome->bytes;
    }
    if (sum < study_.runs.disk * 1e9) return;
    throw SimulationError({setup_.folder.string(), "the runs take " + format_bytes(std::uint64_t(sum)),
        "runs.disk allows " + format_bytes(std::uint64_t(study_.runs.disk * 1e9)),
        "raise it, keep less (runs.keep), or remove folders of runs that are done; then start again"});
}

bool StudyRuns::is_answered(std::int64_t number, bool retry_failed) const {
    const auto* outcome = journal_.outcome(number);
    if (!outcome || (retry_failed && is_failure(outcome->status))) return false;
    return outcome->answers(cut(number));
}

std::vector<std::int64_t> StudyRuns::waiting(std::span<const std::int64_t> runs, bool retry_failed) {
    journal_.sync();
    std::vector<std::int64_t> waiting;
    for (const auto number : runs) {
        if (is_answered(number, retry_failed) || (!journal_.outcome(number) && adopt_finished(number))) {
            read_again(number);
            continue;
        }
        if (std::ranges::find(waiting, number) == waiting.end()) waiting.push_back(number);
    }
    return waiting;
}

std::vector<std::int64_t> StudyRuns::longest_first(std::vector<std::int64_t> runs) const {
    const auto work = [&](std::int64_t number) {
        const auto known = work_.find(number);
        return known == work_.end() ? 0.0 : known->second;
    };
    std::ranges::stable_sort(runs, std::ranges::greater{}, work);
    return runs;
}

} // namespace treacle::study
