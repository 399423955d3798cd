#include "base/text/floating_point_traps.hpp"

#include <array>
#include <cfenv>
#include <csignal>
#include <cstring>
#include <stdexcept>

#ifdef __GLIBC__
#include <execinfo.h>
#include <unistd.h>
#endif

namespace treacle {

#ifdef __GLIBC__
namespace {

void print(const char* text) { // in a signal handler: without buffers or memory of its own
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text, std::strlen(text));
}

const char* kind_of(int code) {
    switch (code) {
    case FPE_FLTINV: return "an invalid floating-point operation";
    case FPE_FLTDIV: return "a floating-point division by zero";
    case FPE_FLTOVF: return "a floating-point overflow";
    case FPE_INTDIV: return "an integer division by zero";
    default: return "an arithmetic exception";
    }
}

void report_and_end(int number, siginfo_t* info, void*) {
    print("trapped ");
    print(kind_of(info->si_code));
    print("; the calls that led there, innermost first:\n");
    std::array<void*, 64> calls{};
    ::backtrace_symbols_fd(calls.data(), ::backtrace(calls.data(), static_cast<int>(calls.size())), STDERR_FILENO);
    std::signal(number, SIG_DFL);
    std::raise(number);
}

} // namespace

void trap_non_finite() {
    std::array<void*, 1> first{};
    ::backtrace(first.data(), 1); // its first call takes memory, which the handler may not
    struct sigaction action = {};
    action.sa_sigaction = report_and_end;
    action.sa_flags = SA_SIGINFO;
    sigemptyset(&action.sa_mask);
    if (sigaction(SIGFPE, &action, nullptr) != 0 || feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW) == -1)
        throw std::runtime_error("floating-point traps cannot be set on this processor");
}
#else
void trap_non_finite() { throw std::runtime_error("floating-point traps need the GNU C library"); }
#endif

} // namespace treacle
