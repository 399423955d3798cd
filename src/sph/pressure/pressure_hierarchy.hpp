#pragma once
#include "solve/krylov/krylov.hpp"
#include "solve/multigrid/multilevel.hpp"
#include "sph/model/domain.hpp"
#include "sph/model/neighbourhood.hpp"
#include "sph/model/options.hpp"

#include <memory>
#include <vector>

namespace treacle::sph {

// The multilevel preconditioner of the pressure system: the algebra with the cells of the unknowns.
class PressureHierarchy {
public:
    PressureHierarchy(const Comm& comm, const SphOptions& options, const Constants& constants, const DomainBox& domain,
        const CellGrid& grid);

    // For the solver; refers to this object.
    solve::UserPreconditioner preconditioner();
    // Before each solve: the particles of the system, ghosts with current roles, alive until the solve ends.
    void refer_to(const LiquidParticles& liquid, const SolidParticles& solid) {
        liquid_ = &liquid;
        solid_ = &solid;
    }
    // Collective. What the solver calls before the first iteration.
    void set_up(solve::Matrix& matrix);

    const solve::Multilevel& multilevel() const { return multilevel_; } // as of the last set_up()
    std::size_t bytes() const;                                          // of this rank [bytes]

    // Part of the above; not private, since nvcc takes no kernel in a private function.
    template <class Particles>
    void locate_rows(const Particles& particles, int first_row);
    void find_walls(int first_row);
    void find_densities(int first_row);
    void find_fixed(int first_row);

private:
    void find_dirichlet_cells();

    CellGrid grid_; // of the finest level
    DomainBox domain_;
    ImmiscibleLiquids immiscible_;
    bool solids_unknown_;
    const LiquidParticles* liquid_ = nullptr;
    const SolidParticles* solid_ = nullptr;
    solve::Multilevel multilevel_;
    Array<int> cells_{"treacle::row_cell", 0};            // [rows * 3]
    Array<double> walls_{"treacle::row_wall", 0};         // [rows]
    Array<double> densities_{"treacle::row_density", 0};  // [rows] of the liquids over the first one's
    bool bounded_;                                        // Dirichlet particles have rows too
    Array<unsigned char> fixed_{"treacle::row_fixed", 0}; // [rows], 1: of a Dirichlet particle
    std::vector<int> dirichlet_;                          // [n][3]
};

// The one of the options; null for other preconditioners and other solvers.
std::unique_ptr<PressureHierarchy> make_hierarchy(const Comm& comm, const SphOptions& options,
    const Constants& constants, const DomainBox& domain, const CellGrid& grid);
solve::KrylovOptions krylov_options(const SphOptions& options, int dimensions, PressureHierarchy* hierarchy);

} // namespace treacle::sph
