#pragma once
#include "solve/krylov/complementarity.hpp"
#include "sph/pressure/components.hpp"
#include "sph/pressure/prediction.hpp"
#include "sph/pressure/pressure_hierarchy.hpp"
#include "sph/pressure/pressure_system.hpp"

namespace treacle::sph {

// Data of the solve of a step.
struct ComplementarityContext {
    const SphOptions& options;
    const Constants& constants;
    const Comm& comm;
    LiquidParticles& liquid;
    const Neighbourhood& neighbours;
    Halo& halo;
    PressurePinning& pinning;
};

// Pressures by 0 <= p, A p - b >= 0, one of the two zero: which particles keep zero pressure is part of the solution
// (src/sph/theory.md). The roles of (S6) are the first set. Where the particles with pressure have a component that nothing
// anchors, there is no solution, or one far too large: its particle of least source is held at zero, as PressurePinning
// chooses it.
class Complementarity {
public:
    Complementarity(const Comm& comm, const solve::KrylovOptions& options);

    // Collective: makes Dirichlet what must be held, and keeps it. Roles in: those of (S6), owned and ghosts.
    // Returns the number of this rank's particles that are held.
    std::int64_t anchor(const ComplementarityContext& parts);

    // Collective: solves in the arrays of `host`. The matrix is that of all particles with liquid neighbours. Writes the
    // roles: Poisson where the pressure is positive. `pinned`: particles of this rank that are held, in and out.
    solve::SolveReport solve(const ComplementarityContext& parts, solve::Matrix& matrix,
        const PressureSystem::HostSystem& host, const solve::ConvergenceTest& test, std::int64_t& pinned);

    // Particles of this rank that the last solve gave another role than (S6), and the number of changes of its set.
    std::int64_t misclassified() const { return misclassified_; }
    int set_changes() const { return set_changes_; }

private:
    void write_roles(const ComplementarityContext& parts, const PressureSystem::HostSystem& host, int first_row);
    std::vector<solve::RowState> states(const LiquidParticles& liquid, const solve::Matrix& matrix) const;

    solve::ComplementaritySolver solver_;
    std::vector<char> pinned_; // [owned]
    std::int64_t misclassified_ = 0;
    int set_changes_ = 0;
};

} // namespace treacle::sph
