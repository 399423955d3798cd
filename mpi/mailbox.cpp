#include "mpi/mailbox.hpp"

#include "mpi/native.hpp"

#include <chrono>
#include <thread>

namespace treacle {

struct Mailbox::Sent {
    std::string text;
    MPI_Request request = MPI_REQUEST_NULL;
};

Mailbox::Mailbox(const Comm& comm) : comm_(comm.split(0)) {}

Mailbox::~Mailbox() {
    for (auto& one : sent_) MPI_Wait(&one->request, MPI_STATUS_IGNORE);
}

void Mailbox::send(int rank, const std::string& text) {
    sent_.remove_if([](const auto& one) {
        int done = 0;
        MPI_Test(&one->request, &done, MPI_STATUS_IGNORE);
        return done != 0;
    });
    sent_.push_back(std::make_unique<Sent>(Sent{text, MPI_REQUEST_NULL}));
    auto& one = *sent_.back();
    MPI_Isend(one.text.data(), static_cast<int>(one.text.size()), MPI_CHAR, rank, 0, native(comm_), &one.request);
}

std::optional<Mailbox::Letter> Mailbox::poll() {
    int there = 0, length = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, 0, native(comm_), &there, &status);
    if (there == 0) return {};
    MPI_Get_count(&status, MPI_CHAR, &length);
    Letter letter{status.MPI_SOURCE, std::string(static_cast<std::size_t>(length), '\0')};
    MPI_Recv(letter.text.data(), length, MPI_CHAR, letter.rank, 0, native(comm_), MPI_STATUS_IGNORE);
    return letter;
}

Mailbox::Letter Mailbox::wait() {
    for (;;) {
        if (auto letter = poll()) return *letter;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

} // namespace treacle
