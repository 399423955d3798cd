#include "../kokkos/points.hpp"
#include "mpi/decomposition.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace treacle::decomposition_test {
namespace {

struct Weighted {
    std::vector<int> cells;
    std::vector<double> weights;
};

// Weighted cells, dealt out to the ranks without regard to their boxes.
template <class Weight>
Weighted weigh_cells(const Comm& comm, const CellGrid& grid, const Weight& weight) {
    Weighted out;
    const auto all = grid.all();
    for (int k = comm.rank(); k < all.size(); k += comm.size()) {
        int c[3];
        all.cell(k, c);
        const double w = weight(c[0], c[1], c[2]);
        if (w == 0) continue;
        out.cells.insert(out.cells.end(), c, c + 3);
        out.weights.push_back(w);
    }
    return out;
}

void expect_partition(const Decomposition& decomposition) {
    const auto all = decomposition.grid().all();
    const auto& tree = decomposition.tree();
    std::int64_t cells = 0;
    for (const auto& box : decomposition.boxes()) {
        cells += box.size();
        EXPECT_EQ(intersect(box, all).size(), box.size()) << "boxes lie in the grid";
    }
    EXPECT_EQ(cells, all.size());
    const Array<int> owners("treacle::owners", static_cast<std::size_t>(all.size()));
    Kokkos::parallel_for(
        "owners", static_cast<int>(all.size()), KOKKOS_LAMBDA(int k) {
            int c[3];
            all.cell(k, c);
            owners(k) = tree.owner(c);
        });
    const auto host = test::on_host(owners);
    for (int k = 0; k < all.size(); ++k) {
        int c[3];
        all.cell(k, c);
        for (int r = 0; r < decomposition.comm().size(); ++r) {
            ASSERT_EQ(decomposition.boxes()[static_cast<std::size_t>(r)].contains(c), host(k) == r);
        }
    }
    // All ranks have the same boxes.
    auto state = decomposition.state();
    const auto mine = state;
    decomposition.comm().broadcast(std::span(state));
    EXPECT_EQ(state, mine);
}

std::vector<double> loads(const Decomposition& decomposition, const Weighted& weighted) {
    std::vector<double> load(decomposition.boxes().size(), 0.0);
    for (std::size_t k = 0; k < weighted.weights.size(); ++k) {
        for (std::size_t r = 0; r < load.size(); ++r) {
            if (decomposition.boxes()[r].contains(&weighted.cells[3 * k])) load[r] += weighted.weights[k];
        }
    }
    decomposition.comm().sum(std::span(load));
    return load;
}

} // namespace

TEST(Decomposition, BoxesAndTreePartitionTheGrid) {
    const auto comm = Comm::world();
    for (const auto& count : {std::array{7, 5, 3}, std::array{40, 1, 1}, std::array{9, 9, 1}, std::array{2, 3, 2}}) {
        Decomposition decomposition(comm, test::make_grid(count[2] == 1 ? 2 : 3, count));
        expect_partition(decomposition);
        const auto skewed =
            weigh_cells(comm, decomposition.grid(), [](int x, int y, int) { return x == 0 ? 1.0 + y : 0.0; });
        decomposition.repartition(skewed.cells, skewed.weights);
        expect_partition(decomposition);
    }
}

TEST(Decomposition, MoreRanksThanCellsLeaveEmptyBoxes) {
    const auto comm = Comm::world();
    for (const int cells : {1, 2, 3}) {
        Decomposition decomposition(comm, test::make_grid(3, {cells, 1, 1}));
        expect_partition(decomposition);
        const auto weighted = weigh_cells(comm, decomposition.grid(), [](int, int, int) { return 1.0; });
        decomposition.repartition(weighted.cells, weighted.weights);
        expect_partition(decomposition);
        int occupied = 0;
        for (const auto& box : decomposition.boxes()) occupied += static_cast<int>(!box.empty());
        EXPECT_LE(occupied, cells);
        // Both sides of a cut get a layer: no cell is shared by ranks while others stay idle beside it.
        if (comm.size() >= 2 && cells >= 2) {
            EXPECT_GE(occupied, 2);
        }
    }
}

TEST(Decomposition, WithoutWeightsTheBoxesAreAboutEqual) {
    const auto comm = Comm::world();
    const Decomposition decomposition(comm, test::make_grid(3, {24, 16, 12}));
    for (const auto& box : decomposition.boxes()) {
        // 24 layers cut in the ratio of the ranks, twice for up to 4 ranks and three times for 8.
        EXPECT_NEAR(double(box.size()), 24.0 * 16 * 12 / comm.size(), 0.1 * 24 * 16 * 12 / comm.size());
    }
}

TEST(Decomposition, BalancesASkewedWeight) {
    const auto comm = Comm::world();
    Decomposition decomposition(comm, test::make_grid(3, {64, 32, 16}));
    const auto weighted = weigh_cells(comm, decomposition.grid(),
        [](int x, int y, int z) { return x + y + 2 * z < 60 ? std::exp(-0.05 * x - 0.03 * y) : 0.0; });
    decomposition.repartition(weighted.cells, weighted.weights);
    expect_partition(decomposition);
    const auto load = loads(decomposition, weighted);
    double most = 0, all = 0;
    for (const double l : load) {
        most = std::max(most, l);
        all += l;
    }
    // A cut misses its share by at most half of a layer, here 3 % to 9 % of a part; up to three cuts add up.
    EXPECT_LT(most * comm.size() / all, 1.1);
    EXPECT_NEAR(all, comm.sum([&] {
        double s = 0;
        for (const double w : weighted.weights) s += w;
        return s;
    }()),
        1e-9 * all);
}

// Multigrid's coarse cells are 2 and 4 cells wide: a bar of 202 layers, whose middle is 101, is cut at 100; of three ranks the first
// gets 68 layers in place of 67.
TEST(Decomposition, DividesNoCoarseCellsWhereThatCostsLittle) {
    const auto comm = Comm::world();
    Decomposition decomposition(comm, test::make_grid(3, {202, 4, 4}));
    const auto weighted = weigh_cells(comm, decomposition.grid(), [](int, int, int) { return 1.0; });
    decomposition.repartition(weighted.cells, weighted.weights);
    const auto& first = decomposition.boxes().front();
    if (comm.size() == 2) {
        EXPECT_EQ(first.hi[0], 100);
    }
    if (comm.size() == 3) {
        EXPECT_EQ(first.hi[0], 68);
    }
    for (const auto& box : decomposition.boxes()) EXPECT_TRUE(box.hi[0] == 202 || box.hi[0] % 2 == 0) << box.hi[0];
}

TEST(Decomposition, ALoadInOneCellGoesToOneRank) {
    const auto comm = Comm::world();
    Decomposition decomposition(comm, test::make_grid(3, {8, 8, 8}));
    const auto weighted = weigh_cells(
        comm, decomposition.grid(), [](int x, int y, int z) { return x == 3 && y == 6 && z == 1 ? 5.0 : 0.0; });
    decomposition.repartition(weighted.cells, weighted.weights);
    expect_partition(decomposition);
    const auto load = loads(decomposition, weighted);
    EXPECT_EQ(*std::max_element(load.begin(), load.end()), 5.0);
}

TEST(Decomposition, StateRestoresBoxesAndTree) {
    const auto comm = Comm::world();
    const auto grid = test::make_grid(3, {10, 12, 6});
    Decomposition cut(comm, grid), restored(comm, grid);
    const auto weighted = weigh_cells(comm, grid, [](int x, int y, int z) { return 1.0 / (1 + x * x + y + 3 * z); });
    cut.repartition(weighted.cells, weighted.weights);
    restored.restore(cut.state());
    EXPECT_EQ(restored.state(), cut.state());
    expect_partition(restored);
    for (std::size_t r = 0; r < cut.boxes().size(); ++r) {
        for (int k = 0; k < 3; ++k) {
            EXPECT_EQ(restored.boxes()[r].lo[k], cut.boxes()[r].lo[k]);
            EXPECT_EQ(restored.boxes()[r].hi[k], cut.boxes()[r].hi[k]);
        }
    }
}

} // namespace treacle::decomposition_test
