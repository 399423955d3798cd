#include "search/gradient/gradient_methods.hpp"
#include "search/population/nelder_mead.hpp"
#include "search/population/swarm.hpp"

#include "functions.hpp"

#include <gtest/gtest.h>
#include <memory>

namespace treacle::search {
namespace {

Limits to(double target, std::int64_t evaluations = 20000) {
    Limits limits;
    limits.target = target;
    limits.evaluations = evaluations;
    return limits;
}

template <class Method>
std::int64_t evaluations(const Function& f, std::size_t n, double start, double step) {
    Method search(axes(n, start, step), {.limits = to(1e-9)});
    minimise(search, f);
    EXPECT_EQ(search.stopped()->kind, StopKind::target) << search.name() << " " << search.stopped()->name;
    return search.evaluations();
}

// Upper bounds: a third above what was measured.
TEST(Comparators, FindTheLeastValueOfSmoothFunctions) {
    EXPECT_LE(evaluations<NelderMead>(sphere, 5, 1, 1), 440);
    EXPECT_LE(evaluations<NelderMead>(rosenbrock, 5, 0, 0.5), 890);
    EXPECT_LE(evaluations<Lbfgs>(sphere, 5, 1, 1), 30);
    EXPECT_LE(evaluations<Lbfgs>(ellipsoid, 5, 1, 1), 770);
    EXPECT_LE(evaluations<Lbfgs>(rosenbrock, 5, 0, 0.5), 590);
    EXPECT_LE(evaluations<ConjugateGradients>(sphere, 5, 1, 1), 20);
    EXPECT_LE(evaluations<ConjugateGradients>(ellipsoid, 5, 1, 1), 120);
    EXPECT_LE(evaluations<ConjugateGradients>(rosenbrock, 2, 0, 0.5), 130);
    EXPECT_LE(evaluations<MomentumDescent>(sphere, 5, 1, 1), 2100);
    EXPECT_LE(evaluations<Swarm>(sphere, 5, 1, 1), 3900);
    EXPECT_LE(evaluations<Swarm>(ellipsoid, 5, 1, 1), 5000);
}

using Maker = std::function<std::unique_ptr<Search>(std::vector<Axis>, const Limits&)>;

template <class Method, class Options>
Maker maker() {
    return [](std::vector<Axis> given, const Limits& limits) -> std::unique_ptr<Search> {
        return std::make_unique<Method>(std::move(given), Options{.limits = limits});
    };
}

class EveryComparator : public testing::TestWithParam<Maker> {};

TEST_P(EveryComparator, StaysWithinTheBoundsAndFindsAnAnswerOnOne) {
    auto given = axes(2, 1, 0.5);
    for (Axis& axis : given) {
        axis.lower = 0.2;
        axis.upper = 3;
        axis.tolerance = 1e-4;
    }
    const auto search = GetParam()(given, {.evaluations = 5000});
    for (const Point& x : minimise(*search, [](const Point& x) { return x[0] + (x[1] - 2) * (x[1] - 2); }))
        for (const double c : x) EXPECT_TRUE(c >= 0.2 && c <= 3) << search->name();
    EXPECT_NEAR(search->best()->point[0], 0.2, 1e-3) << search->name();
    EXPECT_NEAR(search->best()->point[1], 2, 0.02) << search->name();
    EXPECT_TRUE(search->stopped()->kind != StopKind::budget) << search->name();
    EXPECT_EQ(search->spread().size(), 2U);
}

TEST_P(EveryComparator, GoesAroundWhatFails) {
    const auto search = GetParam()(axes(2, 1, 0.5), to(1e-4, 5000));
    minimise(*search, [](const Point& x) { return x[0] > 1.2 ? std::nan("") : sphere(x); });
    EXPECT_EQ(search->stopped()->name, "target") << search->name();
}

TEST_P(EveryComparator, EndsWhenNothingHasAValue) {
    const auto search = GetParam()(axes(2, 1, 0.5), {});
    minimise(*search, [](const Point&) { return std::nan(""); });
    EXPECT_EQ(search->stopped()->kind, StopKind::failed) << search->name();
}

TEST_P(EveryComparator, GoesTheSameWayAgainWhateverIsSpeculated) {
    const auto first = GetParam()(axes(3, 0, 0.5), {.evaluations = 400}),
               second = GetParam()(axes(3, 0, 0.5), {.evaluations = 400});
    while (!first->stopped()) {
        ASSERT_EQ(first->ask(), second->ask());
        second->speculate();
        const auto values = values_of(first->ask(), rosenbrock);
        first->tell(values);
        second->tell(values);
    }
}

INSTANTIATE_TEST_SUITE_P(All, EveryComparator,
    testing::Values(maker<NelderMead, NelderMeadOptions>(), maker<Lbfgs, GradientOptions>(),
        maker<ConjugateGradients, GradientOptions>(), maker<MomentumDescent, GradientOptions>(),
        maker<Swarm, SwarmOptions>()));

// What a cut ends early changes no step of a search whose cut is exact.
template <class Method>
void expect_no_effect_of_cuts() {
    Method whole(axes(3, 0, 0.5), {.limits = to(1e-6)}), early(axes(3, 0, 0.5), {.limits = to(1e-6)});
    int ended = 0;
    while (!whole.stopped()) {
        ASSERT_EQ(whole.ask(), early.ask());
        const auto values = values_of(whole.ask(), rosenbrock);
        auto cut = values;
        for (std::size_t k = 0; k < cut.size(); ++k) {
            const bool above = values[k].value() > early.cut(k);
            if (above) cut[k] = Value::at_least(early.cut(k));
            ended += above;
        }
        whole.tell(values);
        early.tell(cut);
    }
    EXPECT_GT(ended, whole.evaluations() / 10);
}

TEST(Comparators, CutsOfNelderMeadAndSwarmChangeNothing) {
    expect_no_effect_of_cuts<NelderMead>();
    expect_no_effect_of_cuts<Swarm>();
}

// Steps of a noisy objective that are as large as the differences lead gradients astray; the ranks of CMA-ES and the
// simplex get nearer. This is the observation of section 6.5.5.
TEST(Comparators, GradientsAreStuckWhereTheObjectiveHasSteps) {
    const auto steps = [](const Point& x) { return std::floor(50 * sphere(x)) / 50; };
    Lbfgs gradients(axes(2, 1, 0.5), {.limits = to(-1)});
    minimise(gradients, steps);
    EXPECT_GT(gradients.best()->value, 0.1);
    NelderMead simplex(axes(2, 1, 0.5), {.limits = to(-1)});
    minimise(simplex, steps);
    EXPECT_LT(simplex.best()->value, 0.1);
}

} // namespace
} // namespace treacle::search
