#include "study/study_runs.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "io/manifest.hpp"
#include "study/forward_files.hpp"
#include "study/readings.hpp"
#include "study/status.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <thread>
#include <unistd.h>

namespace treacle::study {

namespace {
constexpr const char* session_folder = "session";
constexpr double stop_grace = 20; // [s] for runs that are asked to end

// The last line of a run's log that says something: the error that ended it.
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
    const auto told = read_failure(folder);
    if (!told.empty()) return told;
    const auto words = last_words(folder / "log.txt");
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
    // A launcher tells the signal of a rank so.
    return result.ending.exit_code > 128 && result.ending.exit_code < 160 ? RunStatus::killed : RunStatus::failed;
}

} // namespace

std::vector<Assignment> assignments_of(const Study& study, const StudyScene& scene, const Point& values) {
    std::vector<Assignment> out;
    for (const auto& text : scene.set) out.push_back({text, scene.where + ": set " + text});
    for (const auto& one : study.measured) out.push_back({one.key + "=" + one.value, one.where + ": " + one.name});
    for (std::size_t i = 0; i < study.parameters.size(); ++i) {
        const auto& parameter = study.parameters[i];
        out.push_back({parameter.key + "=" + values.at(i), parameter.where + ": " + parameter.name + " = " + values[i]});
    }
    return out;
}

std::string program_identity() {
    const auto build = io::build_info();
    return "treacle " + build.version + " (" + build.commit + ", " + build.state + ", " + build.compiler + ", " + build.type + ")";
}

std::string run_key(const SceneFacts& facts, int ranks, const std::string& program) {
    return io::text_hash(program + "\nranks " + std::to_string(ranks) + "\n" + facts.content);
}

JournalOwner owner_of(const Study& study, const std::string& program) {
    std::string text;
    for (const auto& scene : study.scenes) text += "scene " + scene.name + "\n";
    for (const auto& parameter : study.parameters) text += "parameter " + parameter.name + " " + parameter.key + "\n";
    return {io::text_hash(text), program};
}

Candidate candidate_of(const Study& study, const StudyScene& scene, const Point& values, const SceneReader& read_scene) {
    const auto facts = read_scene(study.scene_file(scene), assignments_of(study, scene, values));
    return {scene.name, values, run_key(facts, study.runs.ranks, program_identity()), facts.end, facts.work};
}

namespace {
// "study.yaml:6: viscosity = -10 Pa.s" as far as the name.
std::string without_values(const std::string& text) { return text.substr(0, text.find(" = ")); }
} // namespace

std::vector<Candidate> candidates_of(const Study& study, const std::vector<Point>& points, const SceneReader& read_scene) {
    std::vector<Candidate> out;
    std::vector<Diagnostic> problems;
    for (const auto& point : points) {
        for (const auto& scene : study.scenes) {
            try {
                out.push_back(candidate_of(study, scene, point, read_scene));
            } catch (const InputError& error) {
                // What is wrong with a key at every point is told once, with the first value.
                for (const auto& problem : error.diagnostics()) {
                    const bool known = std::ranges::any_of(problems, [&](const Diagnostic& one) {
                        return without_values(one.where) == without_values(problem.where) && without_values(one.problem) == without_values(problem.problem);
                    });
                    if (!known) problems.push_back(problem);
                }
            }
        }
    }
    if (!problems.empty()) throw InputError(problems);
    return out;
}

namespace {
const std::filesystem::path& made(const std::filesystem::path& folder) {
    std::error_code failed;
    std::filesystem::create_directories(folder / "runs", failed);
    if (failed) throw InputError({folder.string(), "cannot be made", failed.message(), "choose another folder with --out"});
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
                      study.runs.launcher.empty() ? "it starts the " + std::to_string(study.runs.ranks) + " ranks of each run" : "it is in front of each run's command",
                      "check its name and the PATH, or load its module"});
}

StudyRuns::StudyRuns(const Study& study, StudySetup setup, Log& log)
    : study_(study), setup_(std::move(setup)), log_(log), lock_(made(setup_.folder)), journal_(Journal::open(setup_.folder, owner_of(study, program_identity()))),
      program_(program_identity()), lane_count_(lane_count(study.runs)),
      start_(std::chrono::steady_clock::now()), last_report_(start_) {
    if (!lock_.warning().empty()) log_.warn(lock_.warning());
    for (const auto& other : study_.runs.reuse) {
        const auto folder = std::filesystem::path(other).is_absolute() ? std::filesystem::path(other) : study_.path.parent_path() / other;
        others_.emplace_back(folder, Journal::read(folder));
    }
}

std::filesystem::path StudyRuns::run_folder(std::int64_t number) const { return setup_.folder / "runs" / request_folder(number); }

std::int64_t StudyRuns::ask(const Candidate& candidate) {
    simulated_end_ = candidate.end;
    const auto* known = journal_.find(candidate.key);
    const auto number = known ? known->number : journal_.ask(candidate.scene, candidate.values, candidate.key).number;
    work_[number] = candidate.work;
    return number;
}

// A result that is there although the journal has none: this program was ended in between.
bool StudyRuns::adopt_finished(std::int64_t number) {
    const auto& run = journal_.runs()[std::size_t(number - 1)];
    if (const auto result = read_result(run_folder(number), run.key)) {
        RunOutcome outcome{number, RunStatus::done, "", result->figures, result->seconds, result->peak_bytes, folder_bytes(run_folder(number)), 0, utc_now(), io::host_name(), ""};
        tidy(number);
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
    study::write_request(run_folder(number), request_of(study_, journal_.runs()[std::size_t(number - 1)]), Durability::cached);
}

void StudyRuns::finish(const LaneResult& result) {
    journal_.finish(settle(result));
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

void StudyRuns::start(std::int64_t number, Lanes& lanes) const {
    const auto folder = run_folder(number);
    write_request(number);
    auto command = study_.runs.launch_words();
    command.insert(command.end(), {setup_.program.string(), "forward", folder.string()});
    lanes.start({number, folder, command, session_of_its_own(study_.runs, folder)});
}

// Removes what the study does not keep.
void StudyRuns::tidy(std::int64_t number) const {
    std::error_code unimportant;
    std::filesystem::remove_all(run_folder(number) / session_folder, unimportant);
    if (study_.runs.keep == Keep::everything) return;
    const auto run = run_folder(number) / "run";
    std::error_code ignored;
    if (study_.runs.keep == Keep::nothing) std::filesystem::remove_all(run, ignored);
    for (const char* name : {"frames", "checkpoints"}) std::filesystem::remove_all(run / name, ignored);
}

RunOutcome StudyRuns::settle(const LaneResult& result) const {
    const auto folder = run_folder(result.number);
    const auto& run = journal_.runs()[std::size_t(result.number - 1)];
    RunOutcome out;
    out.number = result.number;
    out.seconds = result.seconds;
    out.peak_bytes = result.peak_bytes;
    out.lane = result.lane;
    out.started = result.started;
    out.host = io::host_name();
    std::optional<ForwardResult> read;
    if (result.end == LaneEnd::none && result.ending.signal == 0 && result.ending.exit_code == 0) read = read_result(folder, run.key);
    if (read) {
        out.figures = read->figures;
        out.peak_bytes = std::max(out.peak_bytes, read->peak_bytes);
    } else {
        out.status = status_of(result);
        out.reason = reason_of(result, study_.runs, folder);
    }
    tidy(result.number);
    out.bytes = folder_bytes(folder);
    return out;
}

void StudyRuns::read_again(std::int64_t number) {
    const auto* outcome = journal_.outcome(number);
    if (!outcome || outcome->status != RunStatus::done || are_read(study_, outcome->figures)) return;
    const auto run = (outcome->folder.empty() ? run_folder(number) : std::filesystem::path(outcome->folder)) / "run";
    if (!std::filesystem::exists(run / "steps.csv")) {
        log_.warn("run " + std::to_string(number) + " has other figures than the study reads, and its tables were not kept");
        return;
    }
    auto fresh = *outcome;
    fresh.figures = read_figures(study_, run);
    if (fresh.figures.empty()) return;
    journal_.finish(fresh);
}

void StudyRuns::check_disk() const {
    if (study_.runs.disk <= 0) return;
    double sum = 0;
    for (const auto& run : journal_.runs()) {
        if (const auto* outcome = journal_.outcome(run.number); outcome && outcome->folder.empty()) sum += outcome->bytes;
    }
    if (sum < study_.runs.disk * 1e9) return;
    throw SimulationError({setup_.folder.string(), "the runs take " + format_bytes(std::uint64_t(sum)),
                           "runs.disk allows " + format_bytes(std::uint64_t(study_.runs.disk * 1e9)),
                           "raise it, keep less (runs.keep), or remove folders of runs that are done; then start again"});
}

std::vector<std::int64_t> StudyRuns::waiting(std::span<const std::int64_t> runs, bool retry_failed) {
    journal_.sync();
    std::vector<std::int64_t> waiting;
    for (const auto number : runs) {
        const auto* outcome = journal_.outcome(number);
        const bool again = outcome && retry_failed && outcome->status != RunStatus::done;
        if ((outcome && !again) || (!outcome && adopt_finished(number))) {
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

StudyEnd StudyRuns::run(std::span<const std::int64_t> runs, bool retry_failed) {
    const auto waiting = longest_first(this->waiting(runs, retry_failed));
    if (waiting.empty()) return StudyEnd::complete;
    Lanes lanes(lane_count_, {study_.runs.time_limit, study_.runs.hang_factor, study_.runs.hang_least, study_.runs.memory * 1e9});
    std::size_t next = 0;
    const auto take = [&](const std::vector<LaneResult>& results) {
        for (const auto& result : results) {
            // A run that was asked to end has no outcome; it is done again.
            if (result.end == LaneEnd::stop && (result.ending.exit_code != 0 || result.ending.signal != 0)) continue;
            finish(result);
        }
    };
    const auto stop_file = setup_.folder / "STOP";
    for (;;) {
        while (next < waiting.size() && lanes.free() > 0) {
            start(waiting[next++], lanes);
        }
        if (lanes.idle()) break;
        take(lanes.wait(1.0));
        report(runs, waiting.size(), lanes);
        std::error_code ignored;
        if (lanes.stop_asked() || std::filesystem::remove(stop_file, ignored)) {
            log_.clear_progress();
            log_.line("asked to stop: ending the runs under way; the same command goes on from here");
            take(lanes.stop(stop_grace));
            return StudyEnd::stopped;
        }
    }
    log_.clear_progress();
    return StudyEnd::complete;
}

void StudyRuns::report(std::span<const std::int64_t> runs, std::size_t fresh, Lanes& lanes) {
    const auto now = std::chrono::steady_clock::now();
    if (std::chrono::duration<double>(now - last_report_).count() < 1) return;
    last_report_ = now;
    StudyStatus status = count_runs(journal_, runs);
    status.running = lanes.progress();
    status.lanes = lane_count_;
    status.seconds = std::chrono::duration<double>(now - start_).count();
    status.left = time_left(status, fresh, simulated_end_);
    write_status(setup_.folder / "status.json", status);
    if (changed_ && setup_.changed) setup_.changed();
    changed_ = false;
    log_.progress(double(status.done + status.failed) / double(std::max<std::size_t>(1, runs.size())), describe(status));
}

} // namespace treacle::study
