#include "study/lanes/status.hpp"
#include "study/study_runs.hpp"

#include <algorithm>

namespace treacle::study {

namespace {
constexpr double stop_grace = 20; // [s] for runs that got SIGTERM
} // namespace

void StudyRuns::offer(std::vector<Candidate> candidates) {
    if (!study_.runs.speculate) return;
    const bool none = candidates.empty();
    speculation_.offer(std::move(candidates));
    if (!none) return;
    while (const auto number = speculation_.least_wanted()) give_up(*number);
    lanes_.reset();
}

void StudyRuns::give_up(std::int64_t speculative) {
    open_lanes().discard(speculative);
    speculation_.ended(speculative);
}

// Requested runs, each on a free lane or one that speculates; on the lanes that are left what is speculated about.
void StudyRuns::fill_lanes(std::deque<std::int64_t>& queue, std::set<std::int64_t>& under_way) {
    const auto make_room = [&](std::optional<std::int64_t> number) {
        if (number) give_up(*number);
        return number.has_value();
    };
    for (; !queue.empty(); queue.pop_front()) {
        const auto number = queue.front();
        if (cut(number) < no_cut || !speculation_.claim(request(number).key)) {
            if (open_lanes().free() == 0 && !make_room(speculation_.least_wanted())) break;
            write_request(number);
            LaneTask task;
            task.number = number;
            task.folder = run_folder(number);
            start(std::move(task));
        }
        under_way.insert(number);
    }
    while (queue.empty() && (open_lanes().free() > 0 || make_room(speculation_.stale()))) {
        auto task = speculation_.next(journal_);
        if (!task) break;
        start(std::move(*task));
    }
}

void StudyRuns::take(
    const std::vector<LaneResult>& results, std::deque<std::int64_t>& queue, std::set<std::int64_t>& under_way) {
    for (const auto& result : results) {
        if (result.number > 0) {
            under_way.erase(result.number);
            // A run that was stopped has no outcome; it is done again.
            if (result.end == LaneEnd::stop && (result.ending.exit_code != 0 || result.ending.signal != 0)) continue;
            finish(result);
            continue;
        }
        const auto ended = speculation_.ended(result.number);
        if (!ended.claimed) continue;
        const auto number = journal_.find(ended.key)->number;
        under_way.erase(number);
        changed_ = true;
        // One that failed fails again, and then logs the reason.
        if (!adopt_finished(number)) queue.push_front(number);
    }
}

StudyEnd StudyRuns::run(std::span<const std::int64_t> runs, bool retry_failed) {
    const auto waiting = longest_first(this->waiting(runs, retry_failed));
    std::deque<std::int64_t> queue(waiting.begin(), waiting.end());
    std::set<std::int64_t> under_way;
    const auto stop_file = setup_.folder / "STOP";
    while (!queue.empty() || !under_way.empty()) {
        fill_lanes(queue, under_way);
        take(open_lanes().wait(1.0), queue, under_way);
        report(runs, waiting.size(), open_lanes().progress(), lane_count_);
        std::error_code ignored;
        if (open_lanes().stop_asked() || std::filesystem::remove(stop_file, ignored)) {
            log_.clear_progress();
            log_.line("asked to stop: ending the runs under way; the same command goes on from here");
            take(open_lanes().stop(stop_grace), queue, under_way);
            lanes_.reset();
            return StudyEnd::stopped;
        }
    }
    if (speculation_.is_idle()) lanes_.reset();
    log_.clear_progress();
    return StudyEnd::complete;
}

void StudyRuns::report(
    std::span<const std::int64_t> runs, std::size_t fresh, std::vector<LaneProgress> under_way, int lanes) {
    const auto now = std::chrono::steady_clock::now();
    if (std::chrono::duration<double>(now - last_report_).count() < 1) return;
    last_report_ = now;
    StudyStatus status = count_runs(journal_, runs);
    for (const auto& one : under_way) {
        if (one.number > 0) status.running.push_back(one);
        if (one.number < 0) ++status.speculative;
    }
    status.lanes = lanes;
    status.seconds = std::chrono::duration<double>(now - start_).count();
    status.left = time_left(status, fresh, simulated_end_);
    write_status(setup_.folder / "status.json", status);
    if (changed_ && setup_.changed) setup_.changed();
    changed_ = false;
    log_.progress(
        double(status.done + status.stopped_early + status.failed) / double(std::max<std::size_t>(1, runs.size())),
        describe(status));
}

} // namespace treacle::study
