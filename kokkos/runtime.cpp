#include "kokkos/runtime.hpp"

#include <Kokkos_Core.hpp>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace treacle {

namespace {
// Open MPI makes glibc keep all memory in one heap, where arrays that grow leave holes: a third of a run's memory.
// Large arrays get pages of their own again, and give them back; what solvers allocate anew at each step stays in the
// heap, which is kept.
void keep_large_arrays_out_of_the_heap() {
#if defined(__GLIBC__)
    constexpr int large = 1 << 20; // [B]
    mallopt(M_MMAP_MAX, 1 << 16);
    mallopt(M_MMAP_THRESHOLD, large);
    mallopt(M_TRIM_THRESHOLD, 64 * large);
#endif
}
} // namespace

KokkosRuntime::KokkosRuntime(int& argc, char** argv) {
    keep_large_arrays_out_of_the_heap();
    Kokkos::initialize(argc, argv);
}
KokkosRuntime::~KokkosRuntime() { Kokkos::finalize(); }

const char* execution_space_name() { return Kokkos::DefaultExecutionSpace::name(); }
int kokkos_version() { return KOKKOS_VERSION; }

} // namespace treacle
