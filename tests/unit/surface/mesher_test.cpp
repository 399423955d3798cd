#include "base/text/error.hpp"
#include "shapes.hpp"

#include <gtest/gtest.h>

namespace treacle::surface::mesher_test {
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

// Farthest of the vertices' values from what is expected, over all ranks.
template <class Value>
double worst(const Mesh& mesh, const Value& value) {
    double out = 0;
    for (std::int64_t v = 0; v < mesh.size(); ++v) {
        const auto* x = mesh.vertices.data() + 3 * v;
        out = std::max(out, value(Vec3{x[0], x[1], x[2]}, static_cast<std::size_t>(v)));
    }
    return Comm::world().max(out);
}

TEST(Surface, OfABallHasItsVolumeAndIsClosed) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    for (const double radius : {3.0, 5.0, 9.0}) {
        const auto turn = random_rotation(random);
        const auto cloud = fill(
            ball(radius), static_cast<int>(radius + 2), {uniform(random), uniform(random), uniform(random)}, 0, &turn);
        const auto made = make(cloud);
        EXPECT_NEAR(made.summary.volume / cloud.count(), 1, 0.01) << radius;
        EXPECT_EQ(made.summary.components, 1);
        EXPECT_TRUE(closed(Comm::world(), made.mesh));
        const auto centre = centroid(Comm::world(), made.mesh), expected = cloud.centre();
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(centre[k], expected[k], 0.02);
    }
}

TEST(Surface, OfTwoBallsThatTouchHasTheirVolume) {
    for (const double radius : {3.0, 6.0}) {
        const Vec3 left{-radius, 0, 0}, right{radius, 0, 0};
        const auto cloud = fill([&](const Vec3& x) { return ball(radius, left)(x) || ball(radius, right)(x); },
            static_cast<int>(2 * radius + 2), {0.3, 0.2, 0.4});
        const auto made = make(cloud);
        EXPECT_NEAR(made.summary.volume / cloud.count(), 1, 0.01) << radius;
        EXPECT_TRUE(closed(Comm::world(), made.mesh));
    }
}

TEST(Surface, OfADiscInThePlaneIsAClosedLine) {
    Domain plane;
    plane.dimensions = 2;
    for (const double radius : {3.0, 8.0}) {
        const auto cloud = fill(ball(radius), static_cast<int>(radius + 2), {0.1, 0.4, 0}, 0, nullptr, 2);
        const auto made = make(cloud, plane);
        EXPECT_NEAR(made.summary.volume / cloud.count(), 1, 0.01) << radius;
        EXPECT_EQ(made.summary.components, 1);
        EXPECT_TRUE(closed(Comm::world(), made.mesh));
        EXPECT_NEAR(made.summary.area, 2 * math::pi * std::sqrt(cloud.count() / math::pi), 0.05 * made.summary.area)
            << "steps of the particles' lattice make it longer";
    }
}

TEST(Surface, OfASheetOneParticleThickAndAThreadOfTwoIsWhole) {
    std::mt19937 random(5);
    const auto turn = random_rotation(random);
    const auto sheet = fill([](const Vec3& x) { return x[2] == 0; }, 12, {0, 0, 0}, 0, &turn);
    const auto flat = make(sheet);
    EXPECT_EQ(flat.summary.components, 1);
    EXPECT_NEAR(flat.summary.volume / sheet.count(), 1, 0.1);
    EXPECT_TRUE(closed(Comm::world(), flat.mesh));
    const auto thread =
        fill([](const Vec3& x) { return x[0] >= 0 && x[0] < 2 && x[1] >= 0 && x[1] < 2; }, 20, {0, 0, 0}, 0, &turn);
    const auto round = make(thread);
    EXPECT_EQ(round.summary.components, 1);
    EXPECT_NEAR(round.summary.volume / thread.count(), 1, 0.1);
}

Domain box(const Vec3& min, const Vec3& max, Side side = Side::wall) {
    Domain out;
    out.min = min;
    out.max = max;
    out.sides.fill(side);
    return out;
}

// A block on the floor of a box, against three of its walls; the lattice of particles touches none of the box's lattice.
TEST(Surface, OfABlockLiesOnFloorAndWalls) {
    const auto cloud =
        fill([](const Vec3& x) { return x[0] > 0 && x[0] < 6 && x[1] > 0 && x[1] < 9 && x[2] > 0 && x[2] < 5; }, 10,
            {0.5, 0.5, 0.5});
    const auto made = make(cloud, box({0, 0, 0}, {15.3, 9, 12}));
    EXPECT_EQ(made.summary.components, 1);
    EXPECT_TRUE(closed(Comm::world(), made.mesh));
    EXPECT_NEAR(made.summary.volume / cloud.count(), 1, 0.01);
    // Away from the rounded rim of the block's own edges, the front, the top, and the faces on walls are where they should be.
    double touching[3] = {0, 0, 0};
    const double off = worst(made.mesh, [&](const Vec3& x, std::size_t) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_GE(x[k], 0) << k;
            touching[k] = std::max(touching[k], x[k] == 0 ? 1.0 : 0.0);
        }
        EXPECT_LE(x[1], 9);
        const bool wall = x[0] == 0 || x[1] == 0 || x[1] == 9 || x[2] == 0;
        const bool front = x[0] > 5 && x[2]<3.5, top = x[2]> 4 && x[0] < 4.5;
        return wall ? 0 : front ? std::abs(x[0] - 6) : top ? std::abs(x[2] - 5) : 0;
    });
    EXPECT_LT(off, 0.1);
    RecordProperty("block_off_spacings", std::to_string(off));
    for (double& t : touching) t = Comm::world().max(t);
    EXPECT_EQ(touching[0] + touching[1] + touching[2], 3);
}

TEST(Surface, OfALayerAtRestIsFlat) {
    for (const double jitter : {0.0, 0.1}) {
        const auto cloud =
            fill([](const Vec3& x) { return x[0] > 0 && x[0] < 12 && x[1] > 0 && x[1] < 12 && x[2] > 0 && x[2] < 6; },
                13, {0.5, 0.5, 0.5}, jitter);
        const auto made = make(cloud, box({0, 0, 0}, {12, 12, 12}));
        const double off = worst(made.mesh, [&](const Vec3& x, std::size_t) {
            return x[2] > 4.5 && x[0] > 0.1 && x[0] < 11.9 && x[1] > 0.1 && x[1] < 11.9 ? std::abs(x[2] - 6) : 0;
        });
        EXPECT_LT(off, jitter == 0 ? 0.02 : 0.35);
        RecordProperty(jitter == 0 ? "layer_off_spacings" : "disordered_layer_off_spacings", std::to_string(off));
        RecordProperty(jitter == 0 ? "layer_mean_height_off" : "disordered_layer_mean_height_off",
            std::to_string(made.summary.volume / 144 - 6));
        EXPECT_NEAR(made.summary.volume, 12 * 12 * 6, 12 * 12 * (jitter == 0 ? 0.01 : 0.03));
    }
}

TEST(Surface, LiesOnSolidsThatTheLiquidTouches) {
    scene::Shape shape;
    shape.kind = scene::ShapeKind::sphere;
    shape.centre = {0, 0, 0};
    shape.radius = 5;
    Solids solids;
    solids.bodies.push_back({scene::SolidRegion(shape)});
    const auto cloud = fill(
        [](const Vec3& x) {
            const double r = std::hypot(x[0], x[1], x[2]);
            return r > 5 && r < 9;
        },
        11, {0.2, 0.3, 0.4});
    const auto made = make(cloud, {}, options(), solids);
    EXPECT_TRUE(closed(Comm::world(), made.mesh));
    EXPECT_EQ(made.summary.components, 2);
    const double off = worst(made.mesh, [&](const Vec3& x, std::size_t) {
        const double r = std::hypot(x[0], x[1], x[2]);
        return r < 6.5 ? std::abs(r - 5) : 0;
    });
    EXPECT_LT(off, 0.03);
}

TEST(Surface, OfAPeriodicLiquidEndsOnTheFacesOfThePeriod) {
    auto domain = box({0, 0, 0}, {10, 9, 20});
    domain.sides[0] = domain.sides[1] = Side::periodic;
    const auto cloud =
        fill([](const Vec3& x) { return x[0] > 0 && x[0] < 10 && x[1] > 0 && x[1] < 9 && x[2] > 0 && x[2] < 5; }, 12,
            {0.5, 0.5, 0.5});
    const auto made = make(cloud, domain);
    EXPECT_TRUE(closed(Comm::world(), made.mesh));
    EXPECT_NEAR(made.summary.volume / cloud.count(), 1, 0.002);
    EXPECT_NEAR(made.summary.area, 2 * (10 * 9 + 10 * 5 + 9 * 5), 3);
}

TEST(Surface, DropsSmallPiecesAndCountsThem) {
    auto cloud = fill(ball(4), 6, {0, 0, 0});
    cloud.add({9, 0, 0});
    cloud.add({9, 9, 0});
    cloud.add({9.9, 9, 0});
    auto chosen = options();
    const auto all = make(cloud, {}, chosen);
    chosen.min_volume = 3;
    const auto without = make(cloud, {}, chosen);
    EXPECT_EQ(without.summary.components, 1);
    EXPECT_EQ(without.summary.components + without.summary.dropped, all.summary.components + all.summary.dropped);
    EXPECT_GE(without.summary.dropped, 1);
    EXPECT_NEAR(
        without.summary.volume + without.summary.dropped_volume, all.summary.volume + all.summary.dropped_volume, 1e-9);
    EXPECT_TRUE(closed(Comm::world(), without.mesh));
}

TEST(Surface, CarriesTheFieldsOfItsParticles) {
    const auto cloud = fill(ball(6), 8, {0.2, 0.1, 0.3});
    const auto made = make(cloud);
    const double off = worst(made.mesh, [&](const Vec3& x, std::size_t v) {
        const double u[3] = {1 + x[0], 2 - x[1], 0.5 * x[2]};
        double out = std::abs(made.mesh.pressure[v] - (x[0] + 2 * x[1] - x[2])) / 3;
        for (std::size_t k = 0; k < 3; ++k) out = std::max(out, std::abs(made.mesh.velocity[3 * v + k] - u[k]));
        EXPECT_TRUE(std::abs(x[0]) <= 1.5 || made.mesh.liquid[v] == (x[0] > 0 ? 1 : 0));
        double along = 0; // normals point outwards
        for (std::size_t k = 0; k < 3; ++k) along += made.mesh.normals[3 * v + k] * x[k];
        EXPECT_GT(along, 4);
        return out;
    });
    EXPECT_LT(off, 1.2); // means over particles of one side: a spacing or so off
}

// The mesh of one rank alone, vertex by vertex.
TEST(Surface, DoesNotDependOnTheRanks) {
    const auto world = Comm::world();
    auto cloud =
        fill([](const Vec3& x) { return ball(6)(x) || (x[2] > -10 && x[2] < -8); }, 14, {0.21, 0.13, 0.37}, 0.2);
    auto domain = box({-14, -14, -10}, {14, 14, 10});
    domain.sides[0] = domain.sides[1] = Side::periodic;
    domain.sides[5] = Side::open;
    scene::Shape post;
    post.min = {3, -3, -10};
    post.max = {5, 2, -7};
    Solids solids;
    solids.bodies.push_back({scene::SolidRegion(post)});
    const auto made = make(cloud, domain, options(), solids);
    EXPECT_TRUE(closed(world, made.mesh));
    Mesher alone(Comm::self(), domain, options());
    const auto& whole = alone.build(cloud.rows(), solids);
    EXPECT_EQ(made.mesh.total_vertices, whole.total_vertices);
    EXPECT_EQ(made.mesh.total_triangles, whole.total_triangles);
    EXPECT_EQ(made.summary.volume, alone.summary().volume);
    EXPECT_EQ(made.summary.components, alone.summary().components);
    std::map<std::int64_t, std::size_t> rows;
    for (std::size_t v = 0; v < whole.key.size(); ++v) rows[whole.key[v]] = v;
    std::map<std::array<std::int64_t, 3>, int> triangles;
    for (const auto& t : whole.triangles)
        ++triangles[{whole.key[static_cast<std::size_t>(t[0])], whole.key[static_cast<std::size_t>(t[1])],
            whole.key[static_cast<std::size_t>(t[2])]}];
    for (const auto& t : made.mesh.triangles) {
        const std::array<std::int64_t, 3> keys{made.mesh.key[static_cast<std::size_t>(t[0])],
            made.mesh.key[static_cast<std::size_t>(t[1])], made.mesh.key[static_cast<std::size_t>(t[2])]};
        EXPECT_EQ(triangles.count(keys), 1u);
    }
    EXPECT_EQ(worst(made.mesh,
                  [&](const Vec3& x, std::size_t v) {
                      const auto row = rows.at(made.mesh.key[v]);
                      double out = std::abs(made.mesh.pressure[v] - whole.pressure[row]);
                      for (std::size_t k = 0; k < 3; ++k) {
                          out = std::max(out, std::abs(x[k] - whole.vertices[3 * row + k]));
                          out = std::max(out, std::abs(made.mesh.normals[3 * v + k] - whole.normals[3 * row + k]));
                          out = std::max(out, std::abs(made.mesh.velocity[3 * v + k] - whole.velocity[3 * row + k]));
                      }
                      return out;
                  }),
        0);
}

TEST(Surface, OfNoParticlesIsEmptyAndOfBadOnesAnError) {
    EXPECT_EQ(make(Cloud()).mesh.total_triangles, 0);
    Cloud bad;
    bad.add({0, 0, std::nan("")});
    EXPECT_THROW(make(bad), InputError);
    auto chosen = options();
    chosen.lattice_step = 2;
    EXPECT_THROW(make(Cloud(), {}, chosen), InputError);
}

} // namespace
} // namespace treacle::surface::mesher_test
