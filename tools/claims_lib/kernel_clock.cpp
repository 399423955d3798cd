// A tool of Kokkos (KOKKOS_PROFILE_LIBRARY): whenever a kernel named KERNEL_CLOCK_MARK begins, a line in the file KERNEL_CLOCK_FILE of the
// kernels so far, the processor time in them, and the processor time of this process [s].
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace {
const char* mark = std::getenv("KERNEL_CLOCK_MARK");
std::FILE* marks = nullptr;
double start = 0, seconds = 0; // [s]
unsigned long long kernels = 0;
int depth = 0;

double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void begin(const char* name, std::uint64_t* number) {
    *number = kernels;
    if (depth++ > 0) return;
    start = processor_time();
    if (marks && mark && std::strcmp(name, mark) == 0) std::fprintf(marks, "%llu %.9f %.9f\n", kernels, seconds, start);
}

void end() {
    if (--depth > 0) return;
    seconds += processor_time() - start;
    ++kernels;
}
} // namespace

extern "C" {
void kokkosp_init_library(int, std::uint64_t, std::uint32_t, void*) {
    if (const char* path = std::getenv("KERNEL_CLOCK_FILE")) marks = std::fopen(path, "w");
}
void kokkosp_finalize_library() {
    if (marks) std::fclose(marks);
}
void kokkosp_begin_parallel_for(const char* name, std::uint32_t, std::uint64_t* number) { begin(name, number); }
void kokkosp_end_parallel_for(std::uint64_t) { end(); }
void kokkosp_begin_parallel_reduce(const char* name, std::uint32_t, std::uint64_t* number) { begin(name, number); }
void kokkosp_end_parallel_reduce(std::uint64_t) { end(); }
void kokkosp_begin_parallel_scan(const char* name, std::uint32_t, std::uint64_t* number) { begin(name, number); }
void kokkosp_end_parallel_scan(std::uint64_t) { end(); }
}
