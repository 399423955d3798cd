#include "search/problem/search.hpp"

#include "base/text/error.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <stdexcept>

namespace treacle::search {
namespace {

// Halves its step around the better of two points until that is below the tolerance; throws where a value is 13.
class Halving : public Search {
public:
    explicit Halving(const Axis& axis, const Limits& limits = {}) : Search({axis}, limits) {}
    Point spread() const override { return {step_}; }
    const char* name() const override { return "halving"; }

protected:
    Task<void> method() override {
        double x = axes()[0].start;
        step_ = axes()[0].step;
        while (step_ > axes()[0].smallest()) {
            x = co_await better(x - step_, x + step_);
            step_ /= 2;
        }
        end(StopKind::converged, "step", "the step is below the tolerance");
    }

private:
    Task<double> better(double a, double b) {
        std::vector<Point> pair{clamped({a}), clamped({b})};
        const auto values = co_await evaluate(pair);
        if (values[0].value() == 13) throw std::runtime_error("thirteen");
        co_return values[1] < values[0] ? pair[1][0] : pair[0][0];
    }
    double step_ = 0;
};

double parabola(double x) { return (x - 0.3) * (x - 0.3); }

std::vector<double> trace(Search& search) {
    std::vector<double> asked;
    while (!search.stopped()) {
        std::vector<Value> values;
        for (const Point& x : search.ask()) {
            asked.push_back(x[0]);
            values.push_back(Value::measured(parabola(x[0])));
        }
        if (!values.empty()) search.tell(values);
    }
    return asked;
}

TEST(Search, RunsItsMethodUntilItEnds) {
    Halving search({-1, 1, 0, 0.5, 1e-3});
    const auto asked = trace(search);
    EXPECT_EQ(search.stopped()->name, "step");
    EXPECT_TRUE(search.ask().empty());
    EXPECT_EQ(search.evaluations(), std::int64_t(asked.size()));
    EXPECT_NEAR(search.best()->point[0], 0.3, 2e-3);
    EXPECT_EQ(asked[std::size_t(search.best()->evaluation)], search.best()->point[0]);
    for (const double x : asked) EXPECT_LE(std::abs(x), 1.0);
}

TEST(Search, AsksForTheSameUntilItIsTold) {
    Halving search({-1, 1, 0, 0.5});
    const auto first = search.ask();
    EXPECT_EQ(first, search.ask());
    EXPECT_EQ(first.size(), 2U);
}

TEST(Search, NeverExceedsItsBudgetAndNamesIt) {
    Halving search({-1, 1, 0, 0.5}, {.evaluations = 7});
    trace(search);
    EXPECT_EQ(search.evaluations(), 6); // pairs
    EXPECT_EQ(search.stopped()->kind, StopKind::budget);
    EXPECT_EQ(search.stopped()->name, "evaluations");

    Halving short_one({-1, 1, 0, 0.5}, {.generations = 2});
    trace(short_one);
    EXPECT_EQ(short_one.stopped()->name, "generations");
    EXPECT_EQ(short_one.evaluations(), 4);
}

TEST(Search, EndsAtItsTarget) {
    Halving search({-1, 1, 0, 0.5}, {.target = 0.05});
    trace(search);
    EXPECT_EQ(search.stopped()->kind, StopKind::target);
    EXPECT_LE(search.best()->value, 0.05);
}

TEST(Search, HandsOnWhatItsMethodThrows) {
    Halving search({-1, 1, 0, 0.5});
    search.ask();
    const std::vector<Value> values(2, Value::measured(13));
    EXPECT_THROW(search.tell(values), std::runtime_error);
}

TEST(Search, RanksBoundsBehindValuesFailuresLastAndTiesInOrder) {
    const std::vector<Value> values{Value::failed(), Value::at_least(2), Value::measured(2), Value::measured(1),
        Value::measured(2), Value::measured(std::nan("")), Value::at_least(1.5), Value::measured(1)};
    EXPECT_EQ(ranking(values), (std::vector<std::size_t>{3, 7, 6, 2, 4, 1, 0, 5}));
    EXPECT_TRUE(values[5].is_failed());
}

TEST(Search, RefusesAnAxisThatCannotBeSearched) {
    const auto refused = [](const Axis& axis) {
        try {
            Halving search(axis);
        } catch (const InputError& error) {
            return error.diagnostics().front().problem;
        }
        return std::string();
    };
    EXPECT_NE(refused({0, 1, 2, 1}).find("start"), std::string::npos);
    EXPECT_NE(refused({1, 0, 0.5, 1}).find("bound"), std::string::npos);
    EXPECT_NE(refused({0, 1, 0.5, 0}).find("step"), std::string::npos);
    EXPECT_NE(refused({0, 1, std::nan(""), 1}).find("start"), std::string::npos);
    EXPECT_EQ(refused({0, 1, 0.5, 1}), "");
}

} // namespace
} // namespace treacle::search
