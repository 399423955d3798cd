#include "../kokkos/points.hpp"
#include "kokkos/neighbour_list.hpp"
#include "mpi/halo.hpp"
#include "mpi/migration.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <map>

namespace treacle::halo_test {
namespace {

struct Case {
    const char* name;
    int dimensions;
    std::array<int, 3> count;
    std::array<bool, 3> periodic;
    int particles;
};
const Case cases[] = {
    {"closed box", 3, {6, 5, 4}, {false, false, false}, 700},
    {"plane", 2, {9, 7, 1}, {false, false, false}, 250},
    {"periodic along x", 3, {5, 4, 4}, {true, false, false}, 500},
    {"periodic everywhere", 3, {4, 3, 5}, {true, true, true}, 500},
    {"two cells along every periodic axis", 3, {2, 2, 2}, {true, true, true}, 120},
    {"thin along two periodic axes", 3, {12, 2, 3}, {false, true, true}, 400},
    {"periodic plane", 2, {6, 2, 1}, {true, true, false}, 150},
    {"a handful of particles", 3, {8, 8, 8}, {true, false, true}, 5},
    {"more ranks than cells", 3, {3, 1, 1}, {false, false, false}, 40},
    {"no particles", 3, {4, 4, 4}, {true, true, true}, 0},
};

CellGrid grid_of(const Case& c) {
    auto grid = test::make_grid(c.dimensions, c.count);
    for (std::size_t k = 0; k < 3; ++k) grid.period[k] = c.periodic[k] ? c.count[k] / 8.0 : 0;
    return grid;
}

// A decomposed set of particles with ghosts; each rank starts with some of the points.
struct Distributed {
    Decomposition decomposition;
    ParticleStore store;
    int value = store.add<Array<double>>("value", "", FieldRole::state);
    int triple = store.add<Array3>("triple", "", FieldRole::work);
    int number = store.add<Array<int>>("number", "", FieldRole::work);
    CellList cells;
    Halo halo;

    Distributed(const Comm& comm, const CellGrid& grid, const std::vector<test::Point>& all)
        : decomposition(comm, grid) {
        std::vector<test::Point> mine;
        std::vector<int> where;
        for (std::size_t k = 0; k < all.size(); ++k) {
            if (static_cast<int>(k) % comm.size() != comm.rank()) continue;
            mine.push_back(all[k]);
            const auto cell = test::cell_of(grid, all[k]);
            where.insert(where.end(), cell.begin(), cell.end());
        }
        decomposition.repartition(where, std::vector<double>(mine.size(), 1.0));
        test::fill(store, mine);
        test::edit(store.get<Array<double>>(value), [&](auto& v) {
            for (std::size_t i = 0; i < mine.size(); ++i) v(i) = 1.0 / double(mine[i].id);
        });
        Migration migration;
        migration.to_owner(store, decomposition);
        CellSort sort;
        sort.sort(store, grid, occupied_cells(store, grid), cells);
        halo.connect(decomposition);
        halo.rebuild(store, cells);
    }
    std::vector<test::Point> ghosts() const { return test::read(store, store.owned(), store.total()); }
};

// Particles, as images where axes are periodic, in the cells next to a box.
std::vector<test::Point> expected_ghosts(
    const CellGrid& grid, const CellBox& box, const std::vector<test::Point>& all) {
    std::vector<test::Point> out;
    if (box.empty()) return out;
    CellBox ghosted = box;
    int images[3];
    for (int k = 0; k < 3; ++k) {
        ghosted.lo[k] -= grid.halo_width(k);
        ghosted.hi[k] += grid.halo_width(k);
        images[k] = grid.periodic(k) ? 1 : 0;
    }
    for (const auto& point : all) {
        const auto home = test::cell_of(grid, point);
        for (int sz = -images[2]; sz <= images[2]; ++sz) {
            for (int sy = -images[1]; sy <= images[1]; ++sy) {
                for (int sx = -images[0]; sx <= images[0]; ++sx) {
                    const int shift[3] = {sx, sy, sz};
                    auto image = point;
                    int c[3];
                    for (std::size_t k = 0; k < 3; ++k) {
                        c[k] = home[k] + shift[k] * grid.count[k];
                        image.x[k] += shift[k] * grid.period[k];
                    }
                    if (ghosted.contains(c) && !box.contains(c)) out.push_back(image);
                }
            }
        }
    }
    std::sort(out.begin(), out.end());
    return out;
}

// The sum over neighbours in the order of the list: any other order, or another neighbour, changes its bits.
std::map<std::int64_t, std::array<double, 2>> neighbour_sums(const Distributed& d, double radius) {
    NeighbourList list;
    list.build(d.store, d.store, d.decomposition.grid(), d.cells, radius);
    const auto offset = list.offset;
    const auto index = list.index;
    const auto x = d.store.position();
    const auto value = d.store.get<Array<double>>(d.value);
    const Array<double> sum("treacle::sum", static_cast<std::size_t>(d.store.owned()));
    Kokkos::parallel_for(
        "sum", d.store.owned(), KOKKOS_LAMBDA(int i) {
            double total = 0;
            for (auto k = offset(i); k < offset(i + 1); ++k) {
                const int j = index(k);
                double r2 = 0;
                for (int c = 0; c < 3; ++c) r2 += (x(i, c) - x(j, c)) * (x(i, c) - x(j, c));
                total += value(j) / (0.01 + r2);
            }
            sum(i) = total;
        });
    const auto sums = test::on_host(sum);
    const auto id = test::on_host(d.store.id());
    const auto rows = test::on_host(offset);
    std::map<std::int64_t, std::array<double, 2>> out;
    for (int i = 0; i < d.store.owned(); ++i) out[id(i)] = {sums(i), double(rows(i + 1) - rows(i))};
    return out;
}

class HaloCase : public testing::TestWithParam<Case> {
protected:
    CellGrid grid = grid_of(GetParam());
    std::vector<test::Point> all = test::random_points(grid, GetParam().particles, 17);
};

} // namespace

TEST_P(HaloCase, GhostsAreTheParticlesAndImagesInTheCellsAround) {
    const Distributed d(Comm::world(), grid, all);
    auto ghosts = d.ghosts();
    std::sort(ghosts.begin(), ghosts.end());
    EXPECT_EQ(ghosts, expected_ghosts(grid, d.decomposition.box(), all));
    EXPECT_EQ(
        d.decomposition.comm().sum(d.halo.sent_rows()), d.decomposition.comm().sum(std::int64_t(d.store.ghosts())));
}

TEST_P(HaloCase, TheCellListHoldsEveryParticleOfItsWindowById) {
    const Distributed d(Comm::world(), grid, all);
    const auto rows = test::read(d.store, 0, d.store.total());
    const auto begin = test::on_host(d.cells.begin), end = test::on_host(d.cells.end);
    auto present = expected_ghosts(grid, d.decomposition.box(), all);
    for (int i = 0; i < d.store.owned(); ++i) present.push_back(rows[static_cast<std::size_t>(i)]);
    std::map<std::array<int, 3>, std::vector<std::int64_t>> expected;
    for (const auto& point : present) {
        std::array<int, 3> c; // without the clamp of periodic axes, for images
        for (int k = 0; k < 3; ++k) {
            c[std::size_t(k)] = int(std::floor((point.x[std::size_t(k)] - grid.origin[k]) * grid.inverse_width[k]));
        }
        expected[c].push_back(point.id);
    }
    for (int k = 0; k < d.cells.window.size(); ++k) {
        std::array<int, 3> c;
        d.cells.window.cell(k, c.data());
        std::vector<std::int64_t> ids;
        for (int i = begin(k); i < end(k); ++i) ids.push_back(rows[static_cast<std::size_t>(i)].id);
        auto& due = expected[c];
        std::sort(due.begin(), due.end());
        ASSERT_EQ(ids, due) << "cell " << c[0] << " " << c[1] << " " << c[2];
    }
}

TEST_P(HaloCase, NeighbourSumsAreThoseOfOneRankBitForBit) {
    Distributed many(Comm::world(), grid, all), one(Comm::self(), grid, all);
    many.halo.gather(many.store, {many.value});
    one.halo.gather(one.store, {one.value}); // its own images
    const auto sums = neighbour_sums(many, 0.125), reference = neighbour_sums(one, 0.125);
    ASSERT_EQ(many.decomposition.comm().sum(std::int64_t(sums.size())), GetParam().particles);
    ASSERT_EQ(one.store.owned(), GetParam().particles);
    for (const auto& [id, sum] : sums) {
        ASSERT_TRUE(reference.count(id));
        ASSERT_EQ(sum, reference.at(id)) << "particle " << id;
    }
}

TEST_P(HaloCase, GatherBringsTheOwnersValuesOfSeveralFieldsAtOnce) {
    Distributed d(Comm::world(), grid, all);
    const int n = d.store.owned();
    const auto rows = test::read(d.store, 0, d.store.total());
    test::edit(d.store.get<Array3>(d.triple), [&](auto& v) {
        for (int i = 0; i < 3 * n; ++i) v(i / 3, i % 3) = double(rows[std::size_t(i / 3)].id) + 0.25 * (i % 3);
    });
    test::edit(d.store.get<Array<int>>(d.number), [&](auto& v) {
        for (int i = 0; i < n; ++i) v(i) = -int(rows[std::size_t(i)].id);
    });
    d.halo.gather(d.store, {d.number, d.triple, d.value});
    const auto triple = test::on_host(d.store.get<Array3>(d.triple));
    const auto number = test::on_host(d.store.get<Array<int>>(d.number));
    const auto value = test::on_host(d.store.get<Array<double>>(d.value));
    for (int i = 0; i < d.store.total(); ++i) {
        const auto id = rows[std::size_t(i)].id;
        ASSERT_EQ(number(i), -int(id));
        ASSERT_EQ(value(i), 1.0 / double(id));
        for (int k = 0; k < 3; ++k) ASSERT_EQ(triple(i, k), double(id) + 0.25 * k);
    }
}

TEST_P(HaloCase, GatherAndScatterAreAdjoint) {
    Distributed d(Comm::world(), grid, all);
    const auto comm = d.decomposition.comm();
    const auto value = d.store.get<Array<double>>(d.value);
    const auto triple = d.store.get<Array3>(d.triple);
    test::Random random(static_cast<std::uint64_t>(5 + comm.rank()));
    // Small integers: every product and sum is exact, so that both sides must be equal.
    const auto draw = [&](int first, int last) {
        std::vector<double> out;
        for (int i = 4 * first; i < 4 * last; ++i) out.push_back(random.below(17) - 8);
        return out;
    };
    const int n = d.store.owned(), total = d.store.total();
    const auto x = draw(0, n), y = draw(n, total);
    const auto write = [&](int first, int last, const std::vector<double>& from) {
        test::edit(value, [&](auto& v) {
            for (int i = first; i < last; ++i) v(i) = from[std::size_t(4 * (i - first))];
        });
        test::edit(triple, [&](auto& v) {
            for (int i = first; i < last; ++i) {
                for (int k = 0; k < 3; ++k) v(i, k) = from[std::size_t(4 * (i - first) + 1 + k)];
            }
        });
    };
    const auto inner = [&](int first, int last, const std::vector<double>& with) {
        const auto v = test::on_host(value);
        const auto t = test::on_host(triple);
        double sum = 0;
        for (int i = first; i < last; ++i) {
            sum += v(i) * with[std::size_t(4 * (i - first))];
            for (int k = 0; k < 3; ++k) sum += t(i, k) * with[std::size_t(4 * (i - first) + 1 + k)];
        }
        return comm.sum(sum);
    };
    write(0, n, x);
    d.halo.gather(d.store, {d.value, d.triple});
    const double gathered = inner(n, total, y);
    write(0, n, std::vector<double>(std::size_t(4 * n), 0.0));
    write(n, total, y);
    d.halo.scatter(d.store, {d.value, d.triple});
    EXPECT_EQ(gathered, inner(0, n, x));
    // The transpose of copying is summing: every ghost row counts once.
    double sent = 0;
    for (const double v : y) sent += v;
    EXPECT_EQ(comm.sum(sent), inner(0, n, std::vector<double>(std::size_t(4 * n), 1.0)));
}

TEST_P(HaloCase, RebuildsAfterParticlesMovedAndTheDomainWasCutAnew) {
    const auto comm = Comm::world();
    Distributed d(comm, grid, all);
    Migration migration;
    CellSort sort;
    for (std::uint64_t round = 0; round < 3; ++round) {
        const auto moved = test::random_points(grid, GetParam().particles, 30 + round);
        std::map<std::int64_t, std::array<double, 3>> target;
        std::vector<test::Point> now = all;
        for (std::size_t k = 0; k < all.size(); ++k) now[k].x = target[all[k].id] = moved[k].x;
        const auto rows = test::read(d.store, 0, d.store.owned());
        std::vector<int> where;
        test::edit(d.store.position(), [&](auto& x) {
            for (std::size_t i = 0; i < rows.size(); ++i) {
                for (std::size_t k = 0; k < 3; ++k) x(i, k) = target.at(rows[i].id)[k];
            }
        });
        for (const auto& point : test::read(d.store, 0, d.store.owned())) {
            const auto cell = test::cell_of(grid, point);
            where.insert(where.end(), cell.begin(), cell.end());
        }
        if (round == 1) {
            d.decomposition.repartition(where, std::vector<double>(rows.size(), 1.0));
            d.halo.connect(d.decomposition);
        }
        migration.to_owner(d.store, d.decomposition);
        sort.sort(d.store, grid, occupied_cells(d.store, grid), d.cells);
        d.halo.rebuild(d.store, d.cells);
        auto ghosts = d.ghosts();
        std::sort(ghosts.begin(), ghosts.end());
        EXPECT_EQ(ghosts, expected_ghosts(grid, d.decomposition.box(), now)) << "round " << round;
    }
}

INSTANTIATE_TEST_SUITE_P(Halo, HaloCase, testing::ValuesIn(cases), [](const auto& info) {
    std::string name = info.param.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
});

} // namespace treacle::halo_test
