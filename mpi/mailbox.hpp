#pragma once
#include "mpi/comm.hpp"

#include <list>
#include <memory>
#include <optional>

namespace treacle {

// Texts between ranks without synchronisation: a rank polls for letters at any time.
class Mailbox {
public:
    struct Letter {
        int rank = 0;     // of the sender
        std::string text; // any bytes, without end mark
    };

    // Collective.
    explicit Mailbox(const Comm& comm);
    // Blocks until all letters of this rank are on their way.
    ~Mailbox();
    Mailbox(const Mailbox&) = delete;
    Mailbox& operator=(const Mailbox&) = delete;

    // Returns at once; the text is copied. `rank`: receiver, of the mailbox's own group.
    void send(int rank, const std::string& text);
    // A letter that has arrived; those of one sender in their order. Does not block.
    std::optional<Letter> poll();
    // Blocks until a letter arrives, and yields the core meanwhile.
    Letter wait();

private:
    struct Sent; // a text under way
    Comm comm_;  // of its own
    std::list<std::unique_ptr<Sent>> sent_;
};

} // namespace treacle
