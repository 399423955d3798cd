#pragma once
#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <complex>
#include <functional>

// Steady Stokes flow in the unit square between free-slip walls, driven by a force along y, sin(k y) times a function of x, or
// cos(k x) times a function of y, with a viscosity of one coordinate: the problems known as SolCx and SolKz (Zhong 1996; Revenaugh &
// Parsons 1987), solved here in one coordinate by collocation at Chebyshev points, to 1e-9.
namespace treacle::grid {

// Values, by polynomials in Chebyshev points of [from, to], of a function and its derivatives.
class Chebyshev {
public:
    Chebyshev(int points, double from, double to) : points_(points), from_(from), to_(to) {}
    double point(int i) const { return from_ + 0.5 * (to_ - from_) * (1 - std::cos(M_PI * i / (points_ - 1))); }
    // The derivative of that order of the polynomials T_0 … at x.
    Eigen::RowVectorXd row(int order, double x) const {
        const double s = 2 * (x - from_) / (to_ - from_) - 1, scale = 2 / (to_ - from_);
        Eigen::MatrixXd t = Eigen::MatrixXd::Zero(5, points_);
        for (int n = 0; n < points_; ++n) {
            for (int d = 0; d <= order; ++d) {
                if (n == 0)
                    t(d, n) = d == 0 ? 1 : 0;
                else if (n == 1)
                    t(d, n) = d == 0 ? s : d == 1 ? 1 : 0;
                else
                    t(d, n) = 2 * s * t(d, n - 1) + (d > 0 ? 2 * d * t(d - 1, n - 1) : 0) - t(d, n - 2); // (2 s T)^(d)
            }
        }
        return t.row(order) * std::pow(scale, order);
    }
    int points() const { return points_; }

private:
    int points_;
    double from_, to_;
};

struct StokesField {
    std::function<double(double, double)> u, v, p; // [m/s], [Pa] but for a constant
};

// SolCx: eta = left for x < 1/2, right beyond; force sin(pi y) cos(pi x) along y. With U = f(x) cos(ky), V = -f'(x)/k sin(ky):
// eta (f'''' - 2 k^2 f'' + k^4 f) = k g', g = cos(pi x), in each half; f, f' and both stresses go on across the middle.
inline StokesField jump_of_viscosity(double left, double right) {
    const double k = M_PI;
    const int n = 24;
    const Chebyshev half[2] = {{n, 0, 0.5}, {n, 0.5, 1}};
    const double eta[2] = {left, right};
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(2 * n);
    int row = 0;
    const auto d = [&](int side, int order, double x) {
        Eigen::RowVectorXd out = Eigen::RowVectorXd::Zero(2 * n);
        out.segment(side * n, n) = half[side].row(order, x);
        return out;
    };
    // P = p / cos(ky), from the momentum along y: k P = eta (f'''/k - k f') - g.
    const auto pressure = [&](int side, double x) -> Eigen::RowVectorXd {
        return eta[side] * (d(side, 3, x) / k - k * d(side, 1, x)) / k;
    };
    for (int side = 0; side < 2; ++side) {
        for (int i = 2; i < n - 2; ++i, ++row) {
            const double x = half[side].point(i);
            a.row(row) = eta[side] * (d(side, 4, x) - 2 * k * k * d(side, 2, x) + std::pow(k, 4) * d(side, 0, x));
            b(row) = -k * M_PI * std::sin(M_PI * x);
        }
        const double wall = side;
        a.row(row++) = d(side, 0, wall);
        a.row(row++) = d(side, 2, wall); // no shear stress: V' = 0
    }
    const double m = 0.5;
    a.row(row++) = d(0, 0, m) - d(1, 0, m);
    a.row(row++) = d(0, 1, m) - d(1, 1, m);
    a.row(row++) = (eta[0] * (d(0, 2, m) + k * k * d(0, 0, m)) - eta[1] * (d(1, 2, m) + k * k * d(1, 0, m))) / eta[0];
    a.row(row++) = (pressure(0, m) - 2 * eta[0] * d(0, 1, m) - pressure(1, m) + 2 * eta[1] * d(1, 1, m)) / eta[0];
    const Eigen::VectorXd f = a.colPivHouseholderQr().solve(b);
    const auto value = [=](int order, double x) {
        const int side = x < 0.5 ? 0 : 1;
        return half[side].row(order, x).dot(f.segment(side * n, n));
    };
    return {[=](double x, double y) { return value(0, x) * std::cos(k * y); },
        [=](double x, double y) { return -value(1, x) / k * std::sin(k * y); },
        [=](double x, double y) {
            const double e = eta[x < 0.5 ? 0 : 1];
            return (e * (value(3, x) / k - k * value(1, x)) - std::cos(M_PI * x)) / k * std::cos(k * y);
        }};
}

// SolKz: eta = contrast^y, force sin(m pi y) cos(k x) along y. With V = f(y) cos(kx), U = -f'(y)/k sin(kx).
inline StokesField exponential_viscosity(double contrast, double m, double wave) {
    const double k = wave * M_PI, b2 = std::log(contrast);
    const int n = 40;
    const Chebyshev all(n, 0, 1);
    // Shear stress: -eta (f''/k + k f) sin(kx). Momentum along x:
    const auto eta = [=](double y) { return std::exp(b2 * y); };
    Eigen::MatrixXd a(n, n);
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(n);
    // k P = (eta (f''/k + k f))' - 2 k eta f'.
    const auto pressure = [=](double y, int order) -> Eigen::RowVectorXd { // P/eta, or P'/eta
        Eigen::RowVectorXd q = (all.row(3 + order, y) / k - k * all.row(1 + order, y) +
                                   b2 * (all.row(2 + order, y) / k + k * all.row(order, y))) /
                               k;
        return q;
    };
    int row = 0;
    for (int i = 2; i < n - 2; ++i, ++row) {
        const double y = all.point(i), e = eta(y);
        // 0 = -P' + 2 (eta f')' - k eta (f''/k + k f) + sin(m pi y), over cos(kx).
        a.row(row) = -(pressure(y, 1) + b2 * pressure(y, 0)) + 2 * (all.row(2, y) + b2 * all.row(1, y)) -
                     (all.row(2, y) + k * k * all.row(0, y));
        rhs(row) = -std::sin(m * M_PI * y) / e;
    }
    for (const double wall : {0.0, 1.0}) {
        a.row(row++) = all.row(0, wall);
        a.row(row++) = all.row(2, wall);
    }
    const Eigen::VectorXd f = a.colPivHouseholderQr().solve(rhs);
    return {[=](double x, double y) { return -all.row(1, y).dot(f) / k * std::sin(k * x); },
        [=](double x, double y) { return all.row(0, y).dot(f) * std::cos(k * x); },
        [=](double x, double y) { return eta(y) * pressure(y, 0).dot(f) * std::cos(k * x); }};
}

} // namespace treacle::grid
