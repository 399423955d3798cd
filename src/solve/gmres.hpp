#pragma once
#include "solve/krylov.hpp"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace treacle::solve {

// A x = b for any square A that is given by its products; spans are this rank's rows.
struct Operator {
    std::function<void(std::span<const double> x, std::span<double> y)> multiply;     // y = A x, collective
    std::function<void(std::span<const double> r, std::span<double> z)> precondition; // z = M r, linear, collective
    std::span<const double> weights; // [rows] > 0: |r|^2 = sum weights r^2, in which unlike rows become alike
};

struct GmresOptions {
    int max_iterations = 200;
    int restart = 40; // vectors that are kept
};

// Generalised minimal residuals, preconditioned from the right and restarted (Saad & Schultz 1986; Saad 2003, algorithm
// 9.5), for systems that are not definite: of all x in the space of the iterations that with the least weighted residual,
// which therefore never grows. Work vectors are kept between solves.
class Gmres {
public:
    Gmres(const Comm& comm, GmresOptions options) : comm_(comm), options_(options) {}

    // Collective. From the guess in x to |b - A x| <= relative |b|. An unsuccessful solve is a report, with the best x.
    SolveReport solve(const Operator& a, std::span<const double> b, std::span<double> x, double relative);
    double norm(const Operator& a, std::span<const double> r) const; // collective

    const GmresOptions& options() const { return options_; }
    std::size_t bytes() const;

private:
    double orthogonalise(const Operator& a, std::size_t count, std::span<double> w, std::span<double> h);
    void subtract(std::span<double> w, std::size_t count) const;
    std::span<double> basis(std::size_t k, std::size_t rows);

    Comm comm_;
    GmresOptions options_;
    std::vector<std::vector<double>> basis_;
    std::vector<double> z_, products_;
};

} // namespace treacle::solve
