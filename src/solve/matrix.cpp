#include "solve/matrix.hpp"

#include "solve/petsc.hpp"

#include <cassert>
#include <stdexcept>
#include <string>

namespace treacle::solve {

namespace {

[[noreturn]] void refuse(const CsrBlocks& blocks, Index row, const std::string& what) {
    throw std::logic_error("matrix row " + std::to_string(blocks.first_row + row) + ": " + what);
}

void check_row(const CsrBlocks& blocks, Index row) {
    bool has_diagonal = false;
    Index last = -1;
    for (Index k = blocks.diagonal_offsets[row]; k < blocks.diagonal_offsets[row + 1]; ++k) {
        const Index column = blocks.diagonal_columns[k];
        if (column <= last) refuse(blocks, row, "columns of the diagonal part do not rise");
        if (column >= blocks.rows) refuse(blocks, row, "a column of the diagonal part is not local");
        has_diagonal = has_diagonal || column == row;
        last = column;
    }
    if (!has_diagonal) refuse(blocks, row, "the diagonal entry is missing");
    last = -1;
    for (Index k = blocks.off_offsets[row]; k < blocks.off_offsets[row + 1]; ++k) {
        const Index column = blocks.off_columns[k];
        if (column <= last) refuse(blocks, row, "columns of the off-diagonal part do not rise");
        if (column >= blocks.global_rows) refuse(blocks, row, "a column is beyond the matrix");
        if (column >= blocks.first_row && column < blocks.first_row + blocks.rows) {
            refuse(blocks, row, "a local column in the off-diagonal part");
        }
        last = column;
    }
}

std::int64_t next_revision() {
    static std::int64_t last = 0;
    return ++last;
}

// A rank without rows may come without arrays; PETSc reads the first offset all the same.
CsrBlocks with_offsets(CsrBlocks blocks) {
    static Index zero[2] = {0, 0};
    if (blocks.rows == 0) {
        blocks.diagonal_offsets = zero;
        blocks.off_offsets = zero;
    }
    return blocks;
}

} // namespace

void check_pattern(const CsrBlocks& given) {
    const CsrBlocks blocks = with_offsets(given);
    if (blocks.first_row < 0 || blocks.rows < 0 || blocks.first_row + blocks.rows > blocks.global_rows) {
        refuse(blocks, 0, "this rank's rows are not within the matrix");
    }
    if (blocks.diagonal_offsets[0] != 0 || blocks.off_offsets[0] != 0)
        refuse(blocks, 0, "offsets start at 0");
    for (Index row = 0; row < blocks.rows; ++row) {
        if (blocks.diagonal_offsets[row + 1] < blocks.diagonal_offsets[row] ||
            blocks.off_offsets[row + 1] < blocks.off_offsets[row]) {
            refuse(blocks, row, "offsets fall");
        }
        check_row(blocks, row);
    }
}

Matrix::Matrix(const Comm& comm, const CsrBlocks& given)
    : comm_(comm), blocks_(with_offsets(given)), first_row_(given.first_row), rows_(given.rows),
      global_rows_(given.global_rows), revision_(next_revision()), native_(std::make_unique<Native>()) {
#ifndef NDEBUG
    comm.guard([&] { check_pattern(given); });
#endif
    const CsrBlocks& blocks = blocks_;
    entries_ = std::int64_t{blocks.diagonal_offsets[rows_]} + blocks.off_offsets[rows_];
    const MPI_Comm group = treacle::native(comm);
    if (comm.size() == 1) {
        check(MatCreateSeqAIJWithArrays(group, rows_, rows_, blocks.diagonal_offsets, blocks.diagonal_columns,
                                        blocks.diagonal_values, native_->mat.out()));
    } else {
        check(MatCreateMPIAIJWithSplitArrays(group, rows_, rows_, global_rows_, global_rows_,
                                             blocks.diagonal_offsets, blocks.diagonal_columns,
                                             blocks.diagonal_values, blocks.off_offsets, blocks.off_columns,
                                             blocks.off_values, native_->mat.out()));
    }
    check(MatSetOption(native_->mat, MAT_SYMMETRIC, PETSC_TRUE));
    check(MatSetOption(native_->mat, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
    check(VecCreateMPIWithArray(group, 1, rows_, global_rows_, nullptr, native_->in.out()));
    check(VecCreateMPIWithArray(group, 1, rows_, global_rows_, nullptr, native_->out.out()));
}

Matrix::~Matrix() = default;
Matrix::Matrix(Matrix&&) noexcept = default;
Matrix& Matrix::operator=(Matrix&&) noexcept = default;

void Matrix::multiply(std::span<const double> x, std::span<double> y) const {
    assert(x.size() == static_cast<std::size_t>(rows_) && y.size() == x.size());
    native_->on(x, y, [this](Vec in, Vec out) { return MatMult(native_->mat, in, out); });
    if (addition_) addition_(x, y);
}

std::span<const Index> Matrix::halo_columns() const {
    if (comm_.size() == 1) return {};
    Mat off = nullptr;
    const PetscInt* columns = nullptr;
    check(MatMPIAIJGetSeqAIJ(native_->mat, nullptr, &off, &columns));
    PetscInt count = 0;
    check(MatGetSize(off, nullptr, &count));
    return {columns, static_cast<std::size_t>(count)};
}

void Matrix::values_changed() {
    check(MatAssemblyBegin(native_->mat, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(native_->mat, MAT_FINAL_ASSEMBLY));
    revision_ = next_revision();
}

} // namespace treacle::solve
