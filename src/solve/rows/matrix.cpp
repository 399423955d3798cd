#include "solve/rows/matrix.hpp"

#include "base/text/contract.hpp"
#include "solve/rows/petsc.hpp"
#include "solve/rows/sparse_dot.hpp"

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
        if (!blocks.halo || column >= static_cast<Index>(blocks.halo->columns().size())) {
            refuse(blocks, row, "a column of the off-diagonal part is not in the halo");
        }
        last = column;
    }
}

std::int64_t next_revision() {
    static std::int64_t last = 0;
    return ++last;
}

void check_halo(const CsrBlocks& blocks) {
    Index last = -1;
    for (const Index column : blocks.halo->columns()) {
        if (column <= last) refuse(blocks, 0, "columns of the halo do not rise");
        if (column >= blocks.global_rows) refuse(blocks, 0, "a column of the halo is beyond the matrix");
        if (column >= blocks.first_row && column < blocks.first_row + blocks.rows) {
            refuse(blocks, 0, "a local column in the halo");
        }
        last = column;
    }
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
    if (blocks.halo) check_halo(blocks);
    if (blocks.diagonal_offsets[0] != 0 || blocks.off_offsets[0] != 0) refuse(blocks, 0, "offsets start at 0");
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
      global_rows_(given.global_rows), revision_(next_revision()) {
#ifndef NDEBUG
    comm.guard([&] { check_pattern(given); });
#endif
    entries_ = std::int64_t{blocks_.diagonal_offsets[rows_]} + blocks_.off_offsets[rows_];
}

namespace {
void set_near_kernel(Mat mat, MPI_Comm group, const std::vector<std::vector<double>>& vectors) {
    std::vector<VecHandle> handles(vectors.size());
    std::vector<Vec> plain;
    for (std::size_t k = 0; k < vectors.size(); ++k) {
        check(MatCreateVecs(mat, handles[k].out(), nullptr));
        double* values = nullptr;
        check(VecGetArray(handles[k], &values));
        std::copy(vectors[k].begin(), vectors[k].end(), values);
        check(VecRestoreArray(handles[k], &values));
        plain.push_back(handles[k]);
    }
    NullSpaceHandle space;
    check(MatNullSpaceCreate(group, PETSC_FALSE, static_cast<Index>(plain.size()), plain.data(), space.out()));
    check(MatSetNearNullSpace(mat, space));
}
} // namespace

Matrix::Native& Matrix::native() {
    if (native_) return *native_;
    native_ = std::make_unique<Native>();
    const MPI_Comm group = treacle::native(comm_);
    const CsrBlocks& blocks = blocks_;
    if (comm_.size() == 1) {
        check(MatCreateSeqAIJWithArrays(group, rows_, rows_, blocks.diagonal_offsets, blocks.diagonal_columns,
            blocks.diagonal_values, native_->mat.out()));
    } else {
        auto& columns = native_->off_columns; // PETSc takes global numbers, and overwrites them
        columns.resize(static_cast<std::size_t>(blocks.off_offsets[rows_]) + 1);
        for (Index k = 0; k < blocks.off_offsets[rows_]; ++k) {
            columns[static_cast<std::size_t>(k)] =
                blocks.halo->columns()[static_cast<std::size_t>(blocks.off_columns[k])];
        }
        check(MatCreateMPIAIJWithSplitArrays(group, rows_, rows_, global_rows_, global_rows_, blocks.diagonal_offsets,
            blocks.diagonal_columns, blocks.diagonal_values, blocks.off_offsets, columns.data(), blocks.off_values,
            native_->mat.out()));
    }
    if (symmetric_) {
        check(MatSetOption(native_->mat, MAT_SYMMETRIC, PETSC_TRUE));
        check(MatSetOption(native_->mat, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
    }
    if (block_size_ > 1) check(MatSetBlockSize(native_->mat, block_size_));
    if (!near_null_space_.empty()) set_near_kernel(native_->mat, group, near_null_space_);
    check(VecCreateMPIWithArray(group, 1, rows_, global_rows_, nullptr, native_->in.out()));
    check(VecCreateMPIWithArray(group, 1, rows_, global_rows_, nullptr, native_->out.out()));
    return *native_;
}

Matrix::~Matrix() = default;
Matrix::Matrix(Matrix&&) noexcept = default;
Matrix& Matrix::operator=(Matrix&&) noexcept = default;

void Matrix::multiply(std::span<const double> x, std::span<double> y) const {
    TREACLE_EXPECT(x.size() == static_cast<std::size_t>(rows_) && y.size() == x.size());
    const CsrBlocks& a = blocks_;
    if (a.halo) a.halo->start(x);
    const RowProduct own{a.diagonal_offsets, a.diagonal_columns, a.diagonal_values, x.data()};
    double* const out = y.data();
    Kokkos::parallel_for(
        "treacle::row_products", rows_, KOKKOS_LAMBDA(int i) { out[i] = own(i); });
    if (a.halo) {
        const RowProduct other{a.off_offsets, a.off_columns, a.off_values, a.halo->finish().data()};
        Kokkos::parallel_for(
            "treacle::halo_products", rows_, KOKKOS_LAMBDA(int i) {
                if (!other.is_empty(i)) out[i] += other(i);
            });
    }
    if (addition_) addition_(x, y);
}

void Matrix::values_changed() {
    if (native_) {
        check(MatAssemblyBegin(native_->mat, MAT_FINAL_ASSEMBLY));
        check(MatAssemblyEnd(native_->mat, MAT_FINAL_ASSEMBLY));
    }
    revision_ = next_revision();
}

} // namespace treacle::solve
