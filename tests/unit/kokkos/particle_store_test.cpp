#include "points.hpp"

#include <gtest/gtest.h>

namespace treacle::particle_store_test {
namespace {

struct Sample {
    ParticleStore store;
    int mass = store.add<Array<double>>("mass", "kg", FieldRole::state);
    int velocity = store.add<Array3>("velocity", "m/s", FieldRole::state);
    int body = store.add<Array<int>>("body", "", FieldRole::state);
    int work = store.add<Array<double>>("work", "", FieldRole::work);

    explicit Sample(int n) {
        store.resize_owned(n);
        test::edit(store.id(), [&](auto& v) {
            for (int i = 0; i < n; ++i) v(i) = 100 + i;
        });
        test::edit(store.position(), [&](auto& v) {
            for (int i = 0; i < 3 * n; ++i) v(i / 3, i % 3) = i;
        });
        test::edit(store.get<Array<double>>(mass), [&](auto& v) {
            for (int i = 0; i < n; ++i) v(i) = 0.5 * i;
        });
        test::edit(store.get<Array3>(velocity), [&](auto& v) {
            for (int i = 0; i < 3 * n; ++i) v(i / 3, i % 3) = -i;
        });
        test::edit(store.get<Array<int>>(body), [&](auto& v) {
            for (int i = 0; i < n; ++i) v(i) = 7 * i;
        });
        test::edit(store.get<Array<double>>(work), [&](auto& v) {
            for (int i = 0; i < n; ++i) v(i) = 3 * i;
        });
    }

    // Asserts every state field of row k to be that of the particle made as number i.
    void expect_row(int k, int i) const {
        EXPECT_EQ(test::on_host(store.id())(k), 100 + i);
        EXPECT_EQ(test::on_host(store.get<Array<double>>(mass))(k), 0.5 * i);
        EXPECT_EQ(test::on_host(store.get<Array<int>>(body))(k), 7 * i);
        for (int c = 0; c < 3; ++c) {
            EXPECT_EQ(test::on_host(store.position())(k, c), 3 * i + c);
            EXPECT_EQ(test::on_host(store.get<Array3>(velocity))(k, c), -(3 * i + c));
        }
    }
};

Array<int> order_of(const std::vector<int>& rows) {
    const Array<int> order("treacle::order", rows.size());
    test::edit(order, [&](auto& v) {
        for (std::size_t k = 0; k < rows.size(); ++k) v(k) = rows[k];
    });
    return order;
}

} // namespace

TEST(ParticleStore, HasPositionAndIdFirst) {
    ParticleStore store;
    ASSERT_EQ(store.fields().size(), 2u);
    EXPECT_EQ(store.fields()[0].name, "position");
    EXPECT_EQ(store.fields()[1].name, "id");
    EXPECT_EQ(components(store.fields()[0]), 3);
    EXPECT_EQ(components(store.fields()[1]), 1);
    EXPECT_EQ(store.total(), 0);
}

TEST(ParticleStore, GrowingKeepsTheStateOfTheOwnedRows) {
    Sample sample(5);
    sample.store.resize_owned(4000);
    EXPECT_EQ(sample.store.owned(), 4000);
    for (int i = 0; i < 5; ++i) sample.expect_row(i, i);
    sample.store.resize_owned(3);
    sample.store.resize_owned(9000);
    for (int i = 0; i < 3; ++i) sample.expect_row(i, i);
}

TEST(ParticleStore, RoomForGhostsKeepsOwnedRowsOfEveryField) {
    Sample sample(6);
    sample.store.resize_ghosts(5000);
    EXPECT_EQ(sample.store.total(), 5006);
    for (int i = 0; i < 6; ++i) {
        sample.expect_row(i, i);
        EXPECT_EQ(test::on_host(sample.store.get<Array<double>>(sample.work))(i), 3 * i);
    }
    sample.store.resize_owned(6);
    EXPECT_EQ(sample.store.ghosts(), 0) << "ghosts are dropped with a new number of owned rows";
}

TEST(ParticleStore, PermuteReordersAndDeletes) {
    Sample sample(6);
    sample.store.resize_ghosts(3);
    sample.store.permute(order_of({5, 0, 3}), 3);
    ASSERT_EQ(sample.store.owned(), 3);
    EXPECT_EQ(sample.store.ghosts(), 0);
    sample.expect_row(0, 5);
    sample.expect_row(1, 0);
    sample.expect_row(2, 3);
    // The arrays swapped in are those of the first permutation: they must be long enough for the second.
    sample.store.resize_owned(200);
    sample.store.permute(order_of({2, 1, 0}), 3);
    sample.expect_row(0, 3);
    sample.expect_row(1, 0);
    sample.expect_row(2, 5);
}

TEST(ParticleStore, PermuteToNothingLeavesNothing) {
    Sample sample(4);
    sample.store.permute(order_of({}), 0);
    EXPECT_EQ(sample.store.total(), 0);
}

TEST(ParticleStore, BytesCountEveryArray) {
    Sample sample(0);
    const auto before = sample.store.bytes();
    sample.store.resize_owned(1000);
    // position 24, id 8, mass 8, velocity 24, body 4, work 8; the spare room is at most a quarter and 16
    // rows.
    EXPECT_GE(sample.store.bytes() - before, 76u * 1000);
    EXPECT_LE(sample.store.bytes() - before, 76u * 1266);
}

} // namespace treacle::particle_store_test
