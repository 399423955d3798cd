#pragma once

namespace treacle {

// Initialises Kokkos for the life of this object; arrays must be gone before it ends.
class KokkosRuntime {
public:
    KokkosRuntime(int& argc, char** argv);
    ~KokkosRuntime();
    KokkosRuntime(const KokkosRuntime&) = delete;
    KokkosRuntime& operator=(const KokkosRuntime&) = delete;
};

// Name of the execution space that kernels run on, such as "Serial".
const char* execution_space_name();
// Version of Kokkos, such as 30401.
int kokkos_version();

} // namespace treacle
