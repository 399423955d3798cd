#pragma once
#include "grid/momentum/momentum_scene.hpp"
#include "grid/momentum/momentum_sums.hpp"
#include "mpi/comm.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace treacle::grid {

// (M) Pieces of liquid that touch no solid: gravity alone changes their momentum. What a step adds besides is taken off of each as
// of a rigid body. There may be thousands in a splash: a piece is summed on the rank that its label names.
class LooseLiquid {
public:
    // Labels of pieces [window]: the same number for cells that hang together, on all ranks; none: not of a piece.
    static constexpr double none = -1;
    // The label of member `i` of a rank's own, and the rank that a label names.
    static double label_of(int rank, std::size_t i) { return double(rank) * ranks_apart + double(i); }
    static int rank_of(double label) { return static_cast<int>(label / ranks_apart); }

    // The pieces, and their momentum while the particles have the velocities of before.
    void begin(const MomentumScene& scene, std::span<const double> label);
    // Collective, when the particles have their new velocities.
    void end(const Comm& comm, const MomentumScene& scene, const MomentumKick& kick);

    // Memory of this rank [bytes].
    std::size_t bytes() const {
        return sizeof(double) * (of_cell_.span() + before_.span() + after_.span() + motion_.span()) +
               sizeof(int) * (cell_.span() + first_.span());
    }

    // Parts of begin() and end(); not private, since nvcc takes no kernel in a private function.
    void sum(const MomentumScene& scene, const Array<double>& out) const;
    void move(const MomentumScene& scene) const;

private:
    static constexpr double ranks_apart = 4294967296.0; // 2^32: more than cells of a rank

    std::vector<double> labels_; // [pieces of this rank] ascending
    int cells_ = 0;
    Array<int> cell_{"treacle::loose_cell", 0};        // [cells] of the particles' list, piece by piece
    Array<int> first_{"treacle::loose_first", 0};      // [pieces + 1] of cell_
    Array<double> of_cell_{"treacle::loose_sums", 0};  // [cells][MomentumSums::count]
    Array<double> before_{"treacle::loose_before", 0}; // [pieces][MomentumSums::count]
    Array<double> after_{"treacle::loose_after", 0};   // [pieces][MomentumSums::count]
    Array<double> motion_{"treacle::loose_motion", 0}; // [pieces][6] RigidMotion
};

} // namespace treacle::grid
