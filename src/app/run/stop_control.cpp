#include "app/run/stop_control.hpp"

#include <csignal>

namespace treacle::app {

namespace {
volatile std::sig_atomic_t signalled = 0;
void note_signal(int) { signalled = 1; }
constexpr int signals[] = {SIGTERM, SIGINT, SIGHUP, SIGUSR1};
} // namespace

StopControl::StopControl(const Comm& comm, std::filesystem::path stop_file, double wall_limit)
    : comm_(comm), stop_file_(std::move(stop_file)), wall_limit_(wall_limit), start_(std::chrono::steady_clock::now()) {
    signalled = 0;
    for (const int number : signals) {
        earlier_.emplace_back(number, std::signal(number, note_signal));
        // Stays ignored, as under nohup.
        if (earlier_.back().second == SIG_IGN) std::signal(number, SIG_IGN);
    }
}

StopControl::~StopControl() {
    for (const auto& [number, handler] : earlier_) {
        // A warning of a time limit must not kill a program whose run has just ended.
        const auto by_default = number == SIGUSR1 ? SIG_IGN : SIG_DFL;
        std::signal(number, handler == SIG_ERR || handler == SIG_DFL ? by_default : handler);
    }
}

double StopControl::wall_seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

StopControl::Reason StopControl::ask() {
    auto reason = Reason::none;
    if (comm_.is_root()) {
        std::error_code ignored;
        if (wall_limit_ > 0 && wall_seconds() > wall_limit_) reason = Reason::wall_limit;
        if (std::filesystem::exists(stop_file_, ignored)) reason = Reason::stop_file;
    }
    if (signalled != 0) reason = Reason::signal;
    // The reasons are numbered; the largest one of any rank counts on all.
    const auto order = [](Reason r) { return r == Reason::none ? 0 : 4 - static_cast<int>(r); };
    const auto most = comm_.max(static_cast<std::int64_t>(order(reason)));
    return most == 0 ? Reason::none : static_cast<Reason>(4 - most);
}

void StopControl::clear() {
    std::error_code missing;
    if (comm_.is_root()) std::filesystem::remove(stop_file_, missing);
}

std::string describe(StopControl::Reason reason) {
    switch (reason) {
    case StopControl::Reason::none: return "";
    case StopControl::Reason::signal: return "a signal";
    case StopControl::Reason::stop_file: return "the file STOP";
    case StopControl::Reason::wall_limit: return "the time limit";
    }
    return "";
}

} // namespace treacle::app
