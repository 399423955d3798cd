#include "shapes.hpp"

#include <gtest/gtest.h>

namespace treacle::surface {
namespace {

using namespace test;

Options options() {
    Options out;
    out.spacing = 1;
    return out;
}

struct Made {
    Mesh mesh;
    Summary summary;
};
Made make(const Cloud& cloud, const Domain& domain = {}, const Options& chosen = options(), const Solids& solids = {}) {
    const auto comm = Comm::world();
    Mesher mesher(comm, domain, chosen);
    const auto part = cloud.part(comm);
    Made out;
    out.mesh = mesher.build(part.rows(), solids);
    out.summary = mesher.summary();
    return out;
}

Shape ball(double radius, const Vec3& at = {0, 0, 0}) {
    return [=](const Vec3& x) { return std::hypot(x[0] - at[0], x[1] - at[1], x[2] - at[2]) < radius; };
}

TEST(Surface, OfABallHasItsVolumeAndIsClosed) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    for (const double radius : {3.0, 5.0, 9.0}) {
        for (int repeat = 0; repeat < 3; ++repeat) {
            const auto turn = random_rotation(random);
            const auto cloud = fill(ball(radius), static_cast<int>(radius + 2), {uniform(random), uniform(random), uniform(random)}, 0, &turn);
            const auto made = make(cloud);
            std::printf("R %.0f: volume %+.4f\n", radius, made.summary.volume / cloud.count() - 1);
            EXPECT_NEAR(made.summary.volume / cloud.count(), 1, 0.01) << radius;
            EXPECT_EQ(made.summary.components, 1);
            EXPECT_TRUE(closed(Comm::world(), made.mesh));
            const auto centre = centroid(Comm::world(), made.mesh), expected = cloud.centre();
            for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(centre[k], expected[k], 0.02);
        }
    }
}

} // namespace
} // namespace treacle::surface
