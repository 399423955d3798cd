#include "base/text/log.hpp"

#include <algorithm>
#include <cmath>
#include <unistd.h>

namespace treacle {

Log::Log(LogOutput output, std::FILE* stream)
    : output_(output), stream_(stream), is_terminal_(::isatty(::fileno(stream)) == 1) {}

Log::~Log() { clear_progress(); }

void Log::line(const std::string& text) {
    if (output_ == LogOutput::disabled) return;
    clear_progress();
    std::fprintf(stream_, "%s\n", text.c_str());
    std::fflush(stream_);
}

void Log::warn(const std::string& text) { line("warning: " + text); }

void Log::progress(double fraction, const std::string& text) {
    if (output_ == LogOutput::disabled || !is_terminal_) return;
    std::fprintf(stream_, "\r\033[K%s", progress_bar(fraction, text).c_str());
    std::fflush(stream_);
    bar_shown_ = true;
}

void Log::clear_progress() {
    if (!bar_shown_) return;
    std::fputs("\r\033[K", stream_);
    std::fflush(stream_);
    bar_shown_ = false;
}

std::string progress_bar(double fraction, const std::string& text) {
    constexpr int width = 30;
    fraction = std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0;
    const auto full = static_cast<std::size_t>(fraction * width);
    std::string percent = std::to_string(static_cast<int>(fraction * 100));
    percent.insert(0, 3 - percent.size(), ' ');
    return "[" + std::string(full, '#') + std::string(width - full, '.') + "] " + percent + " %  " + text;
}

} // namespace treacle
