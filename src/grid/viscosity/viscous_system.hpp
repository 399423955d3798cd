#pragma once
#include "grid/viscosity/viscous_faces.hpp"
#include "mpi/cell_halo.hpp"
#include "mpi/row_halo.hpp"
#include "solve/rows/matrix.hpp"

#include <vector>

namespace treacle::grid {

struct SlipSolids;

// The matrix A11 = m/dt + W_F D^T K D W_F of the free faces (V4), and of volumes that it holds, in distributed compressed rows
// [kg/s], symmetric, to the bit but where fluxes are interpolated. Rows go cell by cell, x fastest, the components of a cell beside
// each other. After the faces of rank 0 stand `extra` rows, a dense block for the caller to fill: the bodies'.
class ViscousSystem {
public:
    // Collective. flux() of volumes, for assemble() with such. `slip`: solids along which liquid slides, or none.
    void find_flux(const Comm& comm, CellHalo& halo, const ViscousFaces& faces, const PressureFaces& pressure_faces,
        const SlipSolids* slip);
    // Collective.
    void assemble(const Comm& comm, CellHalo& halo, const ViscousFaces& faces, int extra);

    int faces() const { return free_; }                                // rows of this rank that are faces
    int rows() const { return free_ + extra_; }                        // all
    const CellBox& owned() const { return owned_; }                    // cells whose faces are this rank's
    std::int64_t first_row() const { return first_row_; }              // global number of this rank's first row
    std::int64_t global_rows() const { return global_rows_; }          // of all ranks, extra ones included
    int extra() const { return extra_; }                               // on this rank
    const Array<int>& row_of(int axis) const { return row_of_[axis]; } // [window] global number, -1: none
    const Array<int>& face_of() const { return face_of_; } // [faces()] index in the window times 3 plus the axis

    const OpenFlux& flux() const { return flux_; } // whose velocities they take
    RowHalo& halo() { return halo_; }              // to the other ranks' columns

    // The matrix, with its extra block as it was filled last; rank 0 fills it.
    solve::CsrBlocks blocks();
    double& extra_entry(int row, int column);

    // b = m u* - (D^T K D) (W_S V), on the rows of faces.
    void right_hand_side(const ViscousFaces& faces, const FaceField& velocity, const Array<double>& b) const;
    std::size_t bytes() const;

    // Parts of the above; not private, since nvcc takes no kernel in a private function.
    void number_rows(const Comm& comm, CellHalo& halo, const ViscousFaces& faces);
    void count_entries(const ViscousFaces& faces);
    void fill(const ViscousFaces& faces);
    void run_rows(const char* name, const ViscousFaces& faces, bool write);
    template <int most>
    void run_rows(const char* name, const ViscousFaces& faces, bool write);

    // Compressed rows: columns are local rows in the own block, places in the halo in the other one.
    struct Block {
        Array<int> offset{"treacle::row_offset", 0}; // [rows + 1]
        Array<int> column{"treacle::column", 0};     // [entries], rising within a row
        Array<double> value{"treacle::value", 0};    // [entries] [kg/s]
    };

private:
    struct HostBlock {
        Array<int>::HostMirror offset, column;
        Array<double>::HostMirror value;
    };
    void connect_halo(const Comm& comm, const CellHalo& halo, int dimensions);
    void add_extra();

    Block own_, other_;
    HostBlock host_own_, host_other_;
    OpenFlux flux_;
    RowHalo halo_;
    std::vector<int> columns_;
    Array<int> row_of_[3];
    Array<int> face_of_{"treacle::viscous_face_of", 0};
    Array<int> halo_column_[3]; // [window] of other ranks' rows: column of the halo
    CellBox owned_;
    int free_ = 0, extra_ = 0;
    std::int64_t first_row_ = 0, global_rows_ = 0;
};

} // namespace treacle::grid
