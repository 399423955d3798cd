#include "app/study/run_collectively.hpp"

#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <new>
#include <optional>
#include <thread>

namespace treacle::app {

namespace {

struct Failure {
    ExitCode code = ExitCode::ok;
    std::string text;
};

// Ends this process, and by that all ranks of the program, unless it is destroyed in time.
class LastResort {
public:
    LastResort(int rank, Failure failure, std::chrono::seconds timeout)
        : thread_([this, rank, failure = std::move(failure), timeout] { wait(rank, failure, timeout); }) {}
    ~LastResort() {
        {
            const std::lock_guard lock(mutex_);
            over_ = true;
        }
        changed_.notify_all();
        thread_.join();
    }

private:
    void wait(int rank, const Failure& failure, std::chrono::seconds timeout) {
        std::unique_lock lock(mutex_);
        if (changed_.wait_for(lock, timeout, [this] { return over_; })) return;
        std::fprintf(stderr, "rank %d alone: %s\n", rank, failure.text.c_str());
        std::_Exit(static_cast<int>(failure.code));
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    bool over_ = false;
    std::thread thread_;
};

Failure current_failure(int rank) {
    try {
        throw;
    } catch (const Error& error) {
        return {error.code(), error.what()};
    } catch (const std::bad_alloc&) {
        return {ExitCode::out_of_memory, "out of memory on rank " + std::to_string(rank)};
    } catch (const std::exception& error) {
        return {ExitCode::simulation_failed, error.what()};
    }
}

} // namespace

ExitCode run_collectively(const Comm& comm, const std::function<ExitCode()>& command, std::chrono::seconds timeout) {
    const Comm farewell = comm.split(0); // no message of the command can be taken for one of these
    ExitCode code = ExitCode::ok;
    std::optional<LastResort> last_resort;
    try {
        farewell.guard([&] {
            try {
                code = command();
            } catch (...) {
                const auto failure = current_failure(comm.rank());
                if (comm.size() > 1) last_resort.emplace(comm.rank(), failure, timeout);
                throw Error(failure.code, failure.text);
            }
        });
    } catch (const Error& error) {
        code = error.code();
        if (comm.is_root()) std::fprintf(stderr, "%s\n", error.what());
    }
    return code;
}

} // namespace treacle::app
