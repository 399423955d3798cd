#include "search/cma_es/lq_cma_es.hpp"

#include "functions.hpp"

#include <gtest/gtest.h>

namespace treacle::search {
namespace {

double bent(const Point& x) { return 3 + x[0] - 2 * x[1] + 2 * x[0] * x[0] + 3 * x[1] * x[1] + x[0] * x[1]; }

LqModel through(const Function& f, std::uint32_t count) {
    const Random random(2);
    LqModel model(2, 6);
    for (std::uint32_t k = 0; k < count; ++k) {
        const Point x{random.normal(Purpose::model, 0, k, 0), random.normal(Purpose::model, 0, k, 1)};
        model.add(x, f(x));
    }
    model.fit(count);
    return model;
}

TEST(LqModel, IsExactForItsOwnPolynomials) {
    const auto full = through(bent, 12);
    EXPECT_NEAR(full.at({5, -4}), bent({5, -4}), 1e-9);
    EXPECT_NEAR(full.agreement(12), 1, 1e-15);
    const auto minimum = full.minimum();
    ASSERT_TRUE(minimum);
    for (const double c : full.gradient(*minimum)) EXPECT_NEAR(c, 0, 1e-9);
    EXPECT_NEAR(4 * (*minimum)[0] + (*minimum)[1], -1, 1e-9);
    EXPECT_NEAR((*minimum)[0] + 6 * (*minimum)[1], 2, 1e-9);
}

TEST(LqModel, HasAsManyTermsAsItsValuesSufficeFor) {
    EXPECT_FALSE(through(bent, 5).minimum()); // linear
    EXPECT_TRUE(through(bent, 8).minimum());  // squares
    EXPECT_GT(std::abs(through(bent, 8).at({5, -4}) - bent({5, -4})), 1e-3);
    EXPECT_FALSE(through([](const Point& x) { return -sphere(x); }, 12).minimum());
}

std::int64_t median_evaluations(const Function& f, std::size_t n, double start, double step) {
    std::vector<std::int64_t> counts;
    for (std::uint64_t seed = 1; seed <= 7; ++seed) {
        CmaOptions options;
        options.seed = seed;
        options.limits.target = 1e-9;
        LqCmaEs search(axes(n, start, step), options);
        minimise(search, f);
        EXPECT_EQ(search.stopped()->kind, StopKind::target) << search.stopped()->name;
        counts.push_back(search.evaluations());
    }
    return median(counts);
}

// pycma 4.4.0 needs 9, 18, 32; 10, 19, 34; 134, 333, 1260 (n = 2, 5, 10).
TEST(LqCmaEs, NeedsAsFewEvaluationsAsTheReferenceImplementation) {
    EXPECT_LE(median_evaluations(sphere, 2, 1, 1), 10);
    EXPECT_LE(median_evaluations(sphere, 10, 1, 1), 34);
    EXPECT_LE(median_evaluations(ellipsoid, 5, 1, 1), 20);
    EXPECT_LE(median_evaluations(rosenbrock, 2, 0, 0.5), 134);
    EXPECT_LE(median_evaluations(rosenbrock, 5, 0, 0.5), 400);
}

TEST(LqCmaEs, WhereNoPolynomialHelpsItMeasuresEverything) {
    const Random noise(5);
    std::uint32_t k = 0;
    CmaOptions options;
    options.limits.evaluations = 600;
    LqCmaEs search(axes(3, 1, 1), options);
    minimise(search, [&](const Point& x) {
        return std::abs(x[0]) + std::abs(x[1]) + std::abs(x[2]) + 1e-3 * noise.normal(Purpose::model, 0, k++, 0);
    });
    EXPECT_LT(search.best()->value, 0.02);
}

TEST(LqCmaEs, AnswersOnBoundsAndBesideFailures) {
    auto given = axes(2, 1, 0.5);
    for (Axis& axis : given) {
        axis.lower = 0.2;
        axis.tolerance = 1e-4;
    }
    CmaOptions options;
    options.limits.evaluations = 2000;
    LqCmaEs search(given, options);
    for (const Point& x : minimise(search, [](const Point& x) { return x[0] > 1.5 ? std::nan("") : sphere(x); }))
        for (const double c : x) EXPECT_GE(c, 0.2);
    for (const double c : search.best()->point) EXPECT_NEAR(c, 0.2, 1e-3);
    LqCmaEs hopeless(axes(2, 1, 0.5));
    minimise(hopeless, [](const Point&) { return std::nan(""); });
    EXPECT_EQ(hopeless.stopped()->kind, StopKind::failed);
}

TEST(LqCmaEs, GoesTheSameWayAgainAndSpeculatesAboutItsGeneration) {
    LqCmaEs first(axes(4, 0, 0.5)), second(axes(4, 0, 0.5));
    for (int step = 0; step < 60 && !first.stopped(); ++step) {
        ASSERT_EQ(first.ask(), second.ask());
        EXPECT_LE(first.ask().size() + first.speculate().size(), first.state().constants().lambda);
        const auto values = values_of(first.ask(), rosenbrock);
        first.tell(values);
        second.tell(values);
    }
}

} // namespace
} // namespace treacle::search
