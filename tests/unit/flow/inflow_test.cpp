#include "flow/outlets.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace treacle::flow {
namespace {
constexpr double spacing = 0.01; // [m]

InletSetup inlet_of(double speed, double start, double end) {
    InletSetup inlet;
    inlet.points = {{0, 0, 0}, {spacing, 0, 0}, {2 * spacing, 0, 0}};
    inlet.speed = speed;
    inlet.start = start;
    inlet.end = end;
    return inlet;
}
} // namespace

TEST(Inlets, LetInTheirFlowRateToHalfALayer) {
    const InflowSetup setup{{inlet_of(0.3, 1, 0), inlet_of(0.7, 0, 5)}, {}, 0};
    const Layers layers{spacing, 0};
    for (const double time : {0.5, 1.0, 2.345, 4.999, 77.7}) {
        const double first = 0.3 * std::max(0.0, time - 1) / spacing, second = 0.7 * std::min(time, 5.0) / spacing;
        EXPECT_NEAR(double(particles_until(setup, layers, time)), 3 * (first + second), 3 * 1.001) << time;
    }
}

TEST(Inlets, MakeALayerWhenItIsHalfASpacingPastTheOpening) {
    const auto inlet = inlet_of(0.3, 1, 0);
    const Layers layers{spacing, 0};
    for (std::int64_t layer = 0; layer < 40; ++layer) {
        const double time = inlet.start + (double(layer) + 0.5) * spacing / inlet.speed; // its place is 0
        EXPECT_NEAR(layer_position(inlet, layers, layer, time), 0, 1e-15);
        EXPECT_EQ(layers_until(inlet, layers, time - 1e-6), layer);
        EXPECT_EQ(layers_until(inlet, layers, time + 1e-6), layer + 1);
    }
}

TEST(Outlets, TakeWhatIsInABoxOrBehindAPlane) {
    const auto outlets =
        make_outlets({{true, {0, 0, 0}, {1, 1, 1}, {}, {}}, {false, {}, {}, {5, 0, 0}, {-1, 0, 0}}}, 3);
    const auto takes = [&](double x, double y, double z) {
        const double position[3] = {x, y, z};
        return outlets.take(position);
    };
    EXPECT_TRUE(takes(0.5, 0.5, 0.5));
    EXPECT_FALSE(takes(0.5, 1.1, 0.5));
    EXPECT_TRUE(takes(5.1, 0, 0));
    EXPECT_FALSE(takes(4.9, 0, 0));
    EXPECT_FALSE(make_outlets({}, 3).take(std::array{0.0, 0.0, 0.0}.data()));
}

} // namespace treacle::flow
