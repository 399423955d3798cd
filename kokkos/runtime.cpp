#include "kokkos/runtime.hpp"

#include <Kokkos_Core.hpp>

namespace treacle {

KokkosRuntime::KokkosRuntime(int& argc, char** argv) { Kokkos::initialize(argc, argv); }
KokkosRuntime::~KokkosRuntime() { Kokkos::finalize(); }

const char* execution_space_name() { return Kokkos::DefaultExecutionSpace::name(); }
int kokkos_version() { return KOKKOS_VERSION; }

} // namespace treacle
