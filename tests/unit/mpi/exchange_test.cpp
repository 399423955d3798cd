#include "../kokkos/points.hpp"
#include "mpi/exchange.hpp"

#include <gtest/gtest.h>

namespace treacle::exchange_test {
namespace {

// Every rank has the whole graph of messages; the content names sender, receiver and place in the order.
std::vector<std::vector<Message>> random_graph(int ranks, int most, std::uint64_t seed) {
    test::Random random(seed);
    std::vector<std::vector<Message>> sent(static_cast<std::size_t>(ranks));
    for (int from = 0; from < ranks; ++from) {
        const int n = random.below(most + 1);
        for (int k = 0; k < n; ++k) {
            const int to = random.below(ranks);
            Message message{to, std::vector<char>(static_cast<std::size_t>(random.below(3) * random.below(9000)))};
            for (std::size_t b = 0; b < message.bytes.size(); ++b) {
                message.bytes[b] = static_cast<char>(b * 31 + static_cast<std::size_t>(from * 7 + to * 3 + k));
            }
            sent[static_cast<std::size_t>(from)].push_back(std::move(message));
        }
    }
    return sent;
}

std::vector<Message> due(const std::vector<std::vector<Message>>& sent, int to) {
    std::vector<Message> out;
    for (std::size_t from = 0; from < sent.size(); ++from) {
        for (const auto& message : sent[from]) {
            if (message.rank == to) out.push_back({static_cast<int>(from), message.bytes});
        }
    }
    return out;
}

} // namespace

TEST(ExchangeSparse, DeliversEveryMessageOnceByRankAndInOrder) {
    const auto comm = Comm::world();
    // Rounds follow one another at once: a message must not arrive in the round before its own.
    for (std::uint64_t round = 0; round < 60; ++round) {
        const auto sent = random_graph(comm.size(), 6, round);
        const auto got = exchange_sparse(comm, sent[static_cast<std::size_t>(comm.rank())]);
        const auto expected = due(sent, comm.rank());
        // No early return: the other ranks go on to the next round.
        EXPECT_EQ(got.size(), expected.size()) << "round " << round;
        for (std::size_t k = 0; k < std::min(got.size(), expected.size()); ++k) {
            EXPECT_EQ(got[k].rank, expected[k].rank);
            EXPECT_TRUE(got[k].bytes == expected[k].bytes) << "round " << round;
        }
    }
}

TEST(ExchangeSparse, WithoutMessagesNothingArrives) { EXPECT_TRUE(exchange_sparse(Comm::world(), {}).empty()); }

TEST(ExchangeSparse, OneRankMaySendToAll) {
    const auto comm = Comm::world();
    std::vector<Message> outgoing;
    if (comm.rank() == comm.size() - 1) {
        for (int r = 0; r < comm.size(); ++r) outgoing.push_back({r, {static_cast<char>(r)}});
    }
    const auto got = exchange_sparse(comm, outgoing);
    ASSERT_EQ(got.size(), 1u);
    EXPECT_EQ(got[0].rank, comm.size() - 1);
    EXPECT_EQ(got[0].bytes, (std::vector<char>{static_cast<char>(comm.rank())}));
}

TEST(ExchangeSlices, PairsSlicesOfTwoRanksInOrder) {
    const auto comm = Comm::world();
    const int next = (comm.rank() + 1) % comm.size(), previous = (comm.rank() + comm.size() - 1) % comm.size();
    // Two slices to the next rank, of two rows and one, and an empty one between them.
    ExchangePlan outgoing{{next, next, next}, {0, 2, 2, 3}}, incoming{{previous, previous, previous}, {0, 2, 2, 3}};
    const Array<double> send("treacle::send", 6), receive("treacle::receive", 6);
    test::edit(send, [&](auto& v) {
        for (int k = 0; k < 6; ++k) v(k) = 10 * comm.rank() + k;
    });
    exchange_slices(comm, {outgoing, send}, {incoming, receive}, 2);
    const auto got = test::on_host(receive);
    for (int k = 0; k < 6; ++k) EXPECT_EQ(got(k), 10 * previous + k);
}

} // namespace treacle::exchange_test
