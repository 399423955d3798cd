#pragma once
#include <cstdio>
#include <string>

namespace treacle {

// Output on rank 0, none on the others.
enum class LogOutput { enabled, disabled };

// Lines on the terminal. Only rank 0 prints; the calls of the other ranks do nothing.
// The progress bar is drawn only when the stream is a terminal.
class Log {
public:
    explicit Log(LogOutput output, std::FILE* stream = stdout);
    ~Log();
    Log(const Log&) = delete;
    Log& operator=(const Log&) = delete;

    // Writes and flushes one line, above the bar; warn() puts "warning: " before it.
    void line(const std::string& text);
    void warn(const std::string& text);

    // Redraws the bar under the last line; `fraction` in [0, 1], `text` behind it.
    void progress(double fraction, const std::string& text);
    void clear_progress();

    bool is_terminal() const { return is_terminal_; } // of the stream, on any rank

private:
    LogOutput output_;
    std::FILE* stream_;
    bool is_terminal_;
    bool bar_shown_ = false;
};

// "[#####.....]  50 %  text"
std::string progress_bar(double fraction, const std::string& text);

} // namespace treacle
