#pragma once
// Inside src/solve only: what its files share about PETSc.
#include "mpi/native.hpp"
#include "solve/rows/matrix.hpp"

#include <petscksp.h>
#include <vector>

namespace treacle::solve {

static_assert(sizeof(PetscInt) == sizeof(Index), "matrix.hpp's Index must be PETSc's integer");
static_assert(sizeof(PetscScalar) == sizeof(double), "PETSc must be built with real double numbers");

// Throws what PETSc reported last when code is not zero.
void check(PetscErrorCode code);

// Destroys PETSc's objects when a function or an object of ours ends.
template <class T, PetscErrorCode (*Destroy)(T*)>
class Handle {
public:
    Handle() = default;
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() { reset(); }
    void reset() {
        if (value_) (void)Destroy(&value_);
        value_ = nullptr;
    }
    operator T() const { return value_; }
    // For PETSc's constructors.
    T* out() {
        reset();
        return &value_;
    }

private:
    T value_ = nullptr;
};
// Owners of PETSc's objects; null until out() has been filled.
using MatHandle = Handle<Mat, MatDestroy>;
using VecHandle = Handle<Vec, VecDestroy>;
using NullSpaceHandle = Handle<MatNullSpace, MatNullSpaceDestroy>;
using PcHandle = Handle<PC, PCDestroy>;
using OptionsHandle = Handle<PetscOptions, PetscOptionsDestroy>;

// PETSc's view of the matrix, made on demand by Matrix::native().
struct Matrix::Native {
    std::vector<Index> off_columns; // global numbers, until PETSc has taken them
    MatHandle mat;                  // MPIAIJ around the caller's values, or SeqAIJ on one rank
    // Two vectors without memory of their own: each operation lends them the caller's arrays.
    VecHandle in;
    VecHandle out;

    // Runs operation(in, out) on the caller's arrays.
    template <class Operation>
    void on(std::span<const double> x, std::span<double> y, const Operation& operation) {
        check(VecPlaceArray(in, const_cast<double*>(x.data())));
        check(VecPlaceArray(out, y.data()));
        const PetscErrorCode code = operation(static_cast<Vec>(in), static_cast<Vec>(out));
        check(VecResetArray(in));
        check(VecResetArray(out));
        check(code);
    }
};

} // namespace treacle::solve
