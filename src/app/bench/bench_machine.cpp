#include "app/bench/bench_machine.hpp"

#include "kokkos/runtime.hpp"

#include <chrono>
#include <fstream>
#include <sys/resource.h>
#include <thread>

namespace treacle::app {

namespace {
constexpr std::size_t triad_length = std::size_t{1} << 23; // 64 MiB per array

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (line.rfind("model name", 0) != 0) continue;
        const auto colon = line.find(": ");
        if (colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

std::string dotted(int version) { // 30401 is 3.4.1
    return std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
           std::to_string(version % 100);
}

double triad_seconds(const Array<double>& a, const Array<double>& b, const Array<double>& c) {
    Kokkos::fence();
    const auto start = std::chrono::steady_clock::now();
    Kokkos::parallel_for(
        "treacle::triad", static_cast<int>(triad_length), KOKKOS_LAMBDA(int i) { a(i) = b(i) + 0.5 * c(i); });
    Kokkos::fence();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}
} // namespace

Machine describe_machine() {
    return {processor_name(), static_cast<int>(std::thread::hardware_concurrency()),
        "Kokkos " + dotted(kokkos_version()) + " " + execution_space_name()};
}

double peak_memory() {
    struct rusage usage {};
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * double(usage.ru_maxrss);
}

Triad::Triad()
    : a_("treacle::triad_a", triad_length), b_("treacle::triad_b", triad_length), c_("treacle::triad_c", triad_length) {
    Kokkos::deep_copy(a_, 0.0);
    Kokkos::deep_copy(b_, 1.0);
    Kokkos::deep_copy(c_, 2.0);
    triad_seconds(a_, b_, c_);
}

Triad::Bandwidth Triad::measure(const Comm& comm) const {
    constexpr int passes = 3;
    constexpr double bytes = 3.0 * sizeof(double) * triad_length;
    Bandwidth out;
    for (int k = 0; k < passes; ++k) {
        comm.barrier();
        const double alone = comm.is_root() ? triad_seconds(a_, b_, c_) : 0.0;
        out.one = math::max(out.one, bytes / comm.max(alone));
        comm.barrier();
        out.all = math::max(out.all, bytes * comm.size() / comm.max(triad_seconds(a_, b_, c_)));
    }
    return out;
}

} // namespace treacle::app
