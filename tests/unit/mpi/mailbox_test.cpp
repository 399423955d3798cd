#include "mpi/mailbox.hpp"

#include <gtest/gtest.h>

#include <set>

namespace treacle::mailbox_test {

TEST(Mailbox, LettersArriveOnceAndInTheOrderOfTheirSender) {
    const auto comm = Comm::world();
    Mailbox box(comm);
    const std::string large(200'000, 'x'); // not sent at once
    for (int k = 0; k < 3; ++k) box.send(0, std::to_string(comm.rank()) + ":" + std::to_string(k));
    box.send(0, large);
    if (comm.is_root()) {
        std::vector<int> counts(static_cast<std::size_t>(comm.size()), 0);
        for (int i = 0; i < 4 * comm.size(); ++i) {
            const auto letter = box.wait();
            auto& count = counts[static_cast<std::size_t>(letter.rank)];
            EXPECT_EQ(letter.text, count < 3 ? std::to_string(letter.rank) + ":" + std::to_string(count) : large);
            ++count;
        }
        EXPECT_FALSE(box.poll());
    }
    comm.barrier();
}

} // namespace treacle::mailbox_test
