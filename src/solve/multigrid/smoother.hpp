#pragma once

namespace treacle::solve {

// Relaxation before and after the correction from below; symmetric as a pair.
enum class Smoother {
    gauss_seidel, // rows in order on the way down, in reverse on the way up; each rank within its own rows, one thread
    jacobi,       // weighted
    chebyshev,    // (ML6) polynomial of degree 2, in kernels; takes neither relaxation nor interface_sweeps
};
// The faster one on this back end: chebyshev where Kokkos runs kernels on several threads or a device, else gauss_seidel.
Smoother default_smoother();

// Visits of the coarse levels in one application.
enum class Cycle {
    v, // each coarse level once
    w, // each coarse level twice for each time of the one above; galerkin only, where it is positive (src/solve/theory.md)
};

} // namespace treacle::solve
