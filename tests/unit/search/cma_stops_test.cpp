#include "search/cma_es/cma_es.hpp"

#include "functions.hpp"

#include <gtest/gtest.h>

namespace treacle::search {
namespace {

std::string stop_of(std::vector<Axis> given, const Function& f, CmaOptions options = {}) {
    options.limits.evaluations = std::min<std::int64_t>(options.limits.evaluations, 20000);
    CmaEs search(std::move(given), options);
    minimise(search, f);
    EXPECT_FALSE(search.stopped()->text.empty());
    return search.stopped()->name;
}

TEST(CmaStops, NameTheirReason) {
    auto coarse = axes(2, 1, 1);
    for (Axis& axis : coarse) axis.tolerance = 0.01;
    EXPECT_EQ(stop_of(coarse, sphere), "tolx");
    EXPECT_EQ(stop_of(axes(2, 1, 1), sphere), "tolfun");
    EXPECT_EQ(stop_of(axes(2, 1, 1), [](const Point&) { return 3.0; }), "tolfunhist");
    EXPECT_EQ(stop_of(axes(2, 1, 1), [](const Point& x) { return x[0] + x[1]; }), "growth");
    CmaOptions exact;
    exact.tolerances.value = exact.tolerances.value_history = 0;
    EXPECT_EQ(stop_of(
                  axes(2, 1, 1), [](const Point& x) { return x[0] * x[0] + 1e16 * x[1] * x[1]; }, exact),
        "condition");
    EXPECT_EQ(stop_of(axes(2, 1e6, 1), [](const Point& x) { return sphere({x[0] - 1e6, x[1] - 1e6}); }), "tolfun");
    exact.limits.generations = 7;
    EXPECT_EQ(stop_of(axes(2, 1, 1), sphere, exact), "generations");
}

TEST(CmaStops, NoticeThatRoundOffIsReached) {
    auto off = axes(2, 0, 1);
    off[0].tolerance = off[1].tolerance = 1e-300;
    CmaOptions exact;
    exact.tolerances.value = exact.tolerances.value_history = 0;
    const auto name = stop_of(
        off,
        [](const Point& x) {
            return sphere({x[0] - 3, x[1] - 3});
        },
        exact);
    EXPECT_TRUE(name == "noeffectaxis" || name == "noeffectcoord") << name;
}

TEST(CmaStops, NoticeThatNoiseHasTheUpperHand) {
    const Random noise(5);
    std::uint32_t k = 0;
    EXPECT_EQ(
        stop_of(axes(2, 1, 1), [&](const Point&) { return noise.normal(Purpose::model, 0, k++, 0); }), "stagnation");
}

} // namespace
} // namespace treacle::search
