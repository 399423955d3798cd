#pragma once
#include "kokkos/types.hpp"
#include "mpi/comm.hpp"

#include <string>

namespace treacle::app {

// Machine and build on which the figures of a benchmark depend.
struct Machine {
    std::string processor; // "unknown" where the system has no such entry
    int cores = 0;         // of this rank's node
    std::string back_end;  // "Kokkos 3.4.1 Serial"
};
Machine describe_machine();

// Most memory that this rank has held up to now [bytes].
double peak_memory();

// The memory bandwidth that ranks can have: a_i = b_i + s c_i on arrays that no cache holds. The arrays are
// written when this is made, so that they count as memory from then on.
class Triad {
public:
    Triad();
    // Collective: bytes read and written per second by the first rank alone and by all ranks at once, summed.
    struct Bandwidth {
        double one = 0, all = 0; // [bytes/s]
    };
    Bandwidth measure(const Comm& comm) const;

private:
    Array<double> a_, b_, c_;
};

} // namespace treacle::app
