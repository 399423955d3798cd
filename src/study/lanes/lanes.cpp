#include "study/lanes/lanes.hpp"

#include "base/text/text.hpp"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>

namespace treacle::study {

namespace {
constexpr double look_interval = 0.25; // [s] between polls of the running ones
constexpr double grace = 10;           // [s] from SIGTERM to SIGKILL
constexpr double beside_steps = 10;    // times hang_least before the first step, and while a finished run is compared

double since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The first two numbers of the last whole row: step and time [s].
std::pair<double, double> last_row(const std::filesystem::path& path, std::uintmax_t size) {
    constexpr std::uintmax_t most = 8192;
    std::ifstream file(path, std::ios::binary);
    file.seekg(std::streamoff(size - std::min(size, most)));
    std::string text(std::size_t(std::min(size, most)), '\0');
    file.read(text.data(), std::streamsize(text.size()));
    const auto end = text.rfind('\n');
    if (end == std::string::npos || end == 0) return {0, 0};
    const auto begin = text.rfind('\n', end - 1);
    if (begin == std::string::npos) return {0, 0}; // the header
    const auto row = text.substr(begin + 1, end - begin - 1);
    const auto comma = row.find(','), next = row.find(',', comma + 1);
    if (comma == std::string::npos) return {0, 0};
    return {read_number(row.substr(0, comma)).value_or(0),
        read_number(row.substr(comma + 1, next - comma - 1)).value_or(0)};
}
} // namespace

std::string utc_now() {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    std::tm parts{};
    gmtime_r(&now.tv_sec, &parts);
    char date[32], text[48];
    std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &parts);
    std::snprintf(text, sizeof text, "%s.%03ldZ", date, now.tv_nsec / 1'000'000);
    return text;
}

Lanes::Lanes(int count, const LaneLimits& limits) : count_(count), limits_(limits), last_look_(Clock::now()) {
    sigemptyset(&waited_);
    for (const int signal : {SIGCHLD, SIGINT, SIGTERM, SIGHUP}) sigaddset(&waited_, signal);
    sigprocmask(SIG_BLOCK, &waited_, &earlier_);
}

Lanes::~Lanes() {
    running_.clear();
    sigprocmask(SIG_SETMASK, &earlier_, nullptr);
}

void Lanes::start(const LaneTask& task) {
    std::vector<bool> taken(std::size_t(count_), false);
    for (const auto& run : running_) taken[std::size_t(run.lane)] = true;
    Running run;
    run.task = task;
    run.lane = int(std::ranges::find(taken, false) - taken.begin());
    run.process =
        std::make_unique<ChildProcess>(task.command, task.folder / "log.txt", task.environment, task.oom_score);
    run.start = run.last_step = Clock::now();
    run.started = utc_now();
    running_.push_back(std::move(run));
}

void Lanes::discard(std::int64_t number) {
    std::erase_if(running_, [&](const Running& run) { return run.task.number == number; });
}

void Lanes::end(Running& run, LaneEnd why) {
    if (run.end != LaneEnd::none) return;
    run.end = why;
    run.told = Clock::now();
    // A run that hangs or fills the memory does not end on signals.
    if (why == LaneEnd::hang || why == LaneEnd::memory) {
        run.process->kill();
    } else {
        run.process->ask_to_end();
    }
}

void Lanes::look_at(Running& run) {
    if (run.end != LaneEnd::none) {
        if (since(run.told) > grace) run.process->kill();
        return;
    }
    const double bytes = run.process->resident_bytes();
    run.peak_bytes = std::max(run.peak_bytes, bytes);
    if (limits_.memory > 0 && bytes > limits_.memory) return end(run, LaneEnd::memory);
    if (limits_.time > 0 && since(run.start) > limits_.time) return end(run, LaneEnd::time_limit);
    const auto path = run.task.folder / "run" / "steps.csv";
    std::error_code failed;
    const auto size = std::filesystem::file_size(path, failed);
    if (!failed && size != run.size) {
        run.size = size;
        run.last_step = Clock::now();
        std::tie(run.steps, run.time) = last_row(path, size);
    }
    if (limits_.hang_factor <= 0) return;
    const double mean = run.steps > 0 ? (since(run.start) - since(run.last_step)) / run.steps : 0;
    const bool steps_go_on =
        run.steps > 0 && !std::filesystem::exists(run.task.folder / "run" / "summary.json", failed);
    const double timeout =
        steps_go_on ? std::max(limits_.hang_least, limits_.hang_factor * mean) : beside_steps * limits_.hang_least;
    if (since(run.last_step) > timeout) end(run, LaneEnd::hang);
}

std::vector<LaneResult> Lanes::collect() {
    std::vector<LaneResult> out;
    for (auto run = running_.begin(); run != running_.end();) {
        const auto& ending = run->process->poll();
        if (!ending) {
            ++run;
            continue;
        }
        out.push_back(
            {run->task.number, *ending, run->end, since(run->start), run->peak_bytes, run->lane, run->started});
        run = running_.erase(run);
    }
    std::ranges::sort(out, {}, &LaneResult::number);
    return out;
}

std::vector<LaneResult> Lanes::wait(double seconds) {
    const auto start = Clock::now();
    for (;;) {
        auto ended = collect();
        if (!ended.empty() || stop_asked_ || since(start) >= seconds) return ended;
        if (since(last_look_) >= look_interval) {
            for (auto& run : running_) look_at(run);
            last_look_ = Clock::now();
        }
        const double left = std::clamp(std::min(seconds - since(start), look_interval), 0.001, look_interval);
        const timespec time{0, long(left * 1e9)};
        const int signal = sigtimedwait(&waited_, nullptr, &time);
        stop_asked_ = stop_asked_ || (signal > 0 && signal != SIGCHLD);
    }
}

std::vector<LaneResult> Lanes::stop(double grace) {
    for (auto& run : running_) end(run, LaneEnd::stop);
    std::vector<LaneResult> out;
    const auto start = Clock::now();
    bool killed = false;
    while (!running_.empty()) {
        for (auto& one : collect()) out.push_back(std::move(one));
        if (!killed && since(start) > grace) {
            for (auto& run : running_) run.process->kill();
            killed = true;
        }
        const timespec time{0, 20'000'000};
        if (!running_.empty()) sigtimedwait(&waited_, nullptr, &time);
    }
    return out;
}

std::vector<LaneProgress> Lanes::progress() {
    std::vector<LaneProgress> out;
    for (const auto& run : running_) out.push_back({run.task.number, run.steps, run.time, since(run.start)});
    return out;
}

} // namespace treacle::study
