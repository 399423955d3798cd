#include "base/text/progress.hpp"

#include "base/text/text.hpp"

#include <cmath>

namespace treacle {

namespace {
constexpr auto line_interval = std::chrono::seconds(5);
constexpr auto bar_interval = std::chrono::milliseconds(100);

std::string tenths(double seconds) { return format_number(std::round(10 * seconds) / 10); }
} // namespace

void Progress::report(std::int64_t done, std::int64_t total) {
    done_ = done;
    total_ = total;
    const auto now = Clock::now();
    if (log_.is_terminal()) {
        if (now - last_ < bar_interval && done < total) return;
        last_ = now;
        const double fraction = total > 0 ? static_cast<double>(done) / static_cast<double>(total) : 1;
        const auto left =
            done > 0
                ? format_duration(seconds() * static_cast<double>(total - done) / static_cast<double>(done)) + " left"
                : "";
        log_.progress(
            fraction, task_ + ": " + std::to_string(done) + " of " + std::to_string(total) + " " + unit_ + ", " + left);
        return;
    }
    if (now - last_ < line_interval) return;
    last_ = now;
    write_line();
}

void Progress::write_line() {
    const double remaining =
        done_ > 0 ? seconds() * static_cast<double>(total_ - done_) / static_cast<double>(done_) : 0;
    log_.line("progress " + task_ + " done=" + std::to_string(done_) + " total=" + std::to_string(total_) +
              " seconds=" + tenths(seconds()) + " remaining=" + tenths(remaining));
    written_ = done_;
}

void Progress::finish() {
    log_.clear_progress();
    if (!log_.is_terminal() && written_ != done_ && total_ > 0) write_line();
}

} // namespace treacle
