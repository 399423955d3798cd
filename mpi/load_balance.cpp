#include "mpi/load_balance.hpp"

#include <algorithm>
#include <bit>

namespace treacle {

double load_imbalance(const Comm& comm, int owned) {
    const auto most = comm.max(static_cast<std::int64_t>(owned));
    const auto all = comm.sum(static_cast<std::int64_t>(owned));
    return all > 0 ? double(most) * comm.size() / double(all) : 1.0;
}

void LoadBalance::add(const ParticleStore& store, const CellGrid& grid, double weight) {
    const auto x = on_host(store.position());
    const auto first = weights_.size();
    for (int i = 0; i < store.owned(); ++i) {
        int c[3];
        grid.locate(x(i, 0), x(i, 1), x(i, 2), c);
        for (int k = 0; k < 3; ++k) c[k] = std::clamp(c[k], 0, grid.count[k] - 1);
        if (weights_.size() > first && std::equal(c, c + 3, cells_.end() - 3)) {
            weights_.back() += weight; // sorted particles share their cell with the one before
            continue;
        }
        cells_.insert(cells_.end(), c, c + 3);
        weights_.push_back(weight);
    }
}

void LoadBalance::cut(Decomposition& decomposition) {
    decomposition.repartition(cells_, weights_);
    cells_.clear();
    weights_.clear();
}

bool LoadBalance::is_due(const Comm& comm, int owned) const {
    if (comm.size() == 1) return false;
    const double imbalance = load_imbalance(comm, owned);
    return imbalance >= max_load_imbalance_ && imbalance >= 1.05 * after_cut_;
}

std::vector<std::int64_t> LoadBalance::state(const Decomposition& decomposition) const {
    auto out = decomposition.state();
    out.insert(out.begin(), std::bit_cast<std::int64_t>(after_cut_));
    return out;
}

void LoadBalance::restore(std::span<const std::int64_t> state, Decomposition& decomposition) {
    after_cut_ = std::bit_cast<double>(state[0]);
    decomposition.restore(state.subspan(1));
}

} // namespace treacle
