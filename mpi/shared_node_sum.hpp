#pragma once
#include "mpi/exchange.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace treacle {

// Places on an infinite lattice as one number: 21 bits an axis, from -2^20 to 2^20 - 1.
struct LatticeKey {
    static constexpr std::int64_t half = 1 << 20, mask = (1 << 21) - 1;
    static std::int64_t pack(const int node[3]) {
        return (node[0] + half) | (node[1] + half) << 21 | (node[2] + half) << 42;
    }
    static void unpack(std::int64_t key, int node[3]) {
        for (int k = 0; k < 3; ++k) node[k] = static_cast<int>((key >> (21 * k)) & mask) - static_cast<int>(half);
    }
};

// Rows of values at places on a lattice of which several ranks hold copies, each with its part of a sum: nodes of the cells
// in which two ranks have particles, for one.
class SharedNodeSum {
public:
    // Collective. keys: the places of this rank's rows (LatticeKey), no two alike.
    void connect(const Comm& comm, std::span<const std::int64_t> keys);

    // Collective: each copy becomes the sum of all copies, the same number on every rank. [rows][width]
    void add(const Array<float>& values, int width);

    // Marks of this rank's rows: 1 for those that no rank before it has, 0 for the others [rows].
    const Array<float>& first() const { return first_; }
    std::size_t bytes() const;

private:
    Comm comm_ = Comm::self();
    ExchangePlan slices_;
    int copies_ = 0;                                 // of rows
    Array<int> rows_{"treacle::shared_rows", 0};     // what goes out and comes in, slice after slice
    Array<int> copied_{"treacle::copied_rows", 0};   // the same rows, each once
    Array<int> offsets_{"treacle::copy_offsets", 0}; // [copied + 1] into entries
    Array<int> entries_{"treacle::copy_entries", 0}; // places in receive, by rank; -1: this rank's own
    Array<float> first_{"treacle::first_copies", 0};
    Array<double> send_{"treacle::shared_send", 0}, receive_{"treacle::shared_receive", 0};
};

} // namespace treacle
