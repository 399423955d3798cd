#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace treacle {

// A group of ranks. Copies share the group. No MPI type shows here; folders that hand a communicator to a
// library (solve, io) include mpi/native.hpp. All reductions are collective over the group.
class Comm {
public:
    // All ranks of the program. MPI must be initialised (MpiRuntime).
    static Comm world();
    // This rank alone.
    static Comm self();

    int rank() const { return rank_; }          // 0 to size() - 1
    int size() const { return size_; }          // number of ranks of the group
    bool is_root() const { return rank_ == 0; } // rank 0, which logs and writes files

    // Collective: one group per colour; ranks keep their order.
    Comm split(int colour) const;

    void barrier() const; // returns once all ranks have called it
    // Reductions of one value per rank; the result is on every rank.
    double sum(double value) const;
    double min(double value) const;
    double max(double value) const;
    std::int64_t sum(std::int64_t value) const;
    std::int64_t max(std::int64_t value) const;
    // In place, element by element.
    void sum(std::span<double> values) const;
    void max(std::span<double> values) const;
    void sum(std::span<std::int64_t> values) const;
    void max(std::span<std::int64_t> values) const;
    // Sum over the ranks before this one.
    std::int64_t exclusive_sum(std::int64_t value) const;
    bool any(bool value) const;
    // One value per rank, in rank order, on every rank.
    std::vector<std::int64_t> all_gather(std::int64_t value) const;
    std::vector<double> all_gather(double value) const;
    // Lists of any length, in rank order, on every rank: for small data only.
    std::vector<double> all_gather(std::span<const double> values) const;
    std::vector<std::int64_t> all_gather(std::span<const std::int64_t> values) const;
    std::string broadcast(const std::string& text, int root = 0) const;
    void broadcast(std::span<double> values, int root = 0) const;
    void broadcast(std::span<std::int64_t> values, int root = 0) const;

    // Collective: runs work on every rank, or on rank 0 alone; when it throws on any rank, every rank throws
    // the error of the lowest such rank with the same exit code.
    void guard(const std::function<void()>& work) const;
    void guard_root(const std::function<void()>& work) const;

    // Ends the program on all ranks at once.
    [[noreturn]] void abort(int code) const;

    // Handle of the native communicator (see mpi/native.hpp).
    std::intptr_t handle() const { return handle_; }

private:
    Comm(std::intptr_t handle, int rank, int size) : handle_(handle), rank_(rank), size_(size) {}
    std::intptr_t handle_;
    int rank_;
    int size_;
};

// Initialises MPI for the life of this object. The order of start-up is MPI, Kokkos, PETSc; of the end, its
// reverse.
class MpiRuntime {
public:
    MpiRuntime(int& argc, char**& argv);
    ~MpiRuntime();
    MpiRuntime(const MpiRuntime&) = delete;
    MpiRuntime& operator=(const MpiRuntime&) = delete;

private:
    std::filesystem::path folder_;
};

} // namespace treacle
