#include "points.hpp"

#include <gtest/gtest.h>

namespace treacle::cell_sort_test {
namespace {

void expect_sorted(
    const ParticleStore& store, const CellGrid& grid, const CellList& cells, std::vector<test::Point> expected) {
    std::sort(expected.begin(), expected.end(), [&](const auto& a, const auto& b) { return test::before(grid, a, b); });
    const auto rows = test::read(store, 0, store.owned());
    ASSERT_EQ(rows, expected);
    const auto begin = test::on_host(cells.begin);
    const auto end = test::on_host(cells.end);
    int listed = 0;
    for (int c = 0; c < cells.window.size(); ++c) {
        int where[3];
        cells.window.cell(c, where);
        for (int i = begin(c); i < end(c); ++i, ++listed) {
            const auto cell = test::cell_of(grid, rows[static_cast<std::size_t>(i)]);
            ASSERT_TRUE(cell[0] == where[0] && cell[1] == where[1] && cell[2] == where[2]);
        }
    }
    EXPECT_EQ(listed, store.owned());
}

} // namespace

TEST(CellSort, OrdersByCellAndThenById) {
    for (const int dimensions : {2, 3}) {
        const auto grid = test::make_grid(dimensions, {5, 4, dimensions == 3 ? 3 : 1});
        const auto points = test::random_points(grid, 900, 1);
        ParticleStore store;
        CellSort sort;
        CellList cells;
        test::fill(store, points);
        sort.sort(store, grid, grid.all(), cells);
        expect_sorted(store, grid, cells, points);
        EXPECT_EQ(cells.window.size(), dimensions == 3 ? 7 * 6 * 5 : 7 * 6) << "one layer of halo";
    }
}

TEST(CellSort, AnyOrderOfTheInputGivesTheSameRows) {
    const auto grid = test::make_grid(3, {3, 3, 3});
    auto points = test::random_points(grid, 300, 2);
    test::Random random(3);
    CellSort sort;
    CellList cells;
    for (int trial = 0; trial < 5; ++trial) {
        random.shuffle(points);
        ParticleStore store;
        test::fill(store, points);
        sort.sort(store, grid, grid.all(), cells);
        expect_sorted(store, grid, cells, points);
    }
}

TEST(CellSort, ReusesItsArraysForFewerAndMoreParticlesInOtherWindows) {
    const auto grid = test::make_grid(3, {6, 6, 6});
    CellSort sort;
    CellList cells;
    ParticleStore store;
    for (const int n : {500, 20, 0, 800, 1}) {
        const auto points = test::random_points(grid, n, 10 + static_cast<std::uint64_t>(n));
        test::fill(store, points);
        sort.sort(store, grid, occupied_cells(store, grid), cells);
        expect_sorted(store, grid, cells, points);
    }
}

TEST(CellSort, WithoutParticlesTheWindowIsEmpty) {
    const auto grid = test::make_grid(3, {4, 4, 4});
    ParticleStore store;
    CellSort sort;
    CellList cells;
    sort.sort(store, grid, occupied_cells(store, grid), cells);
    EXPECT_TRUE(cells.window.empty());
    EXPECT_EQ(store.total(), 0);
}

TEST(CellSort, CarriesEveryStateFieldWithItsParticle) {
    const auto grid = test::make_grid(2, {8, 8, 1});
    const auto points = test::random_points(grid, 200, 4);
    ParticleStore store;
    const int twice = store.add<Array<double>>("twice", "", FieldRole::state);
    const int velocity = store.add<Array3>("velocity", "m/s", FieldRole::state);
    test::fill(store, points);
    test::edit(store.get<Array<double>>(twice), [&](auto& v) {
        for (std::size_t i = 0; i < points.size(); ++i) v(i) = 2.0 * double(points[i].id);
    });
    test::edit(store.get<Array3>(velocity), [&](auto& v) {
        for (std::size_t i = 0; i < points.size(); ++i) v(i, 2) = -points[i].x[1];
    });
    CellSort sort;
    CellList cells;
    sort.sort(store, grid, grid.all(), cells);
    const auto rows = test::read(store, 0, store.owned());
    const auto v = test::on_host(store.get<Array<double>>(twice));
    const auto u = test::on_host(store.get<Array3>(velocity));
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(v(i), 2.0 * double(rows[i].id));
        EXPECT_EQ(u(i, 2), -rows[i].x[1]);
    }
}

TEST(OccupiedCells, IsTheSmallestBlockAroundTheParticles) {
    const auto grid = test::make_grid(3, {9, 9, 9});
    ParticleStore store;
    EXPECT_TRUE(occupied_cells(store, grid).empty());
    // Cells (2, 4, 7) and (5, 1, 7).
    test::fill(store, {{1, {0.26, 0.51, 0.99}}, {2, {0.74, 0.24, 0.88}}});
    const auto box = occupied_cells(store, grid);
    EXPECT_EQ(box.lo[0], 2);
    EXPECT_EQ(box.hi[0], 6);
    EXPECT_EQ(box.lo[1], 1);
    EXPECT_EQ(box.hi[1], 5);
    EXPECT_EQ(box.lo[2], 7);
    EXPECT_EQ(box.hi[2], 8);
}

} // namespace treacle::cell_sort_test
