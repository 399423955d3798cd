// A tool of Kokkos (KOKKOS_PROFILE_LIBRARY): processor seconds that this process has spent in kernels, and altogether, on stderr at the end.
#include <cstdint>
#include <cstdio>
#include <ctime>

namespace {
double start = 0, seconds = 0; // [s]
std::uint64_t kernels = 0;
int depth = 0;

// Of this process [s], whatever else the machine does.
double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void begin(std::uint64_t* number) {
    *number = kernels;
    if (depth++ == 0) start = processor_time();
}

void end() {
    if (--depth > 0) return;
    seconds += processor_time() - start;
    ++kernels;
}
} // namespace

extern "C" {
void kokkosp_begin_parallel_for(const char*, std::uint32_t, std::uint64_t* number) { begin(number); }
void kokkosp_end_parallel_for(std::uint64_t) { end(); }
void kokkosp_begin_parallel_reduce(const char*, std::uint32_t, std::uint64_t* number) { begin(number); }
void kokkosp_end_parallel_reduce(std::uint64_t) { end(); }
void kokkosp_begin_parallel_scan(const char*, std::uint32_t, std::uint64_t* number) { begin(number); }
void kokkosp_end_parallel_scan(std::uint64_t) { end(); }
void kokkosp_finalize_library() {
    std::fprintf(stderr, "kernels: %llu in %.6f of %.6f s\n", static_cast<unsigned long long>(kernels), seconds,
        processor_time());
}
}
