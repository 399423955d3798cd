#pragma once
#include "solve/krylov/krylov.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace treacle::solve {

// A x = b for any square A that is given by its products; spans are this rank's rows.
struct Operator {
    std::function<void(std::span<const double> x, std::span<double> y)> multiply;     // y = A x, collective
    std::function<void(std::span<const double> r, std::span<double> z)> precondition; // z = M r, linear, collective
    std::span<const double> weights; // [rows] > 0: |r|^2 = sum weights r^2, in which unlike rows become alike
};

// Limits and size of the method.
struct IdrOptions {
    int max_iterations = 200;       // products
    int shadow_space_dimension = 4; // s: more of them take fewer iterations and 3 vectors each
};

// Induced dimension reduction IDR(s) with directions orthogonal to the shadows, preconditioned from the right (Sonneveld &
// van Gijzen 2008; van Gijzen & Sonneveld 2011), for systems that need not be definite or symmetric. In exact arithmetic it
// ends after rows (1 + 1/s) products; its recurrences are short, so that an iteration costs the same however many there
// are. Residuals may grow on the way. Work vectors are kept between solves.
class Idr {
public:
    Idr(const Comm& comm, IdrOptions options) : comm_(comm), options_(options) {}

    // Collective. From the guess in x to |b - A x| <= relative |b|. An unsuccessful solve is a report, with the last x.
    SolveReport solve(const Operator& a, std::span<const double> b, std::span<double> x, double relative);
    double norm(const Operator& a, std::span<const double> r) const; // collective
    // As given to the constructor; memory of the vectors kept on this rank [bytes].
    const IdrOptions& options() const { return options_; }
    std::size_t bytes() const;

private:
    struct Small;
    void draw_shadows(const Operator& a, std::uint64_t cycle);
    void begin_cycle();
    void run_cycle(const Operator& a, std::span<double> x, double residual, double target, SolveReport& report);
    void project_residual(Small& small) const;
    void find_direction(const Operator& a, Small& small, std::size_t k);
    double step_along(const Operator& a, Small& small, std::size_t k, std::span<double> x);
    double reduce(const Operator& a, Small& small, std::span<double> x, double residual);

    Comm comm_;
    IdrOptions options_;
    std::vector<std::vector<double>> shadows_, u_, g_; // [s][rows]: P, U and G = A U
    std::vector<double> r_, v_, z_, kept_;             // kept_: the best x so far, roughly
};

} // namespace treacle::solve
