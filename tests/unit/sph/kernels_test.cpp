#include "sph/model/kernels.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace treacle::sph::kernels_test {
namespace {

constexpr double h = 0.37; // [m]
const KernelKind kinds[] = {KernelKind::cubic_spline, KernelKind::wendland_c2, KernelKind::mueller};

// Simpson's rule over both pieces of the cubic spline, exact for cubics: polynomials of degree 8 with 400
// intervals are off by 1e-10.
template <class F>
double integrate(const F& f) {
    double sum = 0;
    for (const double start : {0.0, 0.5}) {
        const int n = 400;
        const double step = 0.5 * h / n;
        for (int k = 0; k <= n; ++k) {
            const double r = start * h + k * step;
            sum += (k == 0 || k == n ? 1 : k % 2 ? 4 : 2) * f(r) * step / 3;
        }
    }
    return sum;
}
double sphere(int dimensions, double r) { return dimensions == 3 ? 4 * math::pi * r * r : 2 * math::pi * r; }

class Kernels : public testing::TestWithParam<std::tuple<KernelKind, int>> {
protected:
    KernelKind kind = std::get<0>(GetParam());
    int dimensions = std::get<1>(GetParam());
};

} // namespace

TEST_P(Kernels, IntegrateToOne) {
    with_kernel(kind, dimensions, h, [&](const auto& kernel) {
        EXPECT_NEAR(integrate([&](double r) { return sphere(dimensions, r) * kernel.value(r); }), 1, 1e-9);
        EXPECT_EQ(kernel.dimensions, dimensions);
    });
}

// By parts: for the kernel whose slope `gradient` is, the integral is -int W' S r / D dr.
TEST_P(Kernels, GradientsBelongToAKernelThatIntegratesToOne) {
    with_kernel(kind, dimensions, h, [&](const auto& kernel) {
        const double all = integrate(
            [&](double r) { return r == 0 ? 0.0 : -kernel.gradient(r) * r * sphere(dimensions, r) * r / dimensions; });
        EXPECT_NEAR(all, 1, 1e-9);
    });
}

TEST_P(Kernels, GradientIsTheSlopeOfTheValue) {
    // Mueller's pair has the slope of another kernel, (h - r)^3, normalised as above.
    with_kernel(kind, dimensions, h, [&](const auto& kernel) {
        const auto value = [&](double r) {
            if (kind != KernelKind::mueller) return kernel.value(r);
            const double a = h - r;
            return dimensions == 3 ? 15 / (math::pi * std::pow(h, 6)) * a * a * a
                                   : 10 / (math::pi * std::pow(h, 5)) * a * a * a;
        };
        const double scale = kernel.value(0.0) / h, step = 1e-5 * h;
        for (const double q : {0.01, 0.2, 0.4999, 0.5001, 0.7, 0.99}) {
            const double r = q * h, slope = (value(r + step) - value(r - step)) / (2 * step);
            // Central differences: the third derivative times step^2, and the kink of the cubic's second one.
            EXPECT_NEAR(kernel.gradient(r) * r, slope, 1e-7 * scale) << "r / h = " << q;
        }
    });
}

TEST_P(Kernels, RadialIsTheSlopeTimesTheDistance) {
    with_kernel(kind, dimensions, h, [&](const auto& kernel) {
        for (const double q : {0.0, 1e-3, 0.3, 0.5, 0.8, 1.0}) {
            const double r = q * h;
            EXPECT_NEAR(kernel.radial(r), r > 0 ? kernel.gradient(r) * r * r : 0.0, 1e-14 * kernel.value(0.0));
        }
    });
}

TEST_P(Kernels, EndAtTheSupportAndNeverRise) {
    with_kernel(kind, dimensions, h, [&](const auto& kernel) {
        EXPECT_NEAR(kernel.value(h), 0, 1e-15 * kernel.value(0.0));
        EXPECT_NEAR(kernel.gradient(h), 0, 1e-15 * std::abs(kernel.gradient(h / 2)));
        for (int k = 1; k < 100; ++k) {
            EXPECT_LT(kernel.gradient(0.01 * k * h), 0);
            EXPECT_LT(kernel.value(0.01 * k * h), kernel.value(0.01 * (k - 1) * h));
        }
    });
}

INSTANTIATE_TEST_SUITE_P(All, Kernels, testing::Combine(testing::ValuesIn(kinds), testing::Values(2, 3)));

TEST(NumberKernel, IsTheRatioOfSupportAndDistanceLessOneAndStaysFiniteAtZero) {
    const NumberKernel kernel(0.2, 0.1);
    EXPECT_DOUBLE_EQ(kernel.value(0.1), 1);
    EXPECT_DOUBLE_EQ(kernel.value(0.2), 0);
    EXPECT_DOUBLE_EQ(kernel.value(0.0), kernel.value(0.01));
    EXPECT_DOUBLE_EQ(kernel.value(0.0), 19);
}

} // namespace treacle::sph::kernels_test
