#include "points.hpp"

#include <gtest/gtest.h>

namespace treacle::array_test {

TEST(Reserve, MakesRoomAndNeverShrinks) {
    Array<double> view("treacle::test", 0);
    reserve(view, 100);
    const auto capacity = view.extent(0);
    EXPECT_GE(capacity, 100u);
    const double* const data = view.data();
    reserve(view, 3);
    EXPECT_EQ(view.extent(0), capacity);
    EXPECT_EQ(view.data(), data) << "nothing is allocated while there is room";
    reserve(view, capacity + 1);
    EXPECT_GT(view.extent(0), capacity);
    EXPECT_EQ(view.label(), "treacle::test");
}

TEST(ReserveKeep, KeepsTheUsedRowsOfVectorsAndOfTriples) {
    Array<int> ints("treacle::ints", 4);
    Array3 triples("treacle::triples", 4);
    test::edit(ints, [](auto& v) {
        for (int i = 0; i < 4; ++i) v(i) = 10 + i;
    });
    test::edit(triples, [](auto& v) {
        for (int i = 0; i < 12; ++i) v(i / 3, i % 3) = 0.5 * i;
    });
    reserve_keep(ints, 1000, 3);
    reserve_keep(triples, 1000, 4);
    ASSERT_GE(ints.extent(0), 1000u);
    ASSERT_GE(triples.extent(0), 1000u);
    const auto i_host = test::on_host(ints);
    const auto t_host = test::on_host(triples);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(i_host(i), 10 + i);
    for (int i = 0; i < 12; ++i) EXPECT_EQ(t_host(i / 3, i % 3), 0.5 * i);
}

TEST(ReserveKeep, TakesAnArrayWithoutRows) {
    Array3 triples("treacle::triples", 0);
    reserve_keep(triples, 5, 0);
    EXPECT_GE(triples.extent(0), 5u);
}

TEST(CellBox, NumbersItsCellsWithoutGapsXFastest) {
    const CellBox box{{-2, 3, 5}, {1, 7, 7}};
    ASSERT_EQ(box.size(), 3 * 4 * 2);
    int expected = 0;
    for (int z = 5; z < 7; ++z) {
        for (int y = 3; y < 7; ++y) {
            for (int x = -2; x < 1; ++x) {
                EXPECT_EQ(box.index(x, y, z), expected);
                int c[3];
                box.cell(expected++, c);
                EXPECT_TRUE(c[0] == x && c[1] == y && c[2] == z);
                EXPECT_TRUE(box.contains(c));
            }
        }
    }
    const int outside[3] = {1, 3, 5};
    EXPECT_FALSE(box.contains(outside)) << "boxes are half open";
}

TEST(CellBox, BoxesThatDoNotMeetIntersectInAnEmptyOne) {
    const CellBox a{{0, 0, 0}, {4, 4, 4}}, b{{3, 1, 0}, {9, 2, 1}}, far{{4, 0, 0}, {5, 4, 4}};
    EXPECT_EQ(intersect(a, b).size(), 1);
    EXPECT_TRUE(intersect(a, far).empty());
    EXPECT_EQ(intersect(a, far).size(), 0);
}

TEST(CellBox, JoinsInTheSmallestBoxAroundBoth) {
    const CellBox a{{0, 5, 0}, {4, 6, 4}}, b{{3, 1, 2}, {9, 2, 3}}, none{{7, 7, 7}, {7, 9, 9}};
    const auto both = join(a, b);
    EXPECT_EQ(both.size(), 9 * 5 * 4);
    EXPECT_EQ(both.lo[1], 1);
    EXPECT_EQ(join(a, none).size(), a.size()) << "an empty box adds nothing";
    EXPECT_EQ(join(none, b).size(), b.size());
    EXPECT_TRUE(join(none, none).empty());
}

TEST(CellGrid, WhatLiesOutsideBelongsToTheNearestCellOfTheBorder) {
    auto grid = test::make_grid(3, {4, 4, 4});
    grid.period[0] = 0.5;
    int c[3];
    // Beyond the end by rounding, as positions next to the upper face may be once multiplied by 1 / width.
    grid.locate(0.5, 0.5, -0.01, c);
    EXPECT_EQ(c[0], 3);
    // Bodies may reach out of the domain.
    EXPECT_EQ(c[1], 3);
    EXPECT_EQ(c[2], 0);
}

} // namespace treacle::array_test
