#pragma once
#include "mpi/halo.hpp"
#include "sph/model/neighbourhood.hpp"

namespace treacle::sph {

// Makes the pressure system positive definite in every configuration. Poisson particles that are neighbours
// form connected components, across ranks; a component without an anchor - Dirichlet neighbours or a wall term of
// some weight - is singular or nearly so, such as a compressed blob in free flight. Its particle of least source
// becomes Dirichlet. One union-find pass over the edges; what crosses ranks is touched only when some rank has
// components without a datum of their own.
class PressurePinning {
public:
    // Collective. Ghost roles and volumes must be current; changes roles of owned and ghost particles. Returns the number
    // of this rank's particles that became Dirichlet.
    std::int64_t anchor(const SphOptions& options, const Constants& constants, const Comm& comm,
        LiquidParticles& liquid, const Neighbourhood& neighbours, Halo& halo);

    // Parts of the above; not private, since nvcc takes no kernel in a private function.
    std::int64_t label(const SphOptions& options, const Constants& constants, const LiquidParticles& liquid,
        const Neighbourhood& neighbours);
    void merge_across_ranks(const Comm& comm, LiquidParticles& liquid, const Neighbourhood& neighbours, Halo& halo);

private:
    std::int64_t choose_anchors(const Comm& comm, LiquidParticles& liquid);
    Array<int> root_{"treacle::root", 0};           // per Poisson particle: least index of its component; else -1
    Array<int> has_datum_{"treacle::has_datum", 0}; // per root: 0 or 1
    Array<int> label_{"treacle::label", 0};         // per root: -1 with a datum, else global number of the component
};

} // namespace treacle::sph
