#include "shapes.hpp"

#include "base/text/error.hpp"
#include "scene/sampling/sampling.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <set>

using namespace treacle;
using namespace treacle::scene;
using namespace treacle::scene::testing;

namespace {

VolumeFill fill_of(const std::vector<Shape>& liquid, const Vec3& max, double spacing, int dimensions = 3) {
    VolumeFill fill;
    fill.liquids.emplace_back();
    for (const Shape& s : liquid) fill.liquids.back().emplace_back(s, dimensions);
    fill.lattice = {spacing, {0, 0, 0}, max, dimensions};
    return fill;
}

// Cuts a box into n parts at places that are no multiples of the spacing, and some that are.
std::vector<Bounds> cut(const Bounds& box, int n, double spacing) {
    std::vector<Bounds> parts{box};
    for (int i = 1; int(parts.size()) < n; ++i) {
        Bounds& old = parts[std::size_t(i * 7) % parts.size()];
        Bounds other = old;
        const int axis = i % 3;
        double plane = old.min[axis] + 0.37 * (old.max[axis] - old.min[axis]);
        if (i % 2 == 0) plane = (std::floor(plane / spacing) + 0.5) * spacing; // exactly on lattice points
        if (plane <= old.min[axis] || plane >= old.max[axis]) continue;
        old.max[axis] = other.min[axis] = plane;
        parts.push_back(other);
    }
    return parts;
}

} // namespace

TEST(VolumeSampling, ABoxOfNSpacingsHasExactlyNLayersWhateverItsRoundOff) {
    const double d = 0.1; // 0.3 = 3 d and 0.7 = 7 d only up to round-off
    for (const double shift : {0.0, 0.5, 1.0, 2.5}) {
        const Vec3 low{shift * d, shift * d, shift * d};
        const auto samples = fill_volume(fill_of({box(low, plus(low, 1, {0.3, 0.7, 0.4}))}, {1, 1, 1}, d));
        EXPECT_EQ(samples.positions.size(), 3u * 7u * 4u) << shift;
    }
}

TEST(VolumeSampling, TheWholeDomainHasItsLatticePoints) {
    const auto samples = fill_volume(fill_of({box({0, 0, 0}, {0.3, 0.6, 0.9})}, {0.3, 0.6, 0.9}, 0.1));
    ASSERT_EQ(samples.positions.size(), 3u * 6u * 9u);
    for (std::size_t i = 0; i < samples.ids.size(); ++i) EXPECT_EQ(samples.ids[i], i);
    EXPECT_EQ(samples.positions[0], (Vec3{0.05, 0.05, 0.05}));
}

TEST(VolumeSampling, PlaneScenesHaveOneLayerAtZeroHeight) {
    const auto samples = fill_volume(fill_of({box({0, 0, 0}, {0.4, 0.2, 0})}, {1, 1, 0}, 0.1, 2));
    ASSERT_EQ(samples.positions.size(), 8u);
    for (const Vec3& x : samples.positions) EXPECT_EQ(x[2], 0);
}

TEST(VolumeSampling, ASphereOfTenSpacingsHasItsVolume) {
    const double d = 0.1;
    const auto samples = fill_volume(fill_of({round(ShapeKind::sphere, {1.5, 1.5, 1.5}, 1)}, {3, 3, 3}, d));
    const double volume = double(samples.positions.size()) * d * d * d;
    EXPECT_NEAR(volume / (4 * std::numbers::pi / 3), 1, 0.02); // lattice points in a ball, R = 10 d
}

TEST(VolumeSampling, ParticlesKeepClearOfSolids) {
    auto fill = fill_of({box({0, 0, 0}, {1, 1, 1})}, {1, 1, 1}, 0.05);
    const SolidRegion ball(round(ShapeKind::sphere, {0.5, 0.5, 0.5}, 0.2));
    fill.solids.push_back(ball);
    fill.clearance = 0.03;
    const auto samples = fill_volume(fill);
    std::size_t expected = 0;
    for (int i = 0; i < 8000; ++i) {
        const Vec3 x = fill.lattice.position({i % 20, i / 20 % 20, i / 400});
        expected += ball.distance(x) >= 0.03;
    }
    EXPECT_EQ(samples.positions.size(), expected);
    for (const Vec3& x : samples.positions) EXPECT_GE(ball.distance(x), 0.03 - 1e-7);
}

TEST(VolumeSampling, TheFirstOfOverlappingLiquidsWinsAndIdsAreUnique) {
    auto fill = fill_of({box({0, 0, 0}, {0.6, 1, 1})}, {1, 1, 1}, 0.1);
    fill.liquids.push_back({SolidRegion(box({0.4, 0, 0}, {1, 1, 1}))});
    const auto samples = fill_volume(fill);
    EXPECT_EQ(samples.positions.size(), 1000u);
    EXPECT_EQ(std::count(samples.liquids.begin(), samples.liquids.end(), 0), 600);
    const std::set<std::uint64_t> unique(samples.ids.begin(), samples.ids.end());
    EXPECT_EQ(unique.size(), 1000u);
    for (std::size_t i = 0; i < samples.ids.size(); ++i)
        EXPECT_EQ(samples.ids[i] / 1000, std::uint64_t(samples.liquids[i]));
}

TEST(VolumeSampling, AnyCutOfTheDomainGivesTheSameParticlesBitForBit) {
    const MeshFile mesh("sphere.obj", sphere_mesh(3));
    Shape ball = mesh_shape(mesh.path());
    ball.scale = 0.3;
    ball.translation = {0.45, 0.4, 0.5};
    const double d = 0.021;
    auto fill = fill_of(
        {ball, round(ShapeKind::torus, {0.5, 0.5, 0.6}, 0.3, 0, 0.1), box({0, 0, 0}, {1, 0.2, 0.3})}, {1, 1, 1}, d);
    fill.liquids.push_back({SolidRegion(box({0.1, 0.1, 0.1}, {0.9, 0.4, 0.9}))});
    fill.solids.emplace_back(round(ShapeKind::sphere, {0.6, 0.3, 0.4}, 0.12));
    struct Choice {
        double clearance;
        Filling filling;
    };
    for (const auto [clearance, filling] :
        {Choice{0.5 * d, Filling::points}, Choice{0, Filling::points}, Choice{0, Filling::room}}) {
        fill.clearance = clearance;
        fill.filling = filling;
        fill.part = {};
        const auto whole = fill_volume(fill);
        std::map<std::uint64_t, Vec3> expected;
        for (std::size_t i = 0; i < whole.ids.size(); ++i) expected[whole.ids[i]] = whole.positions[i];
        ASSERT_EQ(expected.size(), whole.ids.size());
        for (const int n : {2, 3, 8, 31}) {
            std::map<std::uint64_t, Vec3> together;
            std::size_t count = 0;
            double room = 0;
            for (const Bounds& part : cut({{0, 0, 0}, {1, 1, 1}}, n, d)) {
                fill.part = part;
                const auto samples = fill_volume(fill);
                count += samples.ids.size();
                room += samples.room;
                for (std::size_t i = 0; i < samples.ids.size(); ++i) together[samples.ids[i]] = samples.positions[i];
            }
            EXPECT_EQ(count, expected.size());
            EXPECT_EQ(together, expected);
            EXPECT_NEAR(room, whole.room, 1e-9 * whole.room);
        }
    }
}

namespace {
// Liquid between plates at two heights, of 40 x 40 points across.
VolumeFill between(double low, double high, double d) {
    auto fill = fill_of({box({0, 0, 0}, {40 * d, 40 * d, 40 * d})}, {40 * d, 40 * d, 40 * d}, d);
    fill.solids.emplace_back(box({-d, -d, -d}, {41 * d, 41 * d, low}));
    fill.solids.emplace_back(box({-d, -d, high}, {41 * d, 41 * d, 41 * d}));
    return fill;
}
} // namespace

TEST(VolumeSampling, PlatesAWholeNumberOfSpacingsApartHoldAsManyLayersWhereverTheyAre) {
    const double d = 0.025;
    for (const double offset : {0.0, 0.1, 0.25, 0.5, 0.75, 0.99}) {
        const auto samples = fill_volume(between((3 + offset) * d, (23 + offset) * d, d));
        EXPECT_EQ(samples.positions.size(), 20u * 40 * 40) << offset;
        EXPECT_NEAR(samples.room, 20 * 40 * 40, 1) << offset;
    }
}

TEST(VolumeSampling, RoomIsFilledToItsVolumeAndNoPointStaysInASolid) {
    const double d = 0.025;
    for (const double height : {19.3, 19.5, 19.9}) {
        for (const double offset : {0.0, 0.3, 0.7}) {
            auto fill = between((3 + offset) * d, (3 + offset + height) * d, d);
            fill.filling = Filling::room;
            const auto samples = fill_volume(fill);
            EXPECT_NEAR(samples.room, height * 40 * 40, 1) << offset;
            EXPECT_NEAR(double(samples.positions.size()) / samples.room, 1, 1e-3) << height << " at " << offset;
            for (const Vec3& x : samples.positions) EXPECT_GE(distance_to(fill.solids, x), 0.25 * d - 1e-6 * d);
        }
    }
}

TEST(VolumeSampling, AnInvertedShapeFillsTheRestOfTheDomain) {
    Shape ball = round(ShapeKind::sphere, {0.5, 0.5, 0.5}, 0.3);
    const auto inside = fill_volume(fill_of({ball}, {1, 1, 1}, 0.05)).ids.size();
    ball.inverted = true;
    const auto outside = fill_volume(fill_of({ball}, {1, 1, 1}, 0.05)).ids.size();
    EXPECT_EQ(inside + outside, 8000u);
}

TEST(VolumeSampling, EstimatesEqualTheCountsOfSmallScenesAndComeCloseForLargeOnes) {
    const Shape ball = round(ShapeKind::sphere, {0.5, 0.5, 0.5}, 0.4);
    const auto small = fill_of({ball}, {1, 1, 1}, 0.02);
    EXPECT_EQ(estimate_liquid_counts(small)[0], fill_volume(small).ids.size());
    const auto large = fill_of({ball}, {1, 1, 1}, 1e-4); // 2.7e11 particles, not made
    EXPECT_NEAR(double(estimate_liquid_counts(large)[0]) * 1e-12, 4 * std::numbers::pi / 3 * 0.064, 0.003);
}

TEST(VolumeSampling, OverlapWithASolidIsCountedWithAnExample) {
    const Regions liquid{SolidRegion(box({0, 0, 0}, {1, 0.5, 1}))};
    const Lattice lattice{0.05, {0, 0, 0}, {1, 1, 1}, 3};
    const Regions touching{SolidRegion(box({0, 0.5, 0}, {1, 1, 1}))};
    EXPECT_EQ(find_overlap(liquid, touching, lattice).count, 0u);
    const Regions sunk{SolidRegion(box({0.2, 0.3, 0.2}, {0.6, 0.9, 0.6}))};
    const Overlap overlap = find_overlap(liquid, sunk, lattice);
    EXPECT_EQ(overlap.count, 8u * 4u * 8u);
    EXPECT_EQ(overlap.total, 4000u);
    EXPECT_LT(sunk[0].distance(overlap.example), 0);
    EXPECT_LT(liquid[0].distance(overlap.example), 0);
    EXPECT_EQ(find_overlap(liquid, {}, lattice).count, 0u);
}

TEST(VolumeSampling, LiquidOutsideTheDomainIsCountedWithAnExample) {
    const Lattice lattice{0.1, {0, 0, 0}, {1, 1, 1}, 3};
    EXPECT_EQ(find_outside({SolidRegion(box({0, 0, 0}, {1, 1, 1}))}, lattice).count, 0u);
    const Overlap high = find_outside({SolidRegion(box({0, 0, 0.5}, {1, 1, 1.2}))}, lattice);
    EXPECT_EQ(high.count, 200u);
    EXPECT_EQ(high.total, 700u);
    EXPECT_GT(high.example[2], 1);
    const Overlap low = find_outside({SolidRegion(box({-0.3, 0, 0}, {1, 1, 1}))}, lattice);
    EXPECT_EQ(low.count, 300u);
    EXPECT_LT(low.example[0], 0);
    Shape everything = round(ShapeKind::sphere, {0.5, 0.5, 0.5}, 0.2);
    everything.inverted = true;
    EXPECT_EQ(find_outside({SolidRegion(everything)}, lattice).count, 0u);
}

TEST(VolumeSampling, InADomainThatIsNoMultipleOfTheSpacingNoParticleIsCloseToTheFarSide) {
    for (const double spacing : {0.0074, 0.0076, 0.0079, 0.0083, 0.3 / 40.01, 0.3 / 39.99}) {
        const Lattice lattice{spacing, {0, 0, 0}, {0.3, 0.3, 0.3}, 3};
        const Regions liquid{SolidRegion(box({0, 0, 0}, {0.3, 0.3, 0.3}))};
        const auto samples = fill_volume({{liquid}, {}, 0, lattice, {}});
        double last = 0;
        for (const Vec3& x : samples.positions) last = std::max({last, x[0], x[1], x[2]});
        // 0.02 spacings raise the density next to a wall by 0.8 %.
        EXPECT_LE(last, 0.3 - 0.48 * spacing) << spacing;
        EXPECT_GT(last, 0.3 - 1.48 * spacing) << spacing;
        EXPECT_EQ(find_outside(liquid, lattice).count, 0u) << "what has no room is not outside of the domain";
    }
}

TEST(VolumeSampling, ALiquidAThousandTimesTooLargeIsFoundOutAtOnce) {
    const Lattice lattice{0.001, {0, 0, 0}, {1, 1, 1}, 3}; // millimetres taken for metres
    const Overlap overlap = find_outside({SolidRegion(round(ShapeKind::sphere, {0, 0, 0}, 1000))}, lattice);
    EXPECT_GT(overlap.fraction(), 0.99);
}

TEST(VolumeSampling, TheShareOfSolidsIsTheirVolume) {
    const Lattice lattice{0.02, {0, 0, 0}, {1, 1, 1}, 3};
    const double fraction = solid_fraction({SolidRegion(round(ShapeKind::sphere, {0.5, 0.5, 0.5}, 0.3))}, lattice);
    EXPECT_NEAR(fraction / (4 * std::numbers::pi / 3 * 0.027), 1, 0.02); // lattice points in a ball, R = 15 d
}

TEST(VolumeSampling, ALatticeTooLargeToNumberIsRefused) {
    const Lattice lattice{1e-8, {0, 0, 0}, {1, 1, 1}, 3};
    EXPECT_THROW(lattice.points(), InputError);
}

TEST(VolumeSampling, MillionsOfPointsTakeAboutASecond) {
    const double d = 1.0 / 150;
    const Stopwatch watch;
    const auto samples = fill_volume(fill_of({box({0, 0, 0}, {1, 1, 1})}, {1, 1, 1}, d));
    const double taken = watch.seconds();
    EXPECT_EQ(samples.ids.size(), 3375000u);
    EXPECT_LT(taken, 1.0); // measured 0.1 s
    std::printf("%.2f s\n", taken);
}
