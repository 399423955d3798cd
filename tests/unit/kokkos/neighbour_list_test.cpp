#include "kokkos/neighbour_list.hpp"
#include "points.hpp"

#include <gtest/gtest.h>

namespace treacle::neighbour_list_test {
namespace {

struct Sorted {
    ParticleStore store;
    CellList cells;
    CellSort sort;

    Sorted(const CellGrid& grid, const std::vector<test::Point>& points) {
        test::fill(store, points);
        sort.sort(store, grid, occupied_cells(store, grid), cells);
    }
    std::vector<test::Point> rows() const { return test::read(store, 0, store.owned()); }
};

bool near(const test::Point& a, const test::Point& b, double radius) {
    double r2 = 0;
    for (std::size_t k = 0; k < 3; ++k) r2 += (a.x[k] - b.x[k]) * (a.x[k] - b.x[k]);
    return r2 < radius * radius;
}

// Ids of the neighbours of a row, in the order of the list.
std::vector<std::int64_t> listed(const NeighbourList& list, const std::vector<test::Point>& among, int i) {
    const auto offset = test::on_host(list.offset);
    const auto index = test::on_host(list.index);
    std::vector<std::int64_t> ids;
    for (auto k = offset(i); k < offset(i + 1); ++k) ids.push_back(among[static_cast<std::size_t>(index(k))].id);
    return ids;
}

// All pairs are tested; the rows of `among` are in the order that is expected of the list.
void expect_brute_force(const NeighbourList& list, const std::vector<test::Point>& of,
    const std::vector<test::Point>& among, double radius, bool same) {
    std::int64_t pairs = 0;
    for (std::size_t i = 0; i < of.size(); ++i) {
        std::vector<std::int64_t> expected;
        for (std::size_t j = 0; j < among.size(); ++j) {
            if (!(same && i == j) && near(of[i], among[j], radius)) expected.push_back(among[j].id);
        }
        pairs += static_cast<std::int64_t>(expected.size());
        ASSERT_EQ(listed(list, among, static_cast<int>(i)), expected) << "particle " << i;
    }
    EXPECT_EQ(list.size, pairs);
}

constexpr double cell_width = 0.125;

} // namespace

TEST(NeighbourList, IsWhatAllPairsGiveInTheOrderOfCellsAndIds) {
    for (const int dimensions : {2, 3}) {
        const auto grid = test::make_grid(dimensions, {5, 6, dimensions == 3 ? 4 : 1});
        for (const double radius : {cell_width, 0.6 * cell_width}) {
            const Sorted sorted(grid, test::random_points(grid, 700, 5));
            NeighbourList list;
            list.build(sorted.store, sorted.store, grid, sorted.cells, radius);
            expect_brute_force(list, sorted.rows(), sorted.rows(), radius, true);
        }
    }
}

TEST(NeighbourList, FindsMoreNeighboursInACellThanOneBatchHolds) {
    const auto grid = test::make_grid(3, {2, 2, 2});
    const Sorted sorted(grid, test::random_points(grid, 900, 6)); // 112 a cell
    NeighbourList list;
    list.build(sorted.store, sorted.store, grid, sorted.cells, cell_width);
    expect_brute_force(list, sorted.rows(), sorted.rows(), cell_width, true);
}

TEST(NeighbourList, OfOneStoreAmongAnotherWithWindowsOfTheirOwn) {
    const auto grid = test::make_grid(3, {7, 7, 7});
    auto few = test::random_points(grid, 60, 7);
    std::erase_if(few, [](const auto& point) { return point.x[0] > 0.4; });
    auto many = test::random_points(grid, 400, 8);
    std::erase_if(many, [](const auto& point) { return point.x[2] < 0.3; });
    const Sorted of(grid, few), among(grid, many);
    NeighbourList list;
    list.build(of.store, among.store, grid, among.cells, cell_width);
    expect_brute_force(list, of.rows(), among.rows(), cell_width, false);
    EXPECT_GT(list.size, 0);
    list.build(among.store, of.store, grid, of.cells, cell_width);
    expect_brute_force(list, among.rows(), of.rows(), cell_width, false);
}

TEST(NeighbourList, LeavesOutParticlesAtExactlyTheRadius) {
    const auto grid = test::make_grid(3, {4, 4, 4});
    // 2^-3 apart along x, to the bit; the third is one step nearer.
    const Sorted sorted(grid, {{1, {0.125, 0.25, 0.25}}, {2, {0.25, 0.25, 0.25}}, {3, {0.25 - 0x1p-40, 0.25, 0.25}}});
    NeighbourList list;
    list.build(sorted.store, sorted.store, grid, sorted.cells, 0.125);
    const auto rows = sorted.rows();
    for (int i = 0; i < 3; ++i) {
        const auto ids = listed(list, rows, i);
        switch (rows[static_cast<std::size_t>(i)].id) {
        case 1: EXPECT_EQ(ids, (std::vector<std::int64_t>{3})); break;
        case 2: EXPECT_EQ(ids, (std::vector<std::int64_t>{3})); break;
        case 3: EXPECT_EQ(ids, (std::vector<std::int64_t>{1, 2})); break;
        }
    }
}

TEST(NeighbourList, TwoParticlesAtOnePlaceAreNeighboursButNotOfThemselves) {
    const auto grid = test::make_grid(2, {3, 3, 1});
    const Sorted sorted(grid, {{4, {0.2, 0.2, 0}}, {9, {0.2, 0.2, 0}}});
    NeighbourList list;
    list.build(sorted.store, sorted.store, grid, sorted.cells, 0.1);
    EXPECT_EQ(listed(list, sorted.rows(), 0), (std::vector<std::int64_t>{9}));
    EXPECT_EQ(listed(list, sorted.rows(), 1), (std::vector<std::int64_t>{4}));
}

TEST(NeighbourList, EmptyStoresAndLonelyParticlesHaveNone) {
    const auto grid = test::make_grid(3, {4, 4, 4});
    const Sorted none(grid, {}), one(grid, {{5, {0.3, 0.3, 0.3}}});
    NeighbourList list;
    list.build(one.store, one.store, grid, one.cells, cell_width);
    EXPECT_EQ(list.size, 0);
    EXPECT_TRUE(listed(list, one.rows(), 0).empty());
    list.build(one.store, none.store, grid, none.cells, cell_width);
    EXPECT_EQ(list.size, 0);
    EXPECT_TRUE(listed(list, {}, 0).empty());
    list.build(none.store, one.store, grid, one.cells, cell_width);
    EXPECT_EQ(list.size, 0);
}

} // namespace treacle::neighbour_list_test
