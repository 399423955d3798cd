#pragma once
#include "mpi/decomposition.hpp"
#include "mpi/exchange.hpp"

#include <initializer_list>

namespace treacle {

// Values that stand in the cells of a block of the grid, one per cell: each rank keeps those of its own cells and of
// `layers` cells around them in an array over its window, x fastest (CellBox::index). What stands on a face, an edge or
// a corner of the cells belongs to the cell above it, so that one halo serves all (grid/mac_grid.hpp). The block may be
// smaller than the grid: memory follows the block. Along periodic axes halo cells outside of the grid are images.
class CellHalo {
public:
    // Collective. `active`: the block, the same on all ranks. Ranks whose box it does not meet have an empty window.
    void connect(const Decomposition& decomposition, const CellBox& active, int layers);

    const CellBox& owned() const { return owned_; }   // this rank's cells of the block
    const CellBox& window() const { return window_; } // and the layers around them; flat axes of 2D scenes have none
    const CellBox& active() const { return active_; } // block of the last connect()
    int layers() const { return layers_; }            // of halo, >= 0

    // Collective: halo cells take the values of their owners. Halo cells without an owner, outside of the block, keep
    // theirs. All arrays in one message per neighbour; each has window().size() entries or more.
    void gather(std::initializer_list<Array<double>> values);
    void gather(std::initializer_list<Array<int>> values);
    // Collective: the same of an array with `width` numbers per cell, those of a cell together.
    void gather_blocks(const Array<double>& values, int width);
    // Collective: adds the values of halo cells onto their owners', in a fixed order: the adjoint of gather.
    void scatter(std::initializer_list<Array<double>> values);

private:
    template <class Fields>
    void bring(const Fields& fields);

    Comm comm_ = Comm::self();
    CellBox active_, owned_, window_;
    int layers_ = 0;
    ExchangePlan outgoing_, incoming_;
    Array<int> sent_{"treacle::cell_halo_sent", 0};         // places in the window, slice after slice
    Array<int> received_{"treacle::cell_halo_received", 0}; // the same of what comes in
    Array<double> send_{"treacle::cell_halo_send", 0};
    Array<double> receive_{"treacle::cell_halo_receive", 0};
};

} // namespace treacle
