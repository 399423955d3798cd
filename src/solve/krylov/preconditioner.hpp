#pragma once
// Inside src/solve only: PETSc's preconditioners behind z = M r.
#include "solve/krylov/krylov.hpp"
#include "solve/rows/petsc.hpp"

namespace treacle::solve {

// Preconditioner of one matrix: none, PETSc's, HYPRE's or the caller's. Kept until the values of the matrix change.
class BuiltPreconditioner {
public:
    // Collective. Does nothing when it is already that of the matrix with its present values.
    // False, and nothing left, on a breakdown on any rank. A system without rows needs nothing.
    bool set_up(Matrix& matrix, const std::string& prefix, const KrylovOptions& options);
    // std::logic_error before a set_up() that has succeeded.
    void apply(std::span<const double> r, std::span<double> z);
    void release();

    // False where one application costs several products, so that one more than needed would show.
    bool is_cheap() const { return cheap_; }
    bool is_identity() const { return identity_; }

private:
    void set_up_user(Matrix& matrix);
    void build(Matrix& matrix, const std::string& prefix, const KrylovOptions& options);
    void project(std::span<double> z) const;

    PcHandle pc_;
    UserPreconditioner user_;
    std::int64_t user_revision_ = 0; // of the matrix that the caller's preconditioner was last set up for
    Matrix::Native* native_ = nullptr;
    Comm comm_ = Comm::self();
    NullSpace null_space_ = NullSpace::none;
    Index global_rows_ = 0;
    bool ready_ = false; // set up for the matrix of the last call
    bool cheap_ = true;
    bool identity_ = false;
};

} // namespace treacle::solve
