#pragma once
#include "kokkos/particle_store.hpp"
#include "mpi/decomposition.hpp"
#include "mpi/exchange.hpp"

namespace treacle {

// Sends each owned particle whose cell belongs to another rank there, with all its state fields.
class Migration {
public:
    struct Outcome {
        std::int64_t left = 0; // particles that left this rank
        CellBox cells;         // smallest block that holds those that it has now
    };
    // Collective. Positions must lie in the grid. Rows keep no order afterwards: sort next.
    Outcome to_owner(ParticleStore& store, const Decomposition& decomposition);

private:
    std::vector<Message> take_out(ParticleStore& store, const Decomposition& decomposition, int leaving);

    Array<int> leave_{"treacle::leave", 0}; // rows
    Array<int> listed_{"treacle::listed", 1};
    Array<int> owner_{"treacle::owner", 0};
    Array<int> fill_{"treacle::fill", 0};
    Array<double> packed_{"treacle::migrants", 0};
};

// Number of 8-byte words of one particle's state in a message.
int state_width(const ParticleStore& store);
// Writes the state of rows[0..n) to buffer [n][state_width], and back to rows first + [0..n).
void pack_state(const ParticleStore& store, const Array<int>& rows, int n, const Array<double>& buffer);
void unpack_state(const ParticleStore& store, int first, int n, const Array<double>& buffer);

} // namespace treacle
