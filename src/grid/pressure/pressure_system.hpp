#pragma once
#include "grid/mac/pressure_faces.hpp"
#include "mpi/cell_halo.hpp"
#include "mpi/row_halo.hpp"
#include "solve/multigrid/multilevel.hpp"
#include "solve/rows/matrix.hpp"

#include <vector>

namespace treacle::grid {

// The matrix of the pressures at the centres of liquid cells (P1), in distributed compressed rows:
//     sum over open faces  A (p_c - p_n)   beside liquid,   A / theta (p_c - p_s)   beside air
// Symmetric, without dimension. Rows are numbered by blocks of 2 x 2 x 2 cells, the aggregates of the hierarchy.
class PressureSystem {
public:
    // Collective. Distances and areas must be current one cell around the owned ones.
    void assemble(const Comm& comm, CellHalo& halo, const PressureFaces& faces);

    // Rows of this rank, the global number of the first, rows of all ranks; faces as of assemble().
    int rows() const { return rows_; }
    std::int64_t first_row() const { return first_row_; }
    std::int64_t global_rows() const { return global_rows_; }
    const PressureFaces& faces() const { return faces_; }
    const Array<int>& row_of() const { return row_of_; }   // [window] global number of a cell's row, -1: none
    const Array<int>& cell_of() const { return cell_of_; } // [rows] place in the window

    // Compressed rows: columns are local rows in the own block, places in the halo in the other one.
    struct Block {
        Array<int> offset{"treacle::row_offset", 0}; // [rows + 1]
        Array<int> column{"treacle::column", 0};     // [entries], rising within a row
        Array<double> value{"treacle::value", 0};    // [entries] [1]
    };
    // Block in host memory.
    struct HostBlock {
        Array<int>::HostMirror offset, column; // [rows + 1], [entries]
        Array<double>::HostMirror value;       // [entries] [1]
    };
    // Entries where solvers on the host read them: the arrays themselves on a host build.
    struct Host {
        HostBlock own, other;
        Array<double>::HostMirror dirichlet_diagonal; // [rows] sum of A / theta beside air
    };
    Host to_host() const;
    solve::CsrBlocks blocks(const Host& host);
    RowHalo& halo() { return halo_; }
    // [rows][3], of cells of twice the width: what the hierarchy puts together first.
    std::vector<int> aggregates() const;

    // Pressures of the rows to their cells, 0 elsewhere; halo cells are not written.
    void to_cells(const Array<double>& solution, const Array<double>& cells) const;
    std::size_t bytes() const;

    // Parts of the above; not private, since nvcc takes no kernel in a private function.
    void number_rows(const Comm& comm, CellHalo& halo);
    void count_entries();
    void fill();

private:
    void connect_halo(const Comm& comm, const CellHalo& halo);

    PressureFaces faces_;
    CellBox owned_;
    Block own_, other_;
    RowHalo halo_;
    std::vector<int> columns_; // scratch of connect_halo
    Array<int> row_of_{"treacle::pressure_row", 0};
    Array<int> cell_of_{"treacle::pressure_cell", 0};
    Array<int> halo_column_{"treacle::pressure_halo_column", 0}; // [window] of other ranks' rows: column of the halo
    Array<double> dirichlet_diagonal_{"treacle::dirichlet_diagonal", 0};
    int rows_ = 0;
    std::int64_t first_row_ = 0, global_rows_ = 0;
};

// The right-hand side [Pa] for face velocities of before a step in which a pressure difference p changes them by
// p / scale, scale = rho dx / dt. The jump at the surface is that of `faces`.
void divergence(const PressureFaces& faces, const PressureSystem& system, const FaceField& velocity, double scale,
    const Array<double>& out);

// Change by a pressure at the faces of the owned cells: u -= (p_c - p_below) / scale, with the surface's pressure and
// distance beside air. `pressure` must be current one cell around. Faces without liquid beside them and closed ones
// keep their velocity.
void subtract_gradient(const PressureFaces& faces, const CellBox& owned, const Array<double>& pressure, double scale,
    const FaceField& velocity);

} // namespace treacle::grid
