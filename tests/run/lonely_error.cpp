#include "app/study/run_collectively.hpp"

// Rank 1 throws outside of any guard while the others block.
int main(int argc, char** argv) {
    using namespace treacle;
    const MpiRuntime mpi(argc, argv);
    const Comm comm = Comm::world();
    const auto command = [&] {
        if (comm.rank() == 1) throw InputError({"here", "something", "because", ""});
        comm.barrier();
        return ExitCode::ok;
    };
    return static_cast<int>(app::run_collectively(comm, command, std::chrono::seconds(2)));
}
