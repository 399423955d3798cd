#pragma once
#include "solve/krylov/krylov.hpp"
#include "sph/iisph/iisph.hpp"

#include <vector>

namespace treacle::sph {

// Pressure solve that has ended, and the step that it belongs to.
struct CorrectionParts {
    const StepContext& step;
    solve::Matrix& matrix;       // of the pressure solve
    solve::KrylovSolver& solver; // whose preconditioner serves
};

// (S7c) Pressures that leave the rest density by the very forces that move the liquid. The pressure system's Laplacian
// approximates what these do (S8), and S5 requires A q = b with the A of iisph.hpp, q = p / rho^2. From the system's
// solution, on its unknowns, with r = b - A q:
//     d = M r / rho^2, M the preconditioner, minus its parts along earlier d so that A d is orthogonal to theirs
//     a = r.Ad / Ad.Ad,  q += a d,  r -= a A d
// Orthomin (Vinsome 1976; Saad 2003, 6.9): |r| never grows, whether A is symmetric or not. Negative pressures are set to 0
// at the end. As M differs at the borders of the ranks, so do pressures that are not corrected until the end.
class OrthominCorrection {
public:
    // Collective: at most PressureOptions::corrections times, until the mean compression is below `density_error`. The
    // solve's pressures and roles must be there, and the velocities that b is of. Returns what adds to the solve's report:
    // iterations, products, seconds, and the mean compression that is left. Writes the fields pressure, source, load,
    // acceleration, place, motion.
    solve::SolveReport correct(const CorrectionParts& parts, Iisph& system, double dt);

    std::size_t bytes() const; // of this rank [bytes]

private:
    struct Direction {
        Array<double> step{"treacle::correction_step", 0};       // d
        Array<double> product{"treacle::correction_product", 0}; // A d, on the unknowns
        double square = 0;                                       // A d.A d
    };
    void start(const CorrectionParts& parts, Iisph& system, double dt);
    void precondition(const CorrectionParts& parts, const Array<double>& out);
    void orthogonalise(const Comm& comm, std::size_t number, int count);
    void advance(const Comm& comm, const Direction& along, int count);

    std::vector<Direction> directions_;
    Array<double> q_{"treacle::correction_q", 0};
    Array<double> residual_{"treacle::correction_residual", 0};
    Array<double> rows_{"treacle::correction_rows", 0}; // r, then M r, by rows of the matrix
    std::vector<double> preconditioned_;
};

} // namespace treacle::sph
