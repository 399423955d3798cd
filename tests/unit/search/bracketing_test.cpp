#include "search/bracketing/bracketing.hpp"

#include "functions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

namespace treacle::search {
namespace {

using Curve = std::function<double(double)>;

Axis axis(double start, double tolerance = 0.01) {
    Axis out;
    out.lower = -7;
    out.upper = 7;
    out.start = start;
    out.tolerance = tolerance;
    return out;
}

Function of(const Curve& f) {
    return [f](const Point& x) { return f(x[0]); };
}

constexpr double starts[] = {0.3, 0.7, 1.3, 2.0, 3.3, -1.1, -2.7};

// The most evaluations of all starts; each must end within the tolerance of the least value at 0.
std::int64_t most_evaluations(const Curve& f, double tolerance = 0.01) {
    std::int64_t most = 0;
    for (const double start : starts) {
        Bracketing search(axis(start, tolerance));
        minimise(search, of(f));
        EXPECT_NEAR(search.best()->point[0], 0, 1.000001 * tolerance) << "from " << start;
        EXPECT_EQ(search.stopped()->name, "tolx");
        most = std::max(most, search.evaluations());
    }
    return most;
}

// Brent's method with neither the lattice nor the corner needs 8 and 16.
TEST(Bracketing, NeedsFewEvaluations) {
    EXPECT_LE(most_evaluations([](double x) { return x * x; }), 8);
    EXPECT_LE(most_evaluations([](double x) { return std::abs(x); }), 12);
    EXPECT_LE(most_evaluations([](double x) { return x < 0 ? -3 * x : x; }), 12);
    EXPECT_LE(most_evaluations([](double x) { return std::sqrt(4e-4 + x * x); }), 12); // a rounded corner
    EXPECT_LE(most_evaluations([](double x) { return x * x + 0.1 * x * x * x + 0.02 * std::pow(x, 4); }), 12);
    EXPECT_LE(most_evaluations([](double x) { return std::abs(std::exp(-0.11 * x) - 1); }), 14); // a drain's speed
}

TEST(Bracketing, FindsWhatNoModelDescribes) {
    EXPECT_LE(most_evaluations([](double x) { return std::sqrt(std::abs(x)); }), 16);
    EXPECT_LE(most_evaluations([](double x) { return std::pow(x, 4); }), 24);
    EXPECT_LE(most_evaluations([](double x) { return std::abs(x); }, 1e-6), 16);
}

// Displacements that level out far from the answer, each at its own pace, as contours do that have run off.
std::vector<double> displacements(double x) {
    std::vector<double> out;
    for (int i = 1; i <= 30; ++i) out.push_back(4 * i * std::tanh(0.02 * i * x) + 0.3 * std::sin(9 * i));
    return out;
}

double mean_loss(const std::vector<double>& residuals) {
    double sum = 0;
    for (const double r : residuals) sum += std::abs(r) <= 3 ? 0.5 * r * r : 3 * std::abs(r) - 4.5;
    return sum / double(residuals.size());
}

// Evaluations until the stop; `told` returns the residuals of a point.
std::int64_t evaluations_with(double start, const std::function<std::vector<double>(double)>& told) {
    Bracketing search(axis(start, 0.03));
    while (!search.stopped()) {
        const auto points = search.ask();
        std::vector<std::vector<double>> residuals;
        std::vector<Value> values;
        for (const auto& x : points) {
            residuals.push_back(told(x[0]));
            values.push_back(Value::measured(mean_loss(displacements(x[0]))));
        }
        search.tell_residuals(residuals);
        search.tell(values);
    }
    EXPECT_NEAR(search.best()->point[0], 0, 0.04) << "from " << start;
    return search.evaluations();
}

TEST(Bracketing, ResidualsLeadToTheAnswerInFewerEvaluations) {
    std::int64_t most = 0, most_without = 0;
    for (const double start : starts) {
        most = std::max(most, evaluations_with(start, displacements));
        most_without = std::max(most_without, evaluations_with(start, [](double) { return std::vector<double>(); }));
    }
    EXPECT_LE(most, 8);
    EXPECT_GE(most_without, most + 2);
}

TEST(Bracketing, ResidualsThatSayNothingDoNotLeadAstray) {
    for (const double start : starts)
        EXPECT_LE(evaluations_with(start,
                      [](double x) {
                          return std::vector<double>{std::sin(100 * x), std::cos(70 * x), std::nan("")};
                      }),
            16);
}

TEST(Bracketing, PointsLieOnALattice) {
    Bracketing search(axis(0.3, 0.02));
    for (const Point& x : minimise(search, of([](double x) { return std::cosh(x); }))) {
        const double number = (x[0] - 0.3) / 0.01;
        EXPECT_NEAR(number, std::round(number), 1e-9);
    }
}

TEST(Bracketing, AsksForTheStartAndBothItsSidesAtOnce) {
    Bracketing search(axis(0.5));
    EXPECT_EQ(search.ask(), (std::vector<Point>{{0.5}, {-0.5}, {1.5}}));
}

// With lanes for the next candidates, many rounds need no new runs.
TEST(Bracketing, SpeculationSavesRounds) {
    std::size_t asked = 0, waited = 0;
    for (const double start : starts) {
        Bracketing search(axis(start));
        std::set<Point> known;
        while (!search.stopped()) {
            const auto points = search.ask();
            bool wait = false;
            for (const Point& x : points) wait = known.insert(x).second || wait;
            ++asked;
            waited += wait;
            for (const Point& x : search.speculate()) known.insert(x);
            search.tell(values_of(points, of([](double x) { return std::sqrt(4e-4 + x * x); })));
        }
    }
    EXPECT_LT(double(waited), 0.75 * double(asked)); // measured 0.61
}

TEST(Bracketing, SpeculationChangesNothing) {
    Bracketing with(axis(2)), without(axis(2));
    const auto f = of([](double x) { return std::abs(std::exp(-0.11 * x) - 1); });
    while (!with.stopped()) {
        ASSERT_EQ(with.ask(), without.ask());
        with.speculate();
        const auto values = values_of(with.ask(), f);
        with.tell(values);
        without.tell(values);
    }
    EXPECT_TRUE(without.stopped());
}

TEST(Bracketing, NamesABoundThatTheLeastValueIsAt) {
    for (const double sign : {-1.0, 1.0}) {
        Bracketing search(axis(1));
        minimise(search, of([sign](double x) { return std::exp(sign * x); }));
        EXPECT_EQ(search.stopped()->name, "bound");
        EXPECT_EQ(search.best()->point[0], -7 * sign);
    }
    Bracketing at_bound(axis(7));
    minimise(at_bound, of([](double x) { return (x - 6.5) * (x - 6.5); }));
    EXPECT_EQ(at_bound.stopped()->name, "tolx");
    EXPECT_NEAR(at_bound.best()->point[0], 6.5, 0.01);
}

// Below its least value at -5 it levels out, as a drain's level does, and steps downhill from 3 go over that to the bound.
TEST(Bracketing, LooksBackIntoTheGapBeforeABound) {
    Axis wide = axis(3);
    wide.lower = -7.5;
    wide.step = 2;
    Bracketing search(wide);
    const auto level = [](double below) { return 0.1 * (1 - std::exp(-3 * below)) - 0.01 * below; };
    minimise(search, of([&](double x) { return x < -5 ? level(-5 - x) : 0.3 * (x + 5); }));
    EXPECT_NEAR(search.best()->point[0], -5, 0.01);
}

TEST(Bracketing, EndsWhereTheObjectiveFallsForEver) {
    Bracketing search(Axis{});
    minimise(search, of([](double x) { return -x; }));
    EXPECT_EQ(search.stopped()->name, "growth");
}

TEST(Bracketing, RunsThatFailAreWallsAndBoundsEnterNoModel) {
    Bracketing search(axis(3));
    while (!search.stopped()) {
        std::vector<Value> values;
        for (const Point& x : search.ask()) {
            const double f = (x[0] - 0.2) * (x[0] - 0.2);
            values.push_back(x[0] < 0 ? Value::failed() : f > 1 ? Value::at_least(1) : Value::measured(f));
        }
        search.tell(values);
    }
    EXPECT_NEAR(search.best()->point[0], 0.2, 0.01);
    Bracketing hopeless(axis(3));
    minimise(hopeless, of([](double) { return std::nan(""); }));
    EXPECT_EQ(hopeless.stopped()->kind, StopKind::failed);
}

TEST(Bracketing, EndsOnAPlateau) {
    Bracketing search(axis(3));
    minimise(search, of([](double x) { return std::floor(std::abs(x) * 2); }));
    EXPECT_EQ(search.best()->value, 0);
    EXPECT_LE(search.evaluations(), 40);
}

} // namespace
} // namespace treacle::search
