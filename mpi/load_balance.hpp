#pragma once
#include "kokkos/particle_store.hpp"
#include "mpi/decomposition.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace treacle {

// Largest over mean number of particles of a rank; 1 without particles. Collective.
double load_imbalance(const Comm& comm, int owned);

// The cuts of a domain by its particles, and when a new one is due.
class LoadBalance {
public:
    // A cut is due from this ratio of the largest to the mean load on.
    explicit LoadBalance(double max_load_imbalance) : max_load_imbalance_(max_load_imbalance) {}

    // Counts the owned particles of a store for the next cut, each by `weight`, at their cells. A particle outside of the
    // grid counts for the nearest cell, whose rank owns it.
    void add(const ParticleStore& store, const CellGrid& grid, double weight = 1);
    // Cuts by the particles that were added since the last cut. Collective.
    void cut(Decomposition& decomposition);

    // True when this many owned particles require a cut: their ratio is beyond the limit, and by a twentieth beyond
    // what the last cut left, since the best cut along cells may itself be uneven. Collective.
    bool is_due(const Comm& comm, int owned) const;
    // To be called once the particles are where a cut due sent them. Collective.
    void note_cut(const Comm& comm, int owned) { after_cut_ = load_imbalance(comm, owned); }

    // The ratio after the last cut and the decomposition, as a checkpoint has them.
    std::vector<std::int64_t> state(const Decomposition& decomposition) const;
    void restore(std::span<const std::int64_t> state, Decomposition& decomposition);

private:
    double max_load_imbalance_;
    double after_cut_ = 1;
    std::vector<int> cells_;      // [n][3]
    std::vector<double> weights_; // [n]
};

} // namespace treacle
