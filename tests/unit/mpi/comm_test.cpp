#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <new>
#include <numeric>

namespace treacle::comm_test {

TEST(Comm, ReducesNumbersAndLists) {
    const auto comm = Comm::world();
    const int n = comm.size(), r = comm.rank();
    const std::int64_t triangle = std::int64_t(n) * (n - 1) / 2;
    EXPECT_EQ(comm.sum(double(r)), double(triangle));
    EXPECT_EQ(comm.sum(std::int64_t(r) << 33), triangle << 33);
    EXPECT_EQ(comm.min(double(-r)), -(n - 1.0));
    EXPECT_EQ(comm.max(-1.0 - r), -1.0);
    EXPECT_EQ(comm.max(std::int64_t(r) - 100), n - 101);
    std::vector<double> values{double(r), -2.0 * r};
    comm.sum(std::span(values));
    EXPECT_EQ(values, (std::vector<double>{double(triangle), -2.0 * double(triangle)}));
    std::vector<std::int64_t> counts{r, -r};
    comm.max(std::span(counts));
    EXPECT_EQ(counts, (std::vector<std::int64_t>{n - 1, 0}));
    comm.sum(std::span<double>());
}

TEST(Comm, ExclusiveSumCountsTheRanksBefore) {
    const auto comm = Comm::world();
    const std::int64_t r = comm.rank();
    EXPECT_EQ(comm.exclusive_sum(r + 5), r * (r - 1) / 2 + 5 * r);
}

TEST(Comm, AnyIsTrueWhenOneRankSaysSo) {
    const auto comm = Comm::world();
    for (int chosen = 0; chosen < comm.size(); ++chosen) EXPECT_TRUE(comm.any(comm.rank() == chosen));
    EXPECT_FALSE(comm.any(false));
}

TEST(Comm, GathersValuesAndListsOfAnyLengthInTheOrderOfRanks) {
    const auto comm = Comm::world();
    const auto squares = comm.all_gather(std::int64_t(comm.rank()) * comm.rank());
    ASSERT_EQ(squares.size(), std::size_t(comm.size()));
    for (std::size_t r = 0; r < squares.size(); ++r) EXPECT_EQ(squares[r], std::int64_t(r * r));
    EXPECT_EQ(comm.all_gather(0.5 * comm.rank()).back(), 0.5 * (comm.size() - 1));

    // Rank r gives r entries: the first list is empty.
    const std::vector<double> mine(static_cast<std::size_t>(comm.rank()), double(comm.rank()));
    std::vector<double> expected;
    for (int r = 0; r < comm.size(); ++r) expected.insert(expected.end(), static_cast<std::size_t>(r), double(r));
    EXPECT_EQ(comm.all_gather(std::span<const double>(mine)), expected);
    EXPECT_TRUE(comm.all_gather(std::span<const std::int64_t>()).empty());
}

TEST(Comm, BroadcastsTextAndNumbersFromAnyRank) {
    const auto comm = Comm::world();
    for (int root = 0; root < comm.size(); ++root) {
        const std::string text = "from " + std::string(static_cast<std::size_t>(comm.rank()), '.');
        EXPECT_EQ(comm.broadcast(text, root), "from " + std::string(static_cast<std::size_t>(root), '.'));
        std::vector<double> values{comm.rank() + 0.5};
        comm.broadcast(std::span(values), root);
        EXPECT_EQ(values.front(), root + 0.5);
    }
    EXPECT_EQ(comm.broadcast(comm.is_root() ? "" : "other"), "");
}

TEST(Comm, SplitsIntoGroupsThatKeepTheOrder) {
    const auto comm = Comm::world();
    const auto group = comm.split(comm.rank() % 2);
    EXPECT_EQ(group.rank(), comm.rank() / 2);
    EXPECT_EQ(group.size(), (comm.size() + 1 - comm.rank() % 2) / 2);
    EXPECT_EQ(group.sum(std::int64_t(1)), group.size());
    EXPECT_EQ(Comm::self().size(), 1);
}

namespace {
// The error that every rank gets when `work` runs on all of them; code 0 when there was none.
struct Caught {
    int code = 0;
    std::string text;
};
Caught guarded(const Comm& comm, const std::function<void()>& work) {
    try {
        comm.guard(work);
    } catch (const Error& error) {
        return {static_cast<int>(error.code()), error.what()};
    }
    return {};
}
} // namespace

TEST(Guard, AnErrorOfOneRankIsThrownOnAllWithItsCodeAndText) {
    const auto comm = Comm::world();
    for (int culprit = 0; culprit < comm.size(); ++culprit) {
        const auto caught = guarded(comm, [&] {
            if (comm.rank() == culprit) throw InputError({"a", "b" + std::to_string(culprit), "c", "d"});
        });
        EXPECT_EQ(caught.code, 2);
        EXPECT_NE(caught.text.find("b" + std::to_string(culprit)), std::string::npos);
    }
}

TEST(Guard, TheLowestRankSpeaksWhenSeveralFail) {
    const auto comm = Comm::world();
    const int lowest = comm.size() / 2;
    const auto caught = guarded(comm, [&] {
        if (comm.rank() == lowest) throw SimulationError({"", "first", "", ""});
        if (comm.rank() > lowest) throw InputError({"", "later", "", ""});
    });
    EXPECT_EQ(caught.code, 3);
    EXPECT_NE(caught.text.find("first"), std::string::npos);
}

TEST(Guard, OtherExceptionsGetTheirExitCodes) {
    const auto comm = Comm::world();
    const bool last = comm.rank() == comm.size() - 1;
    EXPECT_EQ(guarded(comm,
                  [&] {
                      if (last) throw std::bad_alloc();
                  })
                  .code,
        4);
    const auto caught = guarded(comm, [&] {
        if (last) throw std::runtime_error("odd");
    });
    EXPECT_EQ(caught.code, 3);
    EXPECT_EQ(caught.text, "odd");
}

TEST(Guard, NothingIsThrownWithoutAnError) {
    const auto comm = Comm::world();
    int runs = 0;
    EXPECT_EQ(guarded(comm, [&] { ++runs; }).code, 0);
    EXPECT_EQ(runs, 1);
    runs = 0;
    comm.guard_root([&] { ++runs; });
    EXPECT_EQ(runs, comm.is_root() ? 1 : 0);
    EXPECT_THROW(comm.guard_root([] { throw InputError({"", "root", "", ""}); }), Error);
}

} // namespace treacle::comm_test
