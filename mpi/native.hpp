#pragma once
#include "mpi/comm.hpp"

#include <mpi.h>

namespace treacle {

// The native communicator, for the libraries that need one. Link MPI::MPI_CXX to include this.
static_assert(sizeof(MPI_Comm) <= sizeof(std::intptr_t));
inline MPI_Comm native(const Comm& comm) { return (MPI_Comm)comm.handle(); }

} // namespace treacle
