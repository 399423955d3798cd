#include "scenes.hpp"

// Impacts, ratios of masses, and orders in the step.
namespace treacle::rigid::impact_test {
namespace {

// Heights above the floor to which a body comes back.
std::vector<double> peaks_of(RigidBodies& bodies, double dt, double seconds, double at_rest) {
    std::vector<double> out;
    double last = bodies.pose(0).centre[2], before = last;
    while (bodies.time() < seconds) {
        run(bodies, dt, 1);
        const double now = bodies.pose(0).centre[2];
        if (last > before && last >= now) out.push_back(last - at_rest);
        before = last;
        last = now;
    }
    return out;
}

} // namespace

TEST(Impact, ABodyComesBackToTheHeightOfItsRestitutionAtAnyStep) {
    for (const auto& shape : {ball({0, 0, 1.1}, 0.1), box({-0.1, -0.1, 1.0}, {0.1, 0.1, 1.2})}) {
        for (const double restitution : {0.3, 0.7, 1.0}) {
            for (const double dt : {0.5e-3, 2e-3, 8e-3}) {
                auto drop = make_body(shape);
                drop.restitution = restitution;
                RigidBodies bodies(on_floor({drop}));
                const auto peaks = peaks_of(bodies, dt, 3, 0.1);
                ASSERT_GE(peaks.size(), 2u);
                double expected = 1;
                for (std::size_t k = 0; k < 2; ++k) {
                    expected *= restitution * restitution;
                    // A peak is seen to g dt^2 / 8, 1e-4 m with the longest step, and the first kick is a whole one.
                    EXPECT_NEAR(peaks[k], expected, 1e-3 * expected + 1.5 * gravity * dt * dt)
                        << restitution << ' ' << dt;
                }
            }
        }
    }
}

TEST(Impact, WithoutLossABallGainsNothingInManyImpacts) {
    for (const double dt : {1e-3, 3e-3, 8e-3}) {
        auto drop = make_body(ball({0, 0, 1.1}, 0.1));
        drop.restitution = 1;
        RigidBodies bodies(on_floor({drop}));
        const auto peaks = peaks_of(bodies, dt, 30, 0.1);
        ASSERT_GT(peaks.size(), 25u);
        for (const double peak : peaks) EXPECT_NEAR(peak, 1, 1e-3) << dt;
    }
}

TEST(Impact, WithoutRestitutionABodyStaysWhereItFalls) {
    for (const double dt : {0.5e-3, 2e-3, 8e-3}) {
        RigidBodies bodies(on_floor({make_body(ball({0, 0, 1.1}, 0.1))}));
        EXPECT_LT(peaks_of(bodies, dt, 1, 0.1).size(), 1u);
        EXPECT_NEAR(bodies.pose(0).centre[2], 0.1, 0.01 * 0.05);
        EXPECT_NEAR(bodies.velocity(0)[2], 0, 1e-9);
    }
}

TEST(Impact, UnlikeBallsKeepMomentumAndEnergy) {
    for (const double ratio : {1.0, 30.0, 1000.0}) {
        auto left = make_body(ball({0, 0, 0}, 0.1)), right = make_body(ball({0.31, 0, 0}, 0.1));
        left.velocity = {1, 0, 0};
        left.restitution = 1;
        left.mass *= ratio;
        for (auto& row : left.inertia) row = ratio * row;
        RigidBodies bodies(world({left, right}));
        run(bodies, 2e-3, 80);
        EXPECT_NEAR(bodies.velocity(0)[0], (ratio - 1) / (ratio + 1), 1e-9);
        EXPECT_NEAR(bodies.velocity(1)[0], 2 * ratio / (ratio + 1), 1e-9);
    }
}

TEST(Stack, HeavyBodiesRestOnLightOnes) {
    for (const int dimensions : {2, 3}) {
        const Tilt tilt{dimensions, 0};
        for (const double ratio : {10.0, 1000.0}) {
            for (const double friction : {0.0, 0.5}) {
                // The heaviest on top, and between light ones.
                for (const auto& order :
                    {std::vector<double>{1, ratio}, {1, 1, ratio}, {1, ratio, 1}, {ratio, 1, ratio}}) {
                    std::vector<BodySetup> boxes;
                    for (std::size_t k = 0; k < order.size(); ++k) {
                        boxes.push_back(
                            make_body(tilt.box(-0.1, 0.1, 0.2 * double(k), 0.2 * double(k + 1)), dimensions));
                        boxes.back().mass *= order[k];
                        for (auto& row : boxes.back().inertia) row = order[k] * row;
                        boxes.back().friction = friction;
                    }
                    RigidBodies bodies(on_floor(boxes, dimensions));
                    run(bodies, 2e-3, 80);
                    for (std::size_t b = 0; b < boxes.size(); ++b) {
                        const Vec3 moved = bodies.pose(b).centre - boxes[b].centre;
                        // Overlaps of 0.005 spacings are left alone, one above the other.
                        EXPECT_LT(length(moved), 0.006 * 0.05 * double(b + 1))
                            << ratio << " of " << order.size() << " friction " << friction;
                        // Without friction nothing holds them sideways, and faces that overlap that much are not level.
                        EXPECT_LT(length(bodies.velocity(b)), friction > 0 ? 1e-5 : 1e-3)
                            << ratio << " friction " << friction;
                    }
                }
            }
        }
    }
}

TEST(Stack, AHeavyBodyThatFallsOnALightOneDoesNotPressItThroughTheFloor) {
    for (const double ratio : {100.0, 1000.0}) {
        auto light = make_body(box({-0.1, -0.1, 0}, {0.1, 0.1, 0.2})),
             heavy = make_body(box({-0.1, -0.1, 0.5}, {0.1, 0.1, 0.7}));
        heavy.mass *= ratio;
        for (auto& row : heavy.inertia) row = ratio * row;
        RigidBodies bodies(on_floor({light, heavy}));
        for (int k = 0; k < 500; ++k) {
            run(bodies, 2e-3, 1);
            ASSERT_GT(bodies.pose(0).centre[2], 0.1 - 0.02 * 0.05) << ratio;
        }
        EXPECT_NEAR(bodies.pose(1).centre[2], 0.3, 0.02 * 0.05) << ratio;
    }
}

} // namespace treacle::rigid::impact_test
