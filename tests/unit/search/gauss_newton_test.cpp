#include "search/gradient/gauss_newton.hpp"

#include "search/gradient/bounded_move.hpp"

#include "functions.hpp"

#include <gtest/gtest.h>

namespace treacle::search {
namespace {

using Residuals = std::function<std::vector<double>(const Point&)>;

double value_of(const std::vector<double>& residuals) {
    double sum = 0;
    std::size_t count = 0;
    for (const double r : residuals) {
        if (!std::isfinite(r)) continue;
        const double u = std::abs(r);
        sum += u <= 3 ? 0.5 * u * u : 3 * u - 4.5;
        ++count;
    }
    return count > 0 ? sum / double(count) : std::nan("");
}

std::vector<Point> minimise(GaussNewton& search, const Residuals& residuals) {
    std::vector<Point> asked;
    while (!search.stopped()) {
        const auto points = search.ask();
        if (points.empty()) break;
        std::vector<std::vector<double>> all;
        std::vector<Value> values;
        for (const auto& x : points) {
            asked.push_back(x);
            all.push_back(residuals(x));
            values.push_back(all.back().empty() ? Value::failed() : Value::measured(value_of(all.back())));
        }
        search.tell_residuals(all);
        search.tell(values);
    }
    return asked;
}

std::vector<Axis> logarithms() {
    std::vector<Axis> out(3);
    out[0] = {std::log(1.0), std::log(100.0), std::log(10.0), std::log(100.0) / 4, 0.01};
    out[1] = {0.2, 1, 0.6, 0.2, 0.006};
    out[2] = {std::log(0.5), std::log(50.0), std::log(5.0), std::log(100.0) / 4, 0.01};
    return out;
}

double herschel_bulkley(const Point& x, double rate) {
    return std::exp(x[2]) / rate + std::exp(x[0]) * std::pow(rate, x[1] - 1);
}

// Places of a front of which the speed falls with the viscosity at shear rates that fall in time, in units of their noise.
std::vector<double> fronts(const Point& x, const Point& truth, double noise) {
    std::vector<double> out;
    for (const double height : {1.0, 0.5}) {
        double position = 0, true_position = 0;
        for (int i = 0; i < 60; ++i) {
            const double rate = height * 70 * std::exp(-0.05 * i);
            position += 60 * height / (1 + herschel_bulkley(x, rate));
            true_position += 60 * height / (1 + herschel_bulkley(truth, rate));
            out.push_back(position - true_position + noise * std::sin(37.0 * i + 100 * height));
        }
    }
    return out;
}

double curve_difference(const Point& x, const Point& truth) {
    double worst = 0;
    for (const double rate : {5.0, 10.0, 20.0, 40.0, 70.0})
        worst = std::max(worst, std::abs(std::log(herschel_bulkley(x, rate) / herschel_bulkley(truth, rate))));
    return worst;
}

TEST(GaussNewton, FindsAFlowCurveOfThreeParametersByTwentyRuns) {
    for (const Point& truth : {Point{std::log(8.0), 0.5, std::log(5.0)}, Point{std::log(3.0), 0.35, std::log(20.0)},
             Point{std::log(40.0), 0.8, std::log(1.0)}}) {
        GaussNewton search(logarithms(), {.limits = {.evaluations = 20}});
        minimise(search, [&](const Point& x) { return fronts(x, truth, 0.3); });
        EXPECT_LT(curve_difference(search.best()->point, truth), 0.05);
    }
}

TEST(GaussNewton, ConvergesOnResidualsOfLargeCurvature) {
    GaussNewton search(axes(2, -1, 0.5), {.noise = 0, .limits = {.evaluations = 200, .target = 1e-8}});
    minimise(search, [](const Point& x) { return std::vector<double>{10 * (x[1] - x[0] * x[0]), 1 - x[0]}; });
    EXPECT_EQ(search.stopped()->kind, StopKind::target);
    EXPECT_LE(search.evaluations(), 80);
}

TEST(GaussNewton, StaysWithinTheBoundsAndFindsAnAnswerOnOne) {
    auto given = axes(2, 1, 0.5);
    for (Axis& axis : given) axis.lower = 0.2;
    for (Axis& axis : given) axis.upper = 3;
    GaussNewton search(given, {.limits = {.evaluations = 60}});
    for (const Point& x : minimise(search, [](const Point& x) {
             return std::vector<double>{x[0], x[1] - 2 + 0.3 * (x[0] - 0.2)};
         }))
        for (const double c : x) EXPECT_TRUE(c >= 0.2 && c <= 3);
    EXPECT_NEAR(search.best()->point[0], 0.2, 1e-3);
    EXPECT_NEAR(search.best()->point[1], 2, 0.02);
}

// Along a valley in which nothing changes the search stays where it came down.
TEST(GaussNewton, DoesNotWanderAlongAFlatValley) {
    GaussNewton search(axes(2, 0, 1), {.limits = {.evaluations = 60}});
    minimise(search, [](const Point& x) {
        std::vector<double> out;
        for (int i = 0; i < 20; ++i) out.push_back(3 * (x[0] + x[1] - 1) + std::sin(9.0 * i));
        return out;
    });
    EXPECT_EQ(search.stopped()->kind, StopKind::converged);
    EXPECT_NEAR(search.best()->point[0], 0.5, 0.3);
    EXPECT_NEAR(search.best()->point[1], 0.5, 0.3);
    EXPECT_LE(search.evaluations(), 9);
}

TEST(GaussNewton, GoesAroundWhatFailsAndRowsThatAreNotThere) {
    GaussNewton search(axes(2, 1, 0.5), {.noise = 0, .limits = {.evaluations = 60, .target = 1e-4}});
    minimise(search, [](const Point& x) {
        if (x[0] > 1.2) return std::vector<double>{};
        return std::vector<double>{x[0], x[1], x[1] > 0.5 ? std::nan("") : x[0] + x[1]};
    });
    EXPECT_EQ(search.stopped()->name, "target");
}

TEST(GaussNewton, EndsWhenNothingHasAValue) {
    GaussNewton search(axes(2, 1, 0.5));
    minimise(search, [](const Point&) { return std::vector<double>{}; });
    EXPECT_EQ(search.stopped()->kind, StopKind::failed);
}

TEST(GaussNewton, AsksForTheSamePointsAgain) {
    const auto asked = [] {
        GaussNewton search(logarithms(), {.limits = {.evaluations = 25}});
        return minimise(search, [](const Point& x) { return fronts(x, {2, 0.5, 1.6}, 0.3); });
    };
    EXPECT_EQ(asked(), asked());
}

TEST(BoundedMove, LeavesABoundWhereTheSlopeLeadsIn) {
    Matrix a = Matrix::identity(2);
    a(0, 1) = a(1, 0) = 0.9;
    // Unbounded (-5.3, 5.8) leaves at both ends; on the bound of the second the first is -1.5 + 0.
    const auto d = bounded_move(a, std::vector<double>{0, -1}, {{-0.5, -10}, {10, 10}, 100});
    EXPECT_NEAR(d[0], -0.5, 1e-6);
    EXPECT_NEAR(d[1], 1.45, 1e-6);
    EXPECT_NEAR(norm(bounded_move(a, std::vector<double>{3, -1}, {{-10, -10}, {10, 10}, 0.7})), 0.7, 1e-6);
}

} // namespace
} // namespace treacle::search
