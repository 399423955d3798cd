#pragma once
#include "sph/viscosity/operator/viscous_operator.hpp"

#include <memory>

namespace treacle::sph {

// Preconditioner of the viscous system: the inverses of the particles' diagonal blocks, and added to them a cycle of multigrid
// over cells 1.7 spacings wide, whose corners' velocities the particles take between them. What a cell resists with is that of
// a liquid of its particles' shares dt/m V mu: each level is made of sums over its cells, coarser ones of two cells an axis,
// without a matrix (src/sph/theory.md, Implicit viscosity). Symmetric and positive definite, the same on any number of ranks but
// for round-off of single precision.
class ViscousMultilevel {
public:
    explicit ViscousMultilevel(const CellGrid& grid);
    ~ViscousMultilevel();

    // Collective: cells of the present particles, for the operator as it was prepared.
    void set_up(const ViscousContext& parts, const ViscousOperator& of);

    // Collective: z = M r on the owned particles; returns this rank's r.z.
    double apply(const ViscousOperator& of, const Array3& r, const Array3& z);

    std::size_t bytes() const; // of this rank [bytes]

    struct Levels; // of either dimension

private:
    CellGrid grid_;
    std::unique_ptr<Levels> levels_;
};

} // namespace treacle::sph
