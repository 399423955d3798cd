#include "study/lanes/status.hpp"

#include "base/text/text.hpp"
#include "io/value.hpp"

#include <algorithm>

namespace treacle::study {

StudyStatus count_runs(const Journal& journal, std::span<const std::int64_t> runs) {
    StudyStatus out;
    out.asked = runs.size();
    double sum = 0;
    for (const auto number : runs) {
        const auto* outcome = journal.outcome(number);
        if (!outcome) continue;
        if (is_failure(outcome->status)) {
            ++out.failed;
            continue;
        }
        ++(outcome->status == RunStatus::done ? out.done : out.stopped_early);
        sum += outcome->seconds;
    }
    if (const auto whole = out.done + out.stopped_early; whole > 0) out.mean_seconds = sum / double(whole);
    return out;
}

double time_left(const StudyStatus& status, std::size_t fresh, double simulated_end) {
    double whole = status.mean_seconds; // of one run
    for (const auto& run : status.running) {
        if (whole <= 0 && run.time > 0 && simulated_end > 0) whole = run.seconds * simulated_end / run.time;
    }
    if (whole <= 0) return -1;
    const auto ended = status.done + status.stopped_early + status.failed;
    double work = double(std::min(fresh, status.asked - std::min(ended, status.asked))) * whole;
    for (const auto& run : status.running) work -= std::min(run.seconds, whole);
    return std::max(0.0, work) / std::max(1, status.lanes);
}

std::string describe(const StudyStatus& status) {
    std::string out = std::to_string(status.done) + " done, " + std::to_string(status.running.size()) + " running";
    if (status.speculative > 0) out += ", " + std::to_string(status.speculative) + " speculative";
    if (status.stopped_early > 0) out += ", " + std::to_string(status.stopped_early) + " stopped early";
    if (status.failed > 0) out += ", " + std::to_string(status.failed) + " failed";
    out += " of " + std::to_string(status.asked);
    return status.left < 0 ? out : out + ", " + format_duration(status.left) + " left";
}

void write_status(const std::filesystem::path& path, const StudyStatus& status) {
    using io::Value;
    Value running = Value::list({});
    for (const auto& run : status.running) {
        running.add(Value::object(
            {{"run", run.number}, {"step", run.steps}, {"time [s]", run.time}, {"wall time [s]", run.seconds}}));
    }
    Value out = Value::object({{"asked", std::int64_t(status.asked)}, {"done", std::int64_t(status.done)},
        {"failed", std::int64_t(status.failed)}, {"running", running},
        {"speculative", std::int64_t(status.speculative)}});
    if (status.stopped_early > 0) out.set("stopped early", std::int64_t(status.stopped_early));
    if (status.lanes > 0) out.set("lanes", status.lanes);
    if (status.seconds > 0) out.set("wall time of this sitting [s]", status.seconds);
    if (status.left >= 0) out.set("time left [s]", status.left);
    io::write_json(path, out);
}

} // namespace treacle::study
