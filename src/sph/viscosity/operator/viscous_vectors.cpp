#include "sph/viscosity/operator/viscous_vectors.hpp"

#include "kokkos/simd.hpp"

namespace treacle::sph {

// Loops that store as well add to the sum once a particle: the compiler assumes that the stores change it, and goes to
// memory for every addition.
double sum_squares(const Array3& a, int n, const RelativeDensity& weight) {
    double sum = 0;
    Kokkos::parallel_reduce(
        "treacle::viscous_norm", n,
        KOKKOS_LAMBDA(int i, double& out) {
            const double w = weight(i);
            double square = 0;
            for (int k = 0; k < 3; ++k) square += a(i, k) * a(i, k);
            out += w * w * square;
        },
        sum);
    return n > 0 ? sum : 0;
}

double subtract(const Array3& u, const RelativeDensity& inertia, const Array3& product, int n, const Array3& r) {
    double sum = 0;
    Kokkos::parallel_reduce(
        "treacle::viscous_residual", n,
        KOKKOS_LAMBDA(int i, double& out) {
            const double m = inertia(i);
            double square = 0;
            for (int k = 0; k < 3; ++k) {
                const double left = m * u(i, k) - product(i, k);
                r(i, k) = left;
                square += left * left;
            }
            out += square;
        },
        sum);
    return n > 0 ? sum : 0;
}

double dot(const Array3& a, const Array3& b, int n) {
    double sum = 0;
    Kokkos::parallel_reduce(
        "treacle::viscous_dot", n,
        KOKKOS_LAMBDA(int i, double& out) {
            double product = 0;
            for (int k = 0; k < 3; ++k) product += a(i, k) * b(i, k);
            out += product;
        },
        sum);
    return n > 0 ? sum : 0;
}

double step(double alpha, const Array3& p, const Array3& q, int n, const Array3& u, const Array3& r) {
    double sum = 0;
    Kokkos::parallel_reduce(
        "treacle::viscous_step", n,
        KOKKOS_LAMBDA(int i, double& out) {
            double square = 0;
            for (int k = 0; k < 3; ++k) {
                u(i, k) += alpha * p(i, k);
                const double left = r(i, k) - alpha * q(i, k);
                r(i, k) = left;
                square += left * left;
            }
            out += square;
        },
        sum);
    return n > 0 ? sum : 0;
}

void turn(double beta, const Array3& z, int n, bool nearly, const Array3& p) {
    Kokkos::parallel_for(
        "treacle::viscous_turn", n, KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) {
                const double turned = z(i, k) + (beta != 0 ? beta * p(i, k) : 0);
                p(i, k) = nearly ? rounded(turned) : turned;
            }
        });
}

void add(double c, const Array3& b, int n, const Array3& a) {
    Kokkos::parallel_for(
        "treacle::viscous_sum", n, KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) a(i, k) += c * b(i, k);
        });
}

void copy(const Array3& from, int n, const Array3& to) {
    Kokkos::parallel_for(
        "treacle::viscous_copy", n, KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) to(i, k) = from(i, k);
        });
}

void step_freely(const RelativeDensity& inertia, const Array3& product, int n, const Array3& u) {
    Kokkos::parallel_for(
        "treacle::viscous_explicit", n, KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) u(i, k) += u(i, k) - product(i, k) / inertia(i);
        });
}

void constrain_rows(
    const LiquidParticles& liquid, const RelativeDensity& inertia, const Array3& u, const Array3& product) {
    if (!liquid.has_inlets()) return;
    const auto inlet = liquid.inlet();
    Kokkos::parallel_for(
        "treacle::viscous_constrained", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            if (inlet(i) == 0) return;
            for (int k = 0; k < 3; ++k) product(i, k) = inertia(i) * u(i, k);
        });
}

void round_free(const LiquidParticles& liquid) {
    const auto u = liquid.velocity();
    const bool constrains = liquid.has_inlets();
    const auto inlet = constrains ? liquid.inlet() : Array<int>();
    Kokkos::parallel_for(
        "treacle::viscous_rounding", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            if (constrains && inlet(i) > 0) return;
            for (int k = 0; k < 3; ++k) u(i, k) = rounded(u(i, k));
        });
}

} // namespace treacle::sph
