#include "../kokkos/points.hpp"
#include "mpi/cell_halo.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace treacle::cell_halo_test {
namespace {

struct Case {
    const char* name;
    int dimensions;
    std::array<int, 3> count;
    std::array<bool, 3> periodic;
    CellBox active;
    int layers;
};
const Case cases[] = {
    {"closed box", 3, {9, 8, 7}, {false, false, false}, {{0, 0, 0}, {9, 8, 7}}, 3},
    {"block within", 3, {12, 9, 10}, {false, false, false}, {{2, 1, 3}, {7, 8, 6}}, 2},
    {"plane", 2, {9, 7, 1}, {false, false, false}, {{0, 1, 0}, {9, 7, 1}}, 3},
    {"periodic along x", 3, {8, 6, 6}, {true, false, false}, {{0, 0, 0}, {8, 6, 6}}, 3},
    {"periodic everywhere", 3, {6, 5, 7}, {true, true, true}, {{0, 0, 0}, {6, 5, 7}}, 3},
    {"periodic but not across the border", 3, {9, 6, 6}, {true, false, false}, {{2, 0, 0}, {7, 6, 6}}, 3},
    {"fewer cells than layers along a periodic axis", 3, {6, 2, 5}, {false, true, true}, {{0, 0, 0}, {6, 2, 5}}, 3},
    {"periodic plane", 2, {6, 3, 1}, {true, true, false}, {{0, 0, 0}, {6, 3, 1}}, 2},
    {"more ranks than cells", 3, {3, 1, 1}, {false, false, false}, {{0, 0, 0}, {3, 1, 1}}, 1},
    {"empty block", 3, {4, 4, 4}, {true, false, false}, {{2, 2, 2}, {2, 4, 4}}, 2},
};

class CellHaloCase : public testing::TestWithParam<Case> {
protected:
    CellHaloCase() : decomposition(Comm::world(), grid_of(GetParam())) {
        // Boxes of unlike sizes: the weight grows along x.
        const auto& grid = decomposition.grid();
        std::vector<int> cells;
        std::vector<double> weights;
        if (Comm::world().is_root()) {
            for (int x = 0; x < grid.count[0]; ++x) {
                for (int y = 0; y < grid.count[1]; ++y) {
                    cells.insert(cells.end(), {x, y, 0});
                    weights.push_back(x + 1);
                }
            }
        }
        decomposition.repartition(cells, weights);
        halo.connect(decomposition, GetParam().active, GetParam().layers);
    }
    static CellGrid grid_of(const Case& c) {
        auto grid = test::make_grid(c.dimensions, c.count);
        for (std::size_t k = 0; k < 3; ++k) grid.period[k] = c.periodic[k] ? c.count[k] / 8.0 : 0;
        return grid;
    }
    template <class T>
    Array<T> filled(T value) const {
        const Array<T> out("treacle::values", static_cast<std::size_t>(halo.window().size()));
        Kokkos::deep_copy(out, value);
        return out;
    }
    // visit(place, cell, home): the cell of the window and the cell of the grid that it is an image of.
    template <class Visit>
    void for_window(const Visit& visit) const {
        const auto& grid = decomposition.grid();
        for (int k = 0; k < halo.window().size(); ++k) {
            std::array<int, 3> c, home;
            halo.window().cell(k, c.data());
            home = c;
            for (int a = 0; a < 3; ++a) {
                const int n = grid.count[a];
                if (grid.periodic(a)) home[std::size_t(a)] = (c[std::size_t(a)] % n + n) % n;
            }
            visit(k, c, home);
        }
    }
    static int number(const std::array<int, 3>& c) { return c[0] + 100 * (c[1] + 100 * c[2]); }

    Decomposition decomposition;
    CellHalo halo;
};

} // namespace

TEST_P(CellHaloCase, OwnedCellsShareOutTheBlock) {
    EXPECT_EQ(decomposition.comm().sum(halo.owned().size()), GetParam().active.size());
    if (halo.owned().empty()) {
        EXPECT_EQ(halo.window().size(), 0);
    }
    for (int k = 0; k < 3 && !halo.owned().empty(); ++k) {
        const int layers = k < GetParam().dimensions ? GetParam().layers : 0;
        EXPECT_EQ(halo.window().lo[k], halo.owned().lo[k] - layers);
        EXPECT_EQ(halo.window().hi[k], halo.owned().hi[k] + layers);
    }
}

TEST_P(CellHaloCase, GatherBringsTheOwnersValuesAndKeepsWhatNobodyOwns) {
    const auto one = filled(-1.0), two = filled(-1.0);
    const auto whole = filled(-1);
    const CellBox owned = halo.owned();
    const auto fill = [&](const auto& field, auto factor) {
        test::edit(field, [&](auto& v) {
            for_window([&](int k, const auto& c, const auto& home) {
                if (owned.contains(c.data())) v(k) = factor * number(home);
            });
        });
    };
    fill(one, 0.5);
    fill(two, 3.0);
    fill(whole, 7);
    halo.gather({one, two});
    halo.gather({whole});
    const auto a = test::on_host(one), b = test::on_host(two);
    const auto w = test::on_host(whole);
    for_window([&](int k, const auto&, const auto& home) {
        const bool somewhere = GetParam().active.contains(home.data());
        ASSERT_EQ(a(k), somewhere ? 0.5 * number(home) : -1.0);
        ASSERT_EQ(b(k), somewhere ? 3.0 * number(home) : -1.0);
        ASSERT_EQ(w(k), somewhere ? 7 * number(home) : -1);
    });
}

TEST_P(CellHaloCase, SeveralNumbersPerCellTravelTogether) {
    const Array<double> values("treacle::values", static_cast<std::size_t>(3 * halo.window().size()));
    Kokkos::deep_copy(values, -1.0);
    const CellBox owned = halo.owned();
    test::edit(values, [&](auto& v) {
        for_window([&](int k, const auto& c, const auto& home) {
            for (int j = 0; j < 3 && owned.contains(c.data()); ++j) v(3 * k + j) = number(home) + 0.25 * j;
        });
    });
    halo.gather_blocks(values, 3);
    const auto v = test::on_host(values);
    for_window([&](int k, const auto&, const auto& home) {
        const bool somewhere = GetParam().active.contains(home.data());
        for (int j = 0; j < 3; ++j) ASSERT_EQ(v(3 * k + j), somewhere ? number(home) + 0.25 * j : -1.0);
    });
}

TEST_P(CellHaloCase, GatherAndScatterAreAdjoint) {
    const auto comm = decomposition.comm();
    test::Random random(static_cast<std::uint64_t>(5 + comm.rank()));
    // Small integers: every product and sum is exact, so that both sides must be equal. x is zero in the halo.
    const auto x = filled(0.0), y = filled(0.0), gathered = filled(0.0), scattered = filled(0.0);
    const CellBox owned = halo.owned();
    test::edit(x, [&](auto& v) {
        for_window([&](int k, const auto& c, const auto&) {
            if (owned.contains(c.data())) v(k) = random.below(17) - 8;
        });
    });
    test::edit(y, [&](auto& v) { for_window([&](int k, const auto&, const auto&) { v(k) = random.below(17) - 8; }); });
    Kokkos::deep_copy(gathered, x);
    Kokkos::deep_copy(scattered, y);
    halo.gather({gathered});
    halo.scatter({scattered});
    const auto hx = test::on_host(x), hy = test::on_host(y), hg = test::on_host(gathered),
               hs = test::on_host(scattered);
    double left = 0, right = 0;
    for_window([&](int k, const auto& c, const auto&) {
        left += hg(k) * hy(k);
        if (owned.contains(c.data())) right += hx(k) * hs(k);
    });
    EXPECT_EQ(comm.sum(left), comm.sum(right));
}

INSTANTIATE_TEST_SUITE_P(CellHalo, CellHaloCase, testing::ValuesIn(cases), [](const auto& info) {
    std::string name = info.param.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
});

} // namespace treacle::cell_halo_test
