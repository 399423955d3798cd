#include "../kokkos/points.hpp"
#include "mpi/migration.hpp"

#include <cstring>
#include <gtest/gtest.h>

namespace treacle::migration_test {
namespace {

std::uint64_t scramble(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}
std::uint64_t bits(double value) {
    std::uint64_t out;
    std::memcpy(&out, &value, sizeof out);
    return out;
}

// Fields whose values follow from the id, so that any rank can check them. The wide integers take all bit
// patterns, among them those that as doubles would be signalling NaNs.
struct Sample {
    ParticleStore store;
    int number = store.add<Array<double>>("number", "", FieldRole::state);
    int work = store.add<Array<double>>("work", "", FieldRole::work);
    int triple = store.add<Array3>("triple", "", FieldRole::state);
    int wide = store.add<Array<std::int64_t>>("wide", "", FieldRole::state);
    int small = store.add<Array<int>>("small", "", FieldRole::state);

    static double number_of(std::int64_t id) { return 1.0 / double(id + 3); }
    static std::int64_t wide_of(std::int64_t id) {
        const auto h = static_cast<std::int64_t>(scramble(static_cast<std::uint64_t>(id)));
        return id % 3 == 0 ? (h & 0x0007ffffffffffff) | 0x7ff0000000000001 : h;
    }
    static int small_of(std::int64_t id) { return static_cast<int>(id % 5) - 7; }

    void fill(const std::vector<test::Point>& points) {
        test::fill(store, points);
        const auto set = [&](auto view, auto value) {
            test::edit(view, [&](auto& v) {
                for (std::size_t i = 0; i < points.size(); ++i) value(v, i, points[i].id);
            });
        };
        set(store.get<Array<double>>(number), [](auto& v, auto i, auto id) { v(i) = number_of(id); });
        set(store.get<Array3>(triple), [](auto& v, auto i, auto id) {
            for (int k = 0; k < 3; ++k) v(i, k) = (k - 1.0) / double(id + 1); // the middle one of odd ids is -0
            if (id % 2) v(i, 1) = -0.0;
        });
        set(store.get<Array<std::int64_t>>(wide), [](auto& v, auto i, auto id) { v(i) = wide_of(id); });
        set(store.get<Array<int>>(small), [](auto& v, auto i, auto id) { v(i) = small_of(id); });
    }

    void expect_values() const {
        const auto points = test::read(store, 0, store.owned());
        const auto d = test::on_host(store.get<Array<double>>(number));
        const auto t = test::on_host(store.get<Array3>(triple));
        const auto w = test::on_host(store.get<Array<std::int64_t>>(wide));
        const auto s = test::on_host(store.get<Array<int>>(small));
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto id = points[i].id;
            ASSERT_EQ(bits(d(i)), bits(number_of(id)));
            ASSERT_EQ(bits(t(i, 0)), bits(-1.0 / double(id + 1)));
            ASSERT_EQ(bits(t(i, 1)), bits(id % 2 ? -0.0 : 0.0));
            ASSERT_EQ(bits(t(i, 2)), bits(1.0 / double(id + 1)));
            ASSERT_EQ(w(i), wide_of(id));
            ASSERT_EQ(s(i), small_of(id));
        }
    }
};

std::vector<test::Point> everyones(const Comm& comm, const ParticleStore& store) {
    std::vector<double> values;
    std::vector<std::int64_t> ids;
    for (const auto& point : test::read(store, 0, store.owned())) {
        ids.push_back(point.id);
        values.insert(values.end(), point.x.begin(), point.x.end());
    }
    ids = comm.all_gather(std::span<const std::int64_t>(ids));
    values = comm.all_gather(std::span<const double>(values));
    std::vector<test::Point> points;
    for (std::size_t k = 0; k < ids.size(); ++k) {
        points.push_back({ids[k], {values[3 * k], values[3 * k + 1], values[3 * k + 2]}});
    }
    std::sort(points.begin(), points.end());
    return points;
}

void expect_in_box(const ParticleStore& store, const Decomposition& decomposition) {
    for (const auto& point : test::read(store, 0, store.owned())) {
        ASSERT_TRUE(decomposition.box().contains(test::cell_of(decomposition.grid(), point).data()));
    }
}

} // namespace

TEST(Migration, LosesNothingAndCarriesEveryStateFieldBitForBit) {
    const auto comm = Comm::world();
    const auto grid = test::make_grid(3, {9, 7, 5});
    const Decomposition decomposition(comm, grid);
    auto all = test::random_points(grid, 1500, 1);
    std::vector<test::Point> mine;
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (static_cast<int>(k) % comm.size() == comm.rank()) mine.push_back(all[k]);
    }
    Sample sample;
    sample.fill(mine);
    std::int64_t elsewhere = 0;
    for (const auto& point : mine) {
        elsewhere += static_cast<int>(!decomposition.box().contains(test::cell_of(grid, point).data()));
    }
    Migration migration;
    EXPECT_EQ(migration.to_owner(sample.store, decomposition).left, elsewhere);
    std::sort(all.begin(), all.end());
    EXPECT_EQ(everyones(comm, sample.store), all) << "every id once, positions to the bit";
    expect_in_box(sample.store, decomposition);
    sample.expect_values();
    EXPECT_EQ(migration.to_owner(sample.store, decomposition).left, 0) << "the second time all are at home";
}

TEST(Migration, FollowsParticlesThatMoveManyTimes) {
    const auto comm = Comm::world();
    const auto grid = test::make_grid(2, {12, 10, 1});
    const Decomposition decomposition(comm, grid);
    const auto all = test::random_points(grid, 400, 2);
    Sample sample;
    sample.fill(comm.is_root() ? all : std::vector<test::Point>{}); // all on one rank at first
    Migration migration;
    CellSort sort;
    CellList cells;
    for (int round = 0; round < 12; ++round) {
        migration.to_owner(sample.store, decomposition);
        expect_in_box(sample.store, decomposition);
        sample.expect_values();
        ASSERT_EQ(comm.sum(std::int64_t(sample.store.owned())), 400);
        sort.sort(sample.store, grid, occupied_cells(sample.store, grid), cells);
        sample.expect_values();
        const auto points = test::read(sample.store, 0, sample.store.owned());
        test::edit(sample.store.position(), [&](auto& x) {
            for (std::size_t i = 0; i < points.size(); ++i) {
                test::Random random(static_cast<std::uint64_t>(points[i].id * 100 + round));
                x(i, 0) = random.unit() * 12 / 8;
                x(i, 1) = random.unit() * (round == 7 ? 0.1 : 10.0) / 8; // once all crowd into one edge
            }
        });
    }
}

TEST(Migration, AllMayLeaveARankAndNoneMayBeThere) {
    const auto comm = Comm::world();
    const auto grid = test::make_grid(3, {8, 8, 8});
    const Decomposition decomposition(comm, grid);
    // Each rank holds one particle, all of them in the last rank's corner cell.
    Sample sample;
    sample.fill({{1000 + comm.rank(), {0.99, 0.99, 0.99}}});
    Migration migration;
    migration.to_owner(sample.store, decomposition);
    const int corner[3] = {7, 7, 7};
    EXPECT_EQ(sample.store.owned(), decomposition.box().contains(corner) ? comm.size() : 0);
    sample.expect_values();
    Sample none;
    EXPECT_EQ(migration.to_owner(none.store, decomposition).left, 0);
}

} // namespace treacle::migration_test
