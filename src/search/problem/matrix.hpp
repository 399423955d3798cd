#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace treacle::search {

// A small dense matrix, by rows. Sums run in the order of their indices and nothing is vectorised across them: results
// are the same bits on every processor, which a replayed search needs and Eigen does not guarantee.
class Matrix {
public:
    Matrix() = default;
    Matrix(std::size_t rows, std::size_t columns, double value = 0)
        : rows_(rows), columns_(columns), entries_(rows * columns, value) {}
    static Matrix identity(std::size_t n);

    double& operator()(std::size_t i, std::size_t j) { return entries_[i * columns_ + j]; }
    double operator()(std::size_t i, std::size_t j) const { return entries_[i * columns_ + j]; }
    std::size_t rows() const { return rows_; }       // 0 when default-constructed
    std::size_t columns() const { return columns_; } // length of each row
    // Entries of row i, [columns()], contiguous; valid until the matrix is assigned to.
    std::span<double> row(std::size_t i) { return {entries_.data() + i * columns_, columns_}; }
    std::span<const double> row(std::size_t i) const { return {entries_.data() + i * columns_, columns_}; }

private:
    std::size_t rows_ = 0, columns_ = 0;
    std::vector<double> entries_;
};

// Products and the Euclidean length, summed from the first index to the last.
double dot(std::span<const double> a, std::span<const double> b);
double norm(std::span<const double> a);
std::vector<double> multiply(const Matrix& a, std::span<const double> x);            // a x, [rows]
std::vector<double> multiply_transposed(const Matrix& a, std::span<const double> x); // a^T x, [columns]

// A symmetric matrix is V diag(values) V^T: values ascend, the columns of V are of length 1, and the largest entry of
// each (of equal ones the first) is positive, so that equal matrices have equal factors.
struct SymmetricEigen {
    std::vector<double> values; // [n] eigenvalues
    Matrix vectors;             // V [n][n], an eigenvector a column
};
// Cyclic Jacobi rotations (Golub & Van Loan, 8.5).
SymmetricEigen symmetric_eigen(Matrix a);

// Lower L with L L^T = a; none where a is not positive definite.
std::optional<Matrix> cholesky(const Matrix& a);
// Solution of L y = b, and of L^T x = y.
std::vector<double> solve_lower(const Matrix& l, std::span<const double> b);
std::vector<double> solve_lower_transposed(const Matrix& l, std::span<const double> y);

// The x of least |a x - b|, a [m][n] with m >= n, by Householder reflections (Golub & Van Loan, 5.3); entries of x
// whose column depends on those before it, to round-off, are 0.
std::vector<double> least_squares(Matrix a, std::vector<double> b);

} // namespace treacle::search
