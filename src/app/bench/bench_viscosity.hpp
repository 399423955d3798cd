#pragma once
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace treacle::app {

// Arguments of `treacle bench viscosity`.
struct ViscosityBenchRequest {
    std::vector<int> cells;                   // along each side of the cube; empty: 96
    std::vector<std::string> preconditioners; // words of method.viscosity.preconditioner; empty: multilevel, boomeramg
    std::vector<double> stiffness;            // nu dt / dx^2 in place of the viscosities of the cases; empty: those
    double residual = 1e-8;                   // relative
    int repeats = 1;            // solves of each case, one after the other as steps are; the median counts
    std::filesystem::path json; // file for the figures; empty: none
};

// `treacle bench viscosity`: the viscous system of the grid for a ball of liquid over a pool and for a thin sheet on one, in
// a cube of 1 m with no-slip walls, 1000 kg/m3, dt 0.01 s, after gravity and random momenta; iterations and work with
// each preconditioner. Collective. Throws InputError for a preconditioner that there is not.
ExitCode run_viscosity_bench(const Comm& comm, const ViscosityBenchRequest& request);

} // namespace treacle::app
