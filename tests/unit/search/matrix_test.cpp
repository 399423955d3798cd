#include "search/problem/matrix.hpp"

#include "search/problem/random.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace treacle::search {
namespace {

Matrix random_matrix(std::size_t rows, std::size_t columns, std::uint64_t seed) {
    const Random random(seed);
    Matrix out(rows, columns);
    for (std::uint32_t i = 0; i < rows; ++i)
        for (std::uint32_t j = 0; j < columns; ++j) out(i, j) = random.normal(Purpose::candidate, 0, i, j);
    return out;
}

// a a^T + shift
Matrix symmetric(std::size_t n, std::uint64_t seed, double shift) {
    const Matrix a = random_matrix(n, n, seed);
    Matrix out(n, n);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) out(i, j) = dot(a.row(i), a.row(j)) + (i == j ? shift : 0);
    return out;
}

constexpr double round_off = 1e-13; // some hundred operations on numbers of order one to ten

TEST(Matrix, EigenvectorsTurnItDiagonal) {
    for (const std::size_t n : {1U, 2U, 5U, 12U}) {
        const Matrix a = symmetric(n, 3, 0);
        const auto [values, v] = symmetric_eigen(a);
        for (std::size_t j = 0; j < n; ++j) {
            std::vector<double> column;
            for (std::size_t i = 0; i < n; ++i) column.push_back(v(i, j));
            EXPECT_NEAR(norm(column), 1, round_off);
            const auto product = multiply(a, column);
            for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(product[i], values[j] * column[i], round_off * double(n));
            if (j > 0) {
                EXPECT_LE(values[j - 1], values[j]);
            }
            double largest = 0;
            for (const double c : column)
                if (std::abs(c) > std::abs(largest)) largest = c;
            EXPECT_GT(largest, 0);
        }
    }
}

TEST(Matrix, EigenvaluesOfWideRangeKeepTheirDigits) {
    // Rotated by 0.3 from diag(1e-8, 1e8).
    const double c = std::cos(0.3), s = std::sin(0.3);
    Matrix a(2, 2);
    a(0, 0) = c * c * 1e-8 + s * s * 1e8;
    a(1, 1) = s * s * 1e-8 + c * c * 1e8;
    a(0, 1) = a(1, 0) = c * s * (1e-8 - 1e8);
    const auto eigen = symmetric_eigen(a);
    EXPECT_NEAR(eigen.values[1], 1e8, 1e-7);
    EXPECT_NEAR(eigen.values[0], 1e-8, 4e-8); // the entries are rounded to 1e-8
}

TEST(Matrix, CholeskySolves) {
    const std::size_t n = 9;
    const Matrix a = symmetric(n, 4, 0.1);
    const auto l = cholesky(a);
    ASSERT_TRUE(l);
    std::vector<double> b(n, 1.0);
    b[3] = -2;
    const auto x = solve_lower_transposed(*l, solve_lower(*l, b));
    const auto back = multiply(a, x);
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(back[i], b[i], 1e3 * round_off); // condition about 1e3
    Matrix indefinite = a;
    indefinite(4, 4) = -1;
    EXPECT_FALSE(cholesky(indefinite));
}

TEST(Matrix, LeastSquaresLeaveARestAcrossTheColumns) {
    const Matrix a = random_matrix(12, 4, 5);
    std::vector<double> b(12);
    for (std::size_t i = 0; i < b.size(); ++i) b[i] = std::sin(double(i));
    const auto x = least_squares(a, b);
    auto rest = multiply(a, x);
    for (std::size_t i = 0; i < b.size(); ++i) rest[i] = b[i] - rest[i];
    for (const double along : multiply_transposed(a, rest)) EXPECT_NEAR(along, 0, round_off);
}

TEST(Matrix, LeastSquaresLeaveOutDependentColumns) {
    Matrix a = random_matrix(6, 3, 6);
    for (std::size_t i = 0; i < 6; ++i) a(i, 1) = 2 * a(i, 0);
    std::vector<double> b(6);
    for (std::size_t i = 0; i < 6; ++i) b[i] = a(i, 0) - a(i, 2);
    const auto x = least_squares(a, b);
    EXPECT_NEAR(x[0], 1, round_off);
    EXPECT_EQ(x[1], 0);
    EXPECT_NEAR(x[2], -1, round_off);
}

} // namespace
} // namespace treacle::search
