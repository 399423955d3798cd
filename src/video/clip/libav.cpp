#include "video/clip/libav.hpp"

#include <array>
#include <cstdarg>
#include <cstdio>
#include <mutex>
#include <utility>

extern "C" {
#include <libavutil/error.h>
#include <libavutil/log.h>
}

namespace treacle::video::libav {

namespace {
std::mutex complaint_guard;
std::string complaint; // the first one

void keep_line(void*, int level, const char* format, va_list arguments) {
    if (level > AV_LOG_ERROR) return;
    std::array<char, 512> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    const std::scoped_lock lock(complaint_guard);
    if (!complaint.empty()) return;
    complaint = text.data();
    while (!complaint.empty() && (complaint.back() == '\n' || complaint.back() == '.')) complaint.pop_back();
}
} // namespace

void capture_log() { av_log_set_callback(keep_line); }

std::string take_complaint() {
    const std::scoped_lock lock(complaint_guard);
    return std::exchange(complaint, "");
}

std::string error_text(int code) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    av_strerror(code, text.data(), text.size());
    return text.data();
}

} // namespace treacle::video::libav
