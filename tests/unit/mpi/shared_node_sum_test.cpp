#include "mpi/shared_node_sum.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace treacle::shared_rows_test {

namespace {
// Of a row of places that reaches over those of the next two ranks; every third rank has none.
std::vector<std::int64_t> keys_of(int rank) {
    std::vector<std::int64_t> keys;
    for (int x = 4 * rank; x < 4 * rank + 10 && rank % 3 != 2; ++x) {
        const int node[3] = {x, -x, 7};
        keys.push_back(LatticeKey::pack(node));
    }
    std::reverse(keys.begin(), keys.end()); // in no order that the ranks share
    return keys;
}
float part_of(int rank, std::int64_t key, int c) {
    return static_cast<float>(0.1 * (rank + 1) + 1e-3 * double(key % 101) + c);
}
} // namespace

TEST(SharedNodeSum, adds_up_all_copies_and_counts_each_row_once) {
    const auto comm = Comm::world();
    const auto keys = keys_of(comm.rank());
    constexpr int width = 2;
    SharedNodeSum shared;
    shared.connect(comm, keys);
    std::vector<float> parts;
    for (const auto key : keys) {
        for (int c = 0; c < width; ++c) parts.push_back(part_of(comm.rank(), key, c));
    }
    Array<float> values("values", 0);
    assign(values, parts);
    shared.add(values, width);
    const auto found = on_host(values), first = on_host(shared.first());
    std::int64_t counted = 0;
    for (std::size_t k = 0; k < keys.size(); ++k) {
        int lowest = comm.size();
        for (int c = 0; c < width; ++c) {
            double sum = 0; // by rank, as the copies are added
            for (int rank = comm.size() - 1; rank >= 0; --rank) {
                const auto theirs = keys_of(rank);
                if (std::find(theirs.begin(), theirs.end(), keys[k]) != theirs.end()) lowest = rank;
            }
            for (int rank = 0; rank < comm.size(); ++rank) {
                const auto theirs = keys_of(rank);
                if (std::find(theirs.begin(), theirs.end(), keys[k]) != theirs.end()) sum += part_of(rank, keys[k], c);
            }
            EXPECT_EQ(found(width * k + static_cast<std::size_t>(c)), static_cast<float>(sum));
        }
        EXPECT_EQ(first(k), lowest == comm.rank() ? 1.0f : 0.0f);
        counted += first(k) > 0 ? 1 : 0;
    }
    std::vector<std::int64_t> all;
    for (int rank = 0; rank < comm.size(); ++rank) {
        const auto theirs = keys_of(rank);
        all.insert(all.end(), theirs.begin(), theirs.end());
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    EXPECT_EQ(comm.sum(counted), static_cast<std::int64_t>(all.size()));
}

TEST(SharedNodeSum, keys_of_places_are_unpacked_as_they_were) {
    for (const int x : {-(1 << 20), -1, 0, 1, (1 << 20) - 1}) {
        const int node[3] = {x, 5, -x - 1};
        int out[3];
        LatticeKey::unpack(LatticeKey::pack(node), out);
        for (int k = 0; k < 3; ++k) EXPECT_EQ(out[k], node[k]);
    }
}

} // namespace treacle::shared_rows_test
