#pragma once
#include "mpi/decomposition.hpp"
#include "mpi/exchange.hpp"
#include "surface/field/node_field.hpp"

namespace treacle::surface {

// The tiles of neighbouring ranks around this rank's. Memory and messages follow the tiles near the surface.
class TileHalo {
public:
    // Collective, for each frame. `codes` [tiles of window]: states of this rank's tiles, with any slot for those near the
    // surface; on return the states of all tiles of the window, with slots in the order of the window.
    // Returns the number of slots.
    int connect(const Decomposition& decomposition, const CellBox& window, std::vector<int>& codes);

    // Collective: the neighbours' tiles take the values of their owners.
    void gather(const NodeField& field);

private:
    Comm comm_ = Comm::self();
    ExchangePlan outgoing_, incoming_;
    Array<int> sent_{"treacle::sent_tiles", 0}, received_{"treacle::received_tiles", 0}; // slots
    Array<double> send_{"treacle::tile_send", 0}, receive_{"treacle::tile_receive", 0};
};

} // namespace treacle::surface
