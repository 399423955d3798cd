#include "search/cma_es/cma_state.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace treacle::search {
namespace {

// The tutorial's constants with pycma's for c_sigma, c_1 and c_mu, to the digits with which pycma 4.4.0 prints them.
TEST(CmaState, HasTheStandardConstants) {
    const auto two = CmaConstants::standard(2, 0, true);
    EXPECT_EQ(two.lambda, 6U);
    EXPECT_NEAR(two.mu_eff, 2.0286, 5e-5);
    EXPECT_NEAR(two.c_c, 0.6246, 5e-5);
    EXPECT_NEAR(two.c_1, 0.15482, 5e-6);
    EXPECT_NEAR(two.c_mu, 0.0856, 5e-5);
    const auto five = CmaConstants::standard(5, 0, true);
    EXPECT_EQ(five.lambda, 8U);
    EXPECT_NEAR(five.weights[3], 0.0415, 5e-5);
    EXPECT_NEAR(five.c_1, 0.04729, 5e-6);
    EXPECT_NEAR(five.c_mu, 0.0479, 5e-5);
    const auto ten = CmaConstants::standard(10, 0, true);
    EXPECT_EQ(ten.lambda, 10U);
    EXPECT_EQ(ten.mu, 5U);
    EXPECT_NEAR(ten.mu_eff, 3.1673, 5e-5);
    EXPECT_NEAR(ten.c_sigma, 0.3196142529106334, 1e-15);
    EXPECT_NEAR(ten.d_sigma, 1.3196142529106334, 1e-15);
    EXPECT_NEAR(ten.c_c, 0.29499038303562225, 1e-15);
    EXPECT_NEAR(ten.c_1, 0.015283824524751714, 1e-16);
    EXPECT_NEAR(ten.c_mu, 0.02355177665041747, 1e-16);
    EXPECT_NEAR(ten.chi, 3.08473, 5e-6);
    const std::vector<double> weights{0.45627264690340597, 0.2707530970017852, 0.16223111715866978, 0.08523354710016448,
        0.025509591835974777, -0.08001260758087224, -0.22176416099914653, -0.34455494178482093, -0.45286408637842196,
        -0.5497499176973853};
    for (std::size_t i = 0; i < weights.size(); ++i) EXPECT_NEAR(ten.weights[i], weights[i], 1e-14);
    for (std::size_t i = 5; i < 10; ++i) EXPECT_EQ(CmaConstants::standard(10, 0, false).weights[i], 0);
}

TEST(CmaState, InOneDimensionOnlyTheStepSizeAdapts) {
    const auto one = CmaConstants::standard(1, 4, true);
    EXPECT_NEAR(one.weights[0], 0.8042, 5e-5);
    EXPECT_NEAR(one.mu_eff, 1.4598, 5e-5);
    EXPECT_NEAR(one.chi, 0.797884560802865, 1e-15);
    EXPECT_EQ(CmaConstants::standard(1, 0, true).lambda, 8U);
    CmaState state({0}, 1, one);
    for (int g = 0; g < 50; ++g) state.update({{2.0 + g}, {1.0 + g}, {0.5 + g}, {-1.0 + g}}, 4);
    EXPECT_EQ(state.covariance()(0, 0), 1);
    EXPECT_GT(state.sigma(), 2);
}

// The covariance stays positive definite whatever the ranks: 300 generations that always go one way.
TEST(CmaState, StaysPositiveDefinite) {
    CmaState state({0, 0, 0}, 1, CmaConstants::standard(3, 0, true));
    for (int g = 0; g < 300; ++g) {
        std::vector<std::vector<double>> ranked;
        for (std::size_t k = 0; k < state.constants().lambda; ++k)
            ranked.push_back(state.candidate({3.0 - double(k), std::sin(double(7 * g) + double(k)), 0.1 * double(k)}));
        state.update(ranked, ranked.size());
        ASSERT_GT(state.axes().values.front(), 0) << "generation " << g;
    }
}

// A path that grows at once to many times its expected length does not enter C: h_sigma is 0.
TEST(CmaState, AStepSizeFarTooSmallDoesNotStretchTheCovariance) {
    CmaState state({0, 0}, 1, CmaConstants::standard(2, 0, false));
    std::vector<std::vector<double>> ranked(6, state.candidate({30, 0}));
    state.update(ranked, 6);
    EXPECT_EQ(state.path(0), 0);
    CmaState usual({0, 0}, 1, CmaConstants::standard(2, 0, false));
    usual.update(std::vector<std::vector<double>>(6, usual.candidate({0.5, 0})), 6);
    EXPECT_GT(usual.path(0), 0);
}

TEST(CmaState, CandidatesWithoutAValueDoNotMoveTheMean) {
    CmaState state({0, 0}, 1, CmaConstants::standard(2, 0, true));
    const std::vector<std::vector<double>> ranked{{1, 1}, {9, 9}, {9, 9}, {9, 9}, {9, 9}, {9, 9}};
    state.update(ranked, 1);
    EXPECT_NEAR(state.mean()[0], 1, 1e-15);
    EXPECT_NEAR(state.mean()[1], 1, 1e-15);
}

} // namespace
} // namespace treacle::search
