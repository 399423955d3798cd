#pragma once
#include "kokkos/particle_store.hpp"
#include "mpi/decomposition.hpp"
#include "mpi/exchange.hpp"

#include <initializer_list>

namespace treacle {

// Copies of the particles that other ranks, or a periodic image of this one, own in the cells next to this
// rank's. `rebuild` after every sort; then two verbs: gather (owner to ghost) and scatter (ghost to owner,
// summing), each the adjoint of the other.
class Halo {
public:
    // Collective, when the decomposition has been cut anew.
    void connect(const Decomposition& decomposition);

    // Collective: finds the ranks that need each cell, makes room for the ghosts behind the owned rows of the store,
    // enters their cells into the cell list, and gathers position (periodic images shifted) and id.
    void rebuild(ParticleStore& store, CellList& cells);

    // Collective: fields by number, all in one message per neighbour.
    void gather(const ParticleStore& store, std::initializer_list<int> fields);
    // Collective: adds the ghost rows of double fields onto their owners' rows. The order of the sums is
    // fixed.
    void scatter(const ParticleStore& store, std::initializer_list<int> fields);

    // The owned rows that are sent, one for each neighbour that needs it; how many.
    const Array<int>& rows() const { return rows_; }
    std::int64_t sent_rows() const { return outgoing_.rows(); }

private:
    // A neighbouring box, or an image of it, whose halo this rank's cells reach.
    struct Neighbour {
        int rank;
        CellBox region;   // my cells that it needs, in my numbering
        int shift[3];     // cells to add to get its numbering
        double offset[3]; // [m] to add to my positions
    };
    void select_sent_rows(const ParticleStore& store, const CellList& cells, std::vector<Message>& messages);
    void enter_ghost_cells(const std::vector<Message>& messages, CellList& cells, ParticleStore& store);
    void shift_images(const ParticleStore& store);

    Comm comm_ = Comm::self();
    std::vector<Neighbour> neighbours_;
    ExchangePlan outgoing_, incoming_;
    std::vector<std::array<double, 3>> incoming_offset_; // [m] per incoming slice
    Array<int> rows_{"treacle::halo_rows", 0};           // owned rows that are sent, slice after slice
    std::vector<int> chosen_;                            // the same on the host, while they are chosen
    Array<double> send_{"treacle::halo_send", 0};
    Array<double> receive_{"treacle::halo_receive", 0};
};

} // namespace treacle
