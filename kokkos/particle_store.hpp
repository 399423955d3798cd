#pragma once
#include "kokkos/cells.hpp"
#include "kokkos/types.hpp"

#include <string>
#include <variant>
#include <vector>

namespace treacle {

// [capacity] or [capacity][3].
using FieldArray = std::variant<Array<double>, Array3, Array<std::int64_t>, Array<int>>;

// Lifetime of a field's values.
enum class FieldRole {
    state, // migrates with its particle, is checkpointed
    work   // recomputed every step: neither migrates nor is checkpointed
};

// Declared once per field; migration, halo, sort, checkpoint and output loop over the declarations.
struct Field {
    std::string name;
    std::string unit;
    FieldRole role = FieldRole::state;
    bool output = false; // may be requested for frames
    FieldArray array;
};

// Particles as a struct of arrays: rows [0, owned) belong to this rank and are sorted by cell and id, rows
// [owned, owned + ghosts) are copies of other ranks' particles. Every store has the fields `position` and
// `id`. Arrays keep spare room: their extents are capacities.
class ParticleStore {
public:
    ParticleStore();

    // Returns the field's number, for get(). Rows that there are already are zero.
    template <class View>
    int add(const std::string& name, const std::string& unit, FieldRole role, bool output = false) {
        const std::size_t rows = fields_.empty() ? 0 : position().extent(0);
        fields_.push_back({name, unit, role, output, View("treacle::" + name, rows)});
        return static_cast<int>(fields_.size()) - 1;
    }
    template <class View>
    const View& get(int field) const {
        return std::get<View>(fields_[static_cast<std::size_t>(field)].array);
    }
    const Array3& position() const { return get<Array3>(0); }
    const Array<std::int64_t>& id() const { return get<Array<std::int64_t>>(1); }

    // Numbers of rows; ghosts are 0 from resize_owned() on.
    int owned() const { return owned_; }
    int ghosts() const { return ghosts_; }
    int total() const { return owned_ + ghosts_; }
    // Declarations in the order of add(); the index is the one of get().
    std::vector<Field>& fields() { return fields_; }
    const std::vector<Field>& fields() const { return fields_; }

    // Changes the number of owned rows, keeping the first ones; ghosts are dropped.
    void resize_owned(int owned);
    // Makes room for ghost rows behind the owned ones; the owned rows keep their values.
    void resize_ghosts(int ghosts);

    // Keeps the rows order[0..n) of the state fields, in that order: sorting and deletion in one.
    void permute(const Array<int>& order, int n);
    // Keeps the first `owned` rows of the state fields, of which holes[0..n) take the values of the rows from[0..n).
    void fill_holes(const Array<int>& holes, const Array<int>& from, int n, int owned);

    // Bytes of all arrays.
    std::size_t bytes() const;

private:
    std::vector<Field> fields_;
    int owned_ = 0;
    int ghosts_ = 0;
    FieldArray scratch_[4]; // one per type, swapped with the field that was permuted
};

// Number of doubles that one row of a field takes in a message or a file.
int components(const Field& field);

// Smallest block of cells that holds the owned particles from row `first` on; empty without particles.
CellBox occupied_cells(const ParticleStore& store, const CellGrid& grid, int first = 0);

// Sorts the owned particles by cell and, within a cell, by id, and fills the cell list's owned part. The
// window is `owned_cells` and a layer of halo around it, whose cells are left empty.
// Cost: about five passes over the state.
class CellSort {
public:
    void sort(ParticleStore& store, const CellGrid& grid, const CellBox& owned_cells, CellList& cells);

private:
    Array<int> cell_{"treacle::cell", 0};
    Array<int> slot_{"treacle::slot", 0};
    Array<int> order_{"treacle::order", 0};
};

} // namespace treacle
