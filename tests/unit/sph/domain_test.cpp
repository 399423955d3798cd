#include "base/text/error.hpp"
#include "sample.hpp"

#include <gtest/gtest.h>

namespace treacle::sph::domain_test {

TEST(DomainBox, WrappedParticlesDifferFromTheirImagesByThePeriodExactly) {
    const auto box =
        make_domain_box(make_domain(3, {-0.1, 0, 0.3}, {0.6, 1.0 / 3, 1.7}, {.periodic = {true, true, false}}), 0.1);
    test::Random random(1);
    for (int trial = 0; trial < 2000; ++trial) {
        for (int axis = 0; axis < 2; ++axis) {
            const double period = box.period[axis];
            const double x = box.wrap(axis, box.lo[axis] + (3 * random.unit() - 1) * period);
            const double y = box.wrap(axis, box.lo[axis] + (3 * random.unit() - 1) * period);
            ASSERT_GE(x, box.lo[axis]);
            ASSERT_LT(x, box.hi[axis]);
            ASSERT_EQ((x + period) - y, -((y - period) - x)) << "both sides of a pair see one vector";
            ASSERT_EQ(box.wrap(axis, x + period), x);
            ASSERT_EQ(box.wrap(axis, x), x);
        }
    }
    EXPECT_EQ(box.wrap(2, 5.0), 5.0) << "other axes are left alone";
    EXPECT_EQ(box.period[2], 0);
}

TEST(CellGrid, CellsAreNoNarrowerThanTheSupport) {
    const double support = 0.11;
    const auto grid =
        make_cell_grid(make_domain(3, {0, 0, 0}, {1, 0.5, 0.34}, {.periodic = {true, false, true}}), support);
    for (int k = 0; k < 3; ++k) EXPECT_GE(1 / grid.inverse_width[k], support);
    EXPECT_EQ(grid.count[0], 9);
    EXPECT_EQ(grid.count[1], 5 + 2) << "a layer for wall particles on either side";
    EXPECT_EQ(grid.count[2], 3);
    int c[3];
    grid.locate(0.5, -0.9 * support, 0.2, c);
    EXPECT_EQ(c[1], 0);
    grid.locate(0.5, 0.5 + 0.9 * support, 0.2, c);
    EXPECT_LT(c[1], grid.count[1]);
}

TEST(CellGrid, RefusesAPeriodicEdgeInWhichAParticleMeetsTwoImages) {
    const auto domain = make_domain(3, {0, 0, 0}, {1, 1, 0.21}, {.periodic = {false, false, true}});
    EXPECT_NO_THROW(make_cell_grid(domain, 0.1));
    try {
        make_cell_grid(domain, 0.11);
        FAIL() << "two supports do not fit";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("the period of 0.21 m in z is not above two support radii, 0.22 m"),
            std::string::npos);
    }
}

TEST(CellGrid, NamesAPeriodAndItsLeastByNumbersThatDifferWhereTheyDo) {
    const auto message = [](double period, double support) -> std::string {
        try {
            make_cell_grid(make_domain(2, {0, 0, 0}, {period, 1, 0}, {.periodic = {true, false, false}}), support);
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    };
    EXPECT_NE(message(0.05, 0.025).find("the period of 0.05 m in x is not above two support radii, 0.05 m"),
        std::string::npos);
    EXPECT_NE(message(0.0499999, 0.025).find("the period of 0.0499999 m in x is not above two support radii, 0.05 m"),
        std::string::npos);
    EXPECT_EQ(message(0.0500001, 0.025), "accepted");
}

TEST(CellGrid, APlaneHasOneLayerOfCells) {
    const auto grid = make_cell_grid(make_domain(2, {0, 0, 0}, {1, 1, 0}), 0.1);
    EXPECT_EQ(grid.count[2], 1);
    EXPECT_EQ(grid.halo_width(2), 0);
    int c[3];
    grid.locate(0.5, 0.5, 0, c);
    EXPECT_EQ(c[2], 0);
}

} // namespace treacle::sph::domain_test
