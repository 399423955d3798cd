#pragma once
#include "solve/block_rows.hpp"
#include "solve/krylov.hpp"
#include "sph/viscous_operator.hpp"

#include <memory>
#include <vector>

namespace treacle::sph {

// The coarse space of the viscous system: each block of particles, two cells of the neighbour search wide, moves as a
// rigid body, by which a stiff liquid moves nearly. Its matrix is the Galerkin product of the pairwise form, which costs
// one pass over the pairs between blocks and serves the corrected form as well as its own would (README). A block's
// motion is t + w' x a, with the arm a from its centre in block widths: six unknowns, three in the plane.
class RigidBlocks {
public:
    // Declares the fields that are exchanged.
    RigidBlocks(const Comm& comm, LiquidParticles& liquid, const CellGrid& grid);
    ~RigidBlocks();

    // Collective: blocks of the present particles, the matrix and its own preconditioner, for the operator as it was
    // prepared.
    void set_up(const ViscousParts& parts, const ViscousOperator& of);

    // Collective: z += P M P^T r on the owned particles, M being one cycle of multigrid on the matrix, or, where
    // the viscosity reaches no farther than a block in a step, two symmetric sweeps.
    void correct(const LiquidParticles& liquid, const Array3& r, const Array3& z);

    std::size_t bytes() const;

private:
    struct Rows;
    void number(const ViscousParts& parts);
    void connect(const ViscousParts& parts);
    void assemble(const ViscousParts& parts, const ViscousOperator& of);
    void build();
    std::vector<std::vector<double>> rigid_motions() const;

    Comm comm_;
    CellGrid grid_;
    double width_;            // of a block [m]
    int unknowns_;            // of a block
    int block_field_;
    int arm_field_; // that of the accelerations, which have been added to the velocities by now
    int first_ = 0, count_ = 0; // of this rank's blocks
    std::vector<Vec3> centres_;
    std::unique_ptr<Rows> rows_;
    solve::KrylovSolver multigrid_, sweeps_;
    solve::KrylovSolver* solver_ = nullptr; // one of these
    solve::BlockMatrix matrix_;
    Array<double> coarse_{"treacle::rigid_blocks", 0}; // [count][unknowns]
    std::vector<double> residual_, correction_;
};

} // namespace treacle::sph
