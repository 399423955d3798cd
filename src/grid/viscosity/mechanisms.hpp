#pragma once
#include "grid/viscosity/viscous_faces.hpp"
#include "grid/viscosity/viscous_system.hpp"
#include "mpi/row_halo.hpp"

#include <span>
#include <vector>

namespace treacle::grid {

// (V6) At a ragged surface a face may have no stress but one, which also acts on other such faces. They can move against each
// other and strain nothing: a mechanism, which only its little mass holds. In
//     z += sum over mechanisms v of v (v^T r) / (v^T M/dt v)
// a preconditioner of the viscous system (viscosity.md) treats them; sweeps do not reduce errors that are stiff in each
// face and loose in their sum. A mechanism is one face, all of whose stresses end at faces that have no other one and
// that are loose.
class Mechanisms {
public:
    // Collective. Those of the matrix that `system` has assembled for these faces.
    void build(const Comm& comm, const ViscousFaces& faces, const ViscousSystem& system, const CellBox& owned);
    // The sum above on this rank's rows. Collective, once per call of build() on all ranks alike.
    void add(std::span<const double> r, std::span<double> z);

    // 1 for this rank's rows that belong to one; others keep what they have.
    void mark(std::span<unsigned char> rows) const;

    std::int64_t count() const { return count_; } // over all ranks, each by the rank of its face
    std::size_t bytes() const;                    // of this rank [bytes]

    static constexpr int most_members = 7; // the face, and one for each of its six stresses
    // Motion of one mechanism; the face first, others have row -1 where there are none.
    struct Motion {
        int row[most_members];     // global
        double part[most_members]; // v
        double inverse;            // 1/(v^T M/dt v) [s/kg]
    };

private:
    struct Member {
        int column; // local row, or from rows_ on column of the halo
        double part;
    };
    void connect(const Comm& comm, std::int64_t first_row);

    // Mechanism m has the members from first_[m] to first_[m + 1], its face first.
    std::vector<Member> members_;
    std::vector<std::size_t> first_;
    std::vector<double> inverse_;
    std::vector<double> strength_; // [rows of the matrix], where its face is; or empty
    int rows_ = 0;                 // of this rank that are faces
    std::int64_t count_ = 0;
    bool shared_ = false; // some mechanism of some rank reaches another one
    RowHalo halo_;
    Array<Motion> found_{"treacle::mechanisms", 0};
};

} // namespace treacle::grid
