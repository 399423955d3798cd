#include "search/population/surrogate_search.hpp"

#include "functions.hpp"

#include <gtest/gtest.h>

namespace treacle::search {
namespace {

std::vector<std::vector<double>> scattered(std::size_t m, std::size_t n, double width, std::uint32_t set = 0) {
    const Random random(11);
    std::vector<std::vector<double>> out(m, std::vector<double>(n));
    for (std::uint32_t k = 0; k < m; ++k)
        for (std::uint32_t i = 0; i < n; ++i) out[k][i] = width * (random.uniform(Purpose::model, set, k, i) - 0.5);
    return out;
}

double waves(const std::vector<double>& x) { return std::sin(2 * x[0]) + 0.3 * x[1]; }

GaussianProcess through(const std::vector<std::vector<double>>& points, const Function& f) {
    std::vector<double> values;
    for (const auto& x : points) values.push_back(f(x));
    return {points, values};
}

TEST(GaussianProcess, GoesThroughExactValues) {
    const auto points = scattered(25, 2, 4);
    const auto process = through(points, waves);
    for (const auto& x : points) EXPECT_NEAR(process.at(x).mean, waves(x), 1e-3);
    EXPECT_LT(process.noise(), 1e-3);
}

TEST(GaussianProcess, FindsTheLongerLength) {
    const auto process = through(scattered(40, 2, 4), waves);
    EXPECT_GT(process.lengths()[1], 2 * process.lengths()[0]);
}

// Noise of 0.1 on 80 values: its estimate has a standard error of about a tenth.
TEST(GaussianProcess, TellsNoiseFromTheFunction) {
    const Random random(4);
    std::uint32_t k = 0;
    const auto process = through(
        scattered(80, 2, 4), [&](const Point& x) { return waves(x) + 0.1 * random.normal(Purpose::model, 9, k++, 0); });
    EXPECT_NEAR(process.noise(), 0.1, 0.03);
}

// At new places nearly all errors are within three deviations, and deviations are not much too wide.
TEST(GaussianProcess, KnowsItsError) {
    const auto process = through(scattered(25, 2, 4), waves);
    double squares = 0;
    int outside = 0;
    const auto points = scattered(200, 2, 3, 1);
    for (const auto& x : points) {
        const auto [mean, deviation] = process.at(x);
        const double z = (mean - waves(x)) / deviation;
        squares += z * z / double(points.size());
        outside += std::abs(z) > 3;
    }
    EXPECT_LE(outside, 6);
    EXPECT_GT(std::sqrt(squares), 0.1);
    EXPECT_GT(process.at({40, 40}).deviation, 10 * process.at({0, 0}).deviation);
}

TEST(GaussianProcess, BelievesWhatItIsTold) {
    auto process = through(scattered(12, 2, 4), waves);
    const std::vector<double> x{1.7, -1.9};
    const double before = process.at(x).deviation;
    process.believe(x, 5);
    EXPECT_NEAR(process.at(x).mean, 5, 0.1);
    EXPECT_LT(process.at(x).deviation, 0.3 * before);
}

std::vector<Axis> coarse(std::size_t n, double start, double step) {
    auto out = axes(n, start, step);
    for (Axis& axis : out) axis.tolerance = 0.01;
    return out;
}

TEST(SurrogateSearch, NeedsFewEvaluationsOfSmoothFunctions) {
    SurrogateSearch line(coarse(1, 0.7, 1)), plane(coarse(2, 0.7, 1));
    minimise(line, sphere);
    minimise(plane, sphere);
    EXPECT_NEAR(line.centre()[0], 0, 0.01);
    EXPECT_LE(line.evaluations(), 12);
    EXPECT_LT(plane.best()->value, 1e-3);
    EXPECT_LE(plane.evaluations(), 20);
    EXPECT_EQ(plane.stopped()->name, "improvement");
    SurrogateSearch valley(coarse(2, 0, 0.5), {.limits = {.evaluations = 60, .target = 1e-3}});
    minimise(valley, rosenbrock);
    EXPECT_EQ(valley.stopped()->name, "target"); // CMA-ES needs about 250
}

TEST(SurrogateSearch, IsNotFooledByNoise) {
    const Random random(3);
    std::uint32_t k = 0;
    SurrogateSearch search(coarse(2, 0.7, 1));
    minimise(search, [&](const Point& x) { return sphere(x) + 0.02 * random.normal(Purpose::model, 9, k++, 0); });
    for (const double c : search.centre()) EXPECT_NEAR(c, 0, 0.14); // where the function is as large as the noise
    EXPECT_LE(search.evaluations(), 40);
}

TEST(SurrogateSearch, AsksForBatchesOfPointsThatDiffer) {
    SurrogateSearch search(coarse(2, 0.7, 1), {.batch = 4});
    search.tell(values_of(search.ask(), sphere));
    const auto batch = search.ask();
    ASSERT_EQ(batch.size(), 4U);
    for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = 0; b < a; ++b)
            EXPECT_GT(std::abs(batch[a][0] - batch[b][0]) + std::abs(batch[a][1] - batch[b][1]), 0.01);
}

TEST(SurrogateSearch, FailuresAndBoundsEnterNoFit) {
    SurrogateSearch search(coarse(2, 0.7, 1), {.limits = {.evaluations = 60}});
    std::size_t measured = 0;
    while (!search.stopped()) {
        std::vector<Value> values;
        for (const Point& x : search.ask()) {
            const double f = sphere(x);
            values.push_back(x[0] < -0.2 ? Value::failed() : f > 2 ? Value::at_least(2) : Value::measured(f));
            measured += values.back().is_measured();
        }
        if (!values.empty()) search.tell(values);
    }
    EXPECT_EQ(search.model()->size(), measured);
    EXPECT_LT(search.best()->value, 0.03); // beside a wall of failures; the start has 0.98
    SurrogateSearch hopeless(coarse(2, 0.7, 1));
    minimise(hopeless, [](const Point&) { return std::nan(""); });
    EXPECT_EQ(hopeless.stopped()->kind, StopKind::failed);
}

TEST(SurrogateSearch, StaysWithinBoundsAndGoesTheSameWayAgain) {
    auto given = coarse(2, 0.7, 1);
    for (Axis& axis : given) axis.lower = 0.1;
    SurrogateSearch first(given, {.limits = {.evaluations = 25}}), second(given, {.limits = {.evaluations = 25}});
    const auto asked = minimise(first, sphere);
    EXPECT_EQ(asked, minimise(second, sphere));
    for (const Point& x : asked)
        for (const double c : x) EXPECT_GE(c, 0.1);
    EXPECT_NEAR(first.best()->point[0], 0.1, 0.01);
}

} // namespace
} // namespace treacle::search
