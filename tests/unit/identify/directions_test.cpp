#include "identify/estimate/directions.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace treacle::identify {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

std::vector<search::Axis> axes() { return {{.lower = -2, .upper = 2}, {.lower = 0, .upper = 1}}; }
Vector at(double x, double y) { return Eigen::Vector2d(x, y); }

TEST(PointsToSpan, NothingIsLackingWherePointsLieAround) {
    EXPECT_TRUE(points_to_span(at(0, 0.5), {at(0, 0.5), at(0.2, 0.5), at(0, 0.6)}, axes()).empty());
}

TEST(PointsToSpan, TheAnswerItselfAndTheDirectionWithoutPointsAreAskedFor) {
    const auto points = points_to_span(at(0, 0.5), {at(0.2, 0.5), at(-0.2, 0.5)}, axes());
    ASSERT_EQ(points.size(), 2u);
    EXPECT_EQ(points[0], (search::Point{0, 0.5}));
    EXPECT_NEAR(points[1][0], 0, 1e-12);
    EXPECT_NEAR(points[1][1], 0.65, 1e-12);
}

TEST(PointsToSpan, AtABoundThePointIsOnTheOtherSide) {
    const auto points = points_to_span(at(0, 0.98), {at(0, 0.98), at(0.2, 0.98)}, axes());
    ASSERT_EQ(points.size(), 1u);
    EXPECT_NEAR(points[0][1], 0.83, 1e-12);
}

// The well known combination x + y goes as 1 + h; the other scatters along the valley from rung to rung.
TEST(ExtrapolateAnswers, TheWellKnownCombinationIsNotSpoiltByTheOther) {
    const Vector well = at(std::sqrt(0.5), std::sqrt(0.5)), ill = at(std::sqrt(0.5), -std::sqrt(0.5));
    const std::vector<double> spacings{4, 2, 1};
    std::vector<ResolutionAnswer> answers;
    const double wild[] = {0.4, -0.5, 0.3};
    for (std::size_t i = 0; i < 3; ++i)
        answers.push_back({spacings[i], 1, (1 + 0.02 * spacings[i]) * well + wild[i] * ill});
    const Matrix covariance = 1e-6 * well * well.transpose() + 0.2 * ill * ill.transpose();
    const auto found = extrapolate_answers(answers, covariance, covariance, 4);
    EXPECT_NEAR(well.dot(found.value), 1, 0.01);
    EXPECT_LT(well.dot(found.resolution * well), 0.03 * 0.03);
    EXPECT_GT(ill.dot((found.resolution + found.noise) * ill), 0.1 * 0.1);
}

TEST(Trades, AreSaidOfParametersThatCorrelateOnly) {
    Matrix covariance(3, 3);
    covariance << 1, -0.97, 0.2, -0.97, 1, 0, 0.2, 0, 1;
    const auto found = trades({"K", "n", "yield"}, covariance);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_TRUE(found[0].starts_with("K trades with n: one rises as the other falls")) << found[0];
}

} // namespace
} // namespace treacle::identify
