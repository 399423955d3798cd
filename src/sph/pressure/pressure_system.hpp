#pragma once
#include "mpi/halo.hpp"
#include "mpi/row_halo.hpp"
#include "solve/rows/matrix.hpp"
#include "sph/model/neighbourhood.hpp"
#include "sph/pressure/solid_rows.hpp"

#include <initializer_list>
#include <vector>

namespace treacle::sph {

// The pressure matrix of the Poisson particles, assembled straight into distributed compressed rows: a block of
// this rank's columns (local numbers) and a block of the other ranks' columns (columns of the halo). Columns rise
// within a row. The arrays live as long as this object and grow only.
//     sum_j a_ij (p_i - p_j) + alpha_i p_i = b_i,  p_j = 0 at Dirichlet neighbours
class PressureSystem {
public:
    // Finds the column in the halo of another rank's row, by its global number; a number that is not there gets any.
    struct HaloColumnMap {
        Array<int> column{"treacle::halo_column", 0}; // rising
        int size = 0;
        KOKKOS_INLINE_FUNCTION int operator()(int global) const {
            int first = 0;
            for (int last = size; first < last;) {
                const int middle = (first + last) / 2;
                if (column(middle) < global) {
                    first = middle + 1;
                } else {
                    last = middle;
                }
            }
            return first;
        }
    };
    // Liquid and solid particles, both with unknowns.
    struct CoupledParticles {
        LiquidParticles& liquid;
        SolidParticles& solid;
        const Neighbourhood& neighbours;
        const SolidRows& around;
        Halo &halo, &solid_halo;
    };
    // Collective. Numbers the rows, gathers the ghosts' numbers, and fills matrix, right-hand side and first
    // guess p^t. With `dirichlet: complementarity`, Dirichlet particles with liquid neighbours have rows too. Roles of
    // owned and ghost particles must be current.
    void assemble(const SphOptions& options, const Constants& constants, const Comm& comm, LiquidParticles& liquid,
        const Neighbourhood& neighbours, Halo& halo);

    // The same with solid particles as unknowns: on each rank the liquid's rows, then the solids',
    //     sum_j a_ij (p_i - p_j) + sum_s a_is (p_i - p_s) = b_i,  sum_j a_sj (p_s - p_j) + sum_t a_st (p_s - p_t) = 0
    // Roles of owned and ghost particles of both must be current (SolidRows::predict).
    void assemble_with_solids(
        const SphOptions& options, const Constants& constants, const Comm& comm, const CoupledParticles& joint);
    void store_solid_pressure(SolidParticles& solid) const;

    // Writes the solution back as pressures [Pa], negative ones clamped to zero (Algorithm 2); Dirichlet and
    // separated particles get theirs.
    void store_pressure(LiquidParticles& liquid) const;

    // Rows of this rank, global number of the first, rows of all ranks; stored entries and memory [bytes] of this rank.
    int rows() const { return rows_; }
    std::int64_t first_row() const { return first_row_; }
    std::int64_t global_rows() const { return global_rows_; }
    std::int64_t entries() const { return own_entries_ + other_entries_; }
    std::size_t bytes() const;

    // One block of columns.
    struct Block {
        Array<int> offset{"treacle::row_offset", 0}; // [rows + 1]
        Array<int> column{"treacle::column", 0};     // [offset[rows]], rising within a row
        Array<double> value{"treacle::value", 0};    // [offset[rows]] [1/m2]
    };
    // The system where a solver on the host reads and writes it: the arrays themselves on a host build, on a device
    // build copies of them, since Debian's PETSc keeps its matrices in host memory.
    struct HostBlock {
        Array<int>::HostMirror offset, column; // [rows + 1], [offset[rows]]
        Array<double>::HostMirror value;       // [offset[rows]] [1/m2]
    };
    struct HostSystem {
        HostBlock own, other;
        Array<double>::HostMirror right_hand_side, solution; // [rows] [kg/m3/s2], [Pa]
    };
    HostSystem to_host() const;
    void take_solution(const HostSystem& host) const;
    // Its matrix as a solver takes it; of the arrays of `host` and this object's halo.
    solve::CsrBlocks blocks(const HostSystem& host);

    const Block& own() const { return own_; }                                 // local columns
    const Block& other() const { return other_; }                             // columns as places in halo()
    const RowHalo& halo() const { return halo_; }                             // to the other ranks' columns
    const Array<double>& right_hand_side() const { return right_hand_side_; } // [rows] [kg/m3/s2]
    const Array<double>& solution() const { return solution_; }               // [rows] in: guess, out: result [Pa]

    // Parts of the above; not private, since nvcc takes no kernel in a private function.
    void number_rows(const SphOptions& options, const Comm& comm, LiquidParticles& liquid, Halo& halo);
    void number_joint_rows(const Comm& comm, const CoupledParticles& joint);
    // Particles whose ghosts may be other ranks' columns, whether or not they are near enough to be neighbours.
    struct RowsOf {
        const ParticleStore& store;
        Array<int> row; // [particles] global number, -1: none
    };
    void connect_halo(const Comm& comm, std::initializer_list<RowsOf> particles);
    void map_ghosts(const LiquidParticles& liquid);
    void count_entries(const LiquidParticles& liquid, const Neighbourhood& neighbours);

private:
    Block own_, other_;
    RowHalo halo_;
    std::vector<int> halo_columns_; // scratch of connect_halo()
    HaloColumnMap column_map_;
    Array<int> ghost_column_{"treacle::ghost_column", 0}; // [ghosts] column of the liquid ghost's row in the halo
    Array<double> right_hand_side_{"treacle::right_hand_side", 0};
    Array<double> solution_{"treacle::solution", 0};
    int rows_ = 0;
    std::int64_t first_row_ = 0, global_rows_ = 0, own_entries_ = 0, other_entries_ = 0;
};

} // namespace treacle::sph
