#pragma once
#include "solve/krylov/krylov.hpp"
#include "solve/rows/block_rows.hpp"
#include "sph/viscosity/operator/viscous_operator.hpp"

#include <functional>

namespace treacle::sph {

// The matrix of a ViscousOperator, whose rows reach to the neighbours' neighbours (dissertation,
// equations 4.10 to 4.12, Algorithm 8), and its solver. Each rank extracts what the stresses of its own
// particles put into all rows and sends other ranks' rows to them: ghosts of one support are enough (src/sph/theory.md).
class ViscousMatrix {
public:
    // Declares the fields that are exchanged.
    ViscousMatrix(const Comm& comm, LiquidParticles& liquid, const ViscosityOptions& options);

    // Collective: the matrix of an operator that is prepared.
    void assemble(const ViscousContext& parts, const ViscousOperator& of);

    // z = M r of the operator's own preconditioners, for those that take no matrix.
    using Preconditioner = std::function<void(const Array3& r, const Array3& z)>;
    // Collective: change = C^-1 r on the owned particles, to a residual of `largest`; r and change are scratch of
    // `own`.
    solve::SolveReport solve(const LiquidParticles& liquid, const Array3& r, double largest, const Preconditioner& own,
        const Array3& change);

    const solve::Matrix* matrix() { return matrix_.matrix(); } // of the last assemble(); null before
    std::size_t bytes() const {                                // of this rank [bytes]
        return matrix_.bytes() + 8 * (right_hand_side_.capacity() + solution_.capacity());
    }

private:
    struct Assembly;

    Comm comm_;
    int row_field_;
    solve::KrylovOptions options_;
    solve::BlockMatrix matrix_;
    std::vector<double> right_hand_side_, solution_;
};

} // namespace treacle::sph
