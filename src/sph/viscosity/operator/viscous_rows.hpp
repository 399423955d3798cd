#pragma once
#include "mpi/comm.hpp"
#include "solve/rows/block_rows.hpp"

#include <array>
#include <vector>

// Rows of the viscous matrix as they are found and put together, on the host.
namespace treacle::sph {

// Entries of a row for the three components of a velocity, by rows [1].
using RowBlock = std::array<double, 9>;

// The block that a row takes from the stresses of one rank's particles [1].
struct RowContribution {
    int row, column; // global numbers
    RowBlock values;
};

// The blocks of one row as they are found (Algorithm 8's storage of particle i).
class RowStorage {
public:
    // Rows over that many particles, ghosts included.
    explicit RowStorage(int particles) : slot_(static_cast<std::size_t>(particles), -1) {}

    // The block of a particle by its local number; zeros at first.
    RowBlock& at(int particle) {
        int& slot = slot_[static_cast<std::size_t>(particle)];
        if (slot < 0) {
            slot = static_cast<int>(particles_.size());
            particles_.push_back(particle);
            values_.push_back({});
        }
        return values_[static_cast<std::size_t>(slot)];
    }
    // Returns the (particle, block) pairs and clears them.
    template <class Visit>
    void take(const Visit& visit) {
        for (std::size_t k = 0; k < particles_.size(); ++k) {
            visit(particles_[k], values_[k]);
            slot_[static_cast<std::size_t>(particles_[k])] = -1;
        }
        particles_.clear();
        values_.clear();
    }

private:
    std::vector<int> slot_, particles_;
    std::vector<RowBlock> values_;
};

// Collective: contributions to rows from elsewhere go to the ranks that own these; `first` is the global number of this
// rank's first row. Afterwards `contributions` has those to the rows of this rank, by rising rows.
void exchange_contributions(const Comm& comm, int first, std::vector<RowContribution>& contributions);

// A row by rising columns, those that were found several times summed. Sorts `found`.
void append_row(std::vector<RowContribution>& found, solve::BlockRows& out);

} // namespace treacle::sph
