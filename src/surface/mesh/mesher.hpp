#pragma once
#include "mpi/halo.hpp"
#include "mpi/migration.hpp"
#include "surface/field/solids.hpp"
#include "surface/mesh/attributes.hpp"
#include "surface/mesh/mesh.hpp"
#include "surface/mesh/smoothing.hpp"

#include <memory>
#include <span>

namespace treacle::surface {

// Particles of this rank, in any order and of any place: the rank need not own the space that they are in.
struct ParticleRows {
    std::span<const double> position;                  // [n][3] [m]
    std::span<const std::int64_t> id;                  // [n] no two alike over all ranks
    std::span<const double> velocity;                  // [n][3] [m/s], or none
    std::span<const double> pressure;                  // [n] [Pa], or none
    std::span<const std::int64_t> liquid;              // [n], or none
    std::vector<std::span<const double>> scalars = {}; // [Options::scalars][n]
};

// Makes the surface of a liquid from its particles: implicit function, marching cubes, smoothing. Each rank meshes its own
// cells; the mesh does not depend on the number of ranks. One object serves all frames and keeps its memory.
class Mesher {
public:
    // Throws InputError for options out of range.
    Mesher(const Comm& comm, const Domain& domain, const Options& options);
    ~Mesher();

    // Collective. The mesh stays until the next call. Throws InputError when positions are not finite.
    const Mesh& build(const ParticleRows& particles, const Solids& solids = {});
    const Summary& summary() const { return summary_; }

private:
    void take(const ParticleRows& particles);
    bool near_domain(const double* position) const;
    void cut_domain();
    void distribute();

    Comm comm_;
    Domain domain_;
    Options options_;
    Lattice base_, lattice_;
    ParticleStore store_;
    Sources sources_;
    CellList cells_;
    CellSort sort_;
    Migration migration_;
    Halo halo_;
    std::unique_ptr<Decomposition> decomposition_;
    PointBuilder points_;
    ImplicitFunction function_;
    Triangulation triangulation_;
    Smoothing smoothing_;
    Attributes attributes_;
    Mesh mesh_;
    Summary summary_;
};

} // namespace treacle::surface
