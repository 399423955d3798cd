#include "solve/multigrid/coarsen.hpp"

#include <algorithm>
#include <bit>

namespace treacle::solve {

void sort_unique(CellSet& cells) {
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

void aggregate(Level& level, int coarsening_levels, RowOrder order, const CellSet& dropped) {
    auto& runs = level.runs;
    runs.clear();
    level.aggregate.assign(static_cast<std::size_t>(level.rows), -1);
    for (Index i = 0; i < level.rows; ++i) {
        const MortonKey key = level.keys[static_cast<std::size_t>(i)] >> (3 * coarsening_levels);
        if (!runs.empty() && runs.back().key == key && runs.back().end == i) {
            ++runs.back().end;
        } else if (!std::binary_search(dropped.begin(), dropped.end(), key)) {
            runs.push_back({key, i, i + 1});
        }
    }
    std::sort(runs.begin(), runs.end(), [order](const Run& a, const Run& b) {
        if (order == RowOrder::red_black && colour(a.key) != colour(b.key)) return colour(a.key) < colour(b.key);
        return a.key != b.key ? a.key < b.key : a.begin < b.begin;
    });
    level.group.clear();
    for (std::size_t k = 0; k < runs.size(); ++k) {
        if (k == 0 || runs[k].key != runs[k - 1].key) level.group.push_back(static_cast<Index>(k));
        std::fill(level.aggregate.begin() + runs[k].begin, level.aggregate.begin() + runs[k].end,
            static_cast<Index>(level.group.size()) - 1);
    }
    level.group.push_back(static_cast<Index>(runs.size()));
}

void AggregateIndex::number(const Comm& comm, Level& level) {
    own_ = level.aggregates();
    first_ = static_cast<Index>(comm.exclusive_sum(std::int64_t{own_}));
    of_halo_.clear();
    others_.clear();
    if (comm.size() == 1) return;
    numbers_.resize(static_cast<std::size_t>(level.rows));
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
        numbers_[i] = level.aggregate[i] < 0 ? -1.0 : double(first_ + level.aggregate[i]);
    }
    for (const double number : level.halo().gather(numbers_)) {
        of_halo_.push_back(static_cast<Index>(number));
        if (number >= 0) others_.push_back(static_cast<Index>(number));
    }
    std::sort(others_.begin(), others_.end());
    others_.erase(std::unique(others_.begin(), others_.end()), others_.end());
    for (auto& number : of_halo_) {
        if (number < 0) continue;
        const auto at = std::lower_bound(others_.begin(), others_.end(), number);
        number = own_ + static_cast<Index>(at - others_.begin());
    }
}

void Coarsener::number(const Comm& comm, Level& level) {
    index_.number(comm, level);
    scratch_.resize(static_cast<std::size_t>(level.rows));
    slot_.assign(index_.size(), -1);
}

MortonKey Coarsener::key_at(const CoarseRows& made, Index index) const {
    return index < index_.own() ? made.keys[static_cast<std::size_t>(index)]
                                : halo_keys_[static_cast<std::size_t>(index - index_.own())];
}

void Coarsener::add(Index index, double value) {
    if (index < 0) return;
    auto& slot = slot_[static_cast<std::size_t>(index)];
    if (slot < 0) {
        slot = static_cast<Index>(row_.size());
        row_.emplace_back(index, 0.0);
    }
    row_[static_cast<std::size_t>(slot)].second += value;
}

void Coarsener::sum_rows(const Level& level, Index aggregate) {
    const auto add_entries = [&](const Level::Block& block, const std::vector<Index>& indices, Index i) {
        Index k = block.offsets[i];
        const Index end = block.offsets[i + 1];
        // Neighbours come cell by cell.
        while (k < end) {
            const Index index = indices[static_cast<std::size_t>(block.columns[k])];
            double sum = 0;
            do {
                sum += block.values[k++];
            } while (k < end && indices[static_cast<std::size_t>(block.columns[k])] == index);
            add(index, sum);
        }
    };
    row_.clear();
    const auto at = static_cast<std::size_t>(aggregate);
    for (Index run = level.group[at]; run < level.group[at + 1]; ++run) {
        const auto& [key, begin, end] = level.runs[static_cast<std::size_t>(run)];
        for (Index i = begin; i < end; ++i) {
            add_entries(level.own(), level.aggregate, i);
            add_entries(level.other(), index_.of_halo(), i);
        }
    }
    for (const auto& [index, value] : row_) slot_[static_cast<std::size_t>(index)] = -1;
}

// Columns rise.
void Coarsener::end_row(CoarseRows& made) {
    for (auto& entry : row_) entry.first = index_.global(entry.first);
    std::sort(row_.begin(), row_.end());
    for (const auto& [column, value] : row_) {
        made.matrix.columns.push_back(column);
        made.matrix.values.push_back(value);
    }
    made.matrix.end_row();
}

namespace {
void start_rows(const Level& level, CoarseRows& made) {
    made.clear();
    for (Index a = 0; a < level.aggregates(); ++a) {
        const auto first = static_cast<std::size_t>(level.group[static_cast<std::size_t>(a)]);
        made.keys.push_back(level.runs[first].key);
    }
    if (level.walls.empty()) return;
    made.walls.assign(made.keys.size(), 0.0);
    for (std::size_t i = 0; i < level.walls.size(); ++i) {
        if (level.aggregate[i] >= 0) made.walls[static_cast<std::size_t>(level.aggregate[i])] += level.walls[i];
    }
}
} // namespace

void Coarsener::make_galerkin(const Comm& comm, Level& level, double divisor, CoarseRows& made) {
    number(comm, level);
    start_rows(level, made);
    for (Index a = 0; a < index_.own(); ++a) {
        sum_rows(level, a);
        for (auto& entry : row_) entry.second /= divisor;
        // Walls hold a level as much as they hold the rows.
        if (!made.walls.empty()) {
            for (auto& entry : row_) {
                if (entry.first == a) entry.second += (1 - 1 / divisor) * made.walls[static_cast<std::size_t>(a)];
            }
        }
        end_row(made);
    }
}

template <class Work>
void Coarsener::ask_others(Level& level, const Work& work) {
    const auto around = level.halo().gather(scratch_);
    for (std::size_t k = 0; k < around.size(); ++k) {
        if (index_.of_halo()[k] >= 0) work(static_cast<std::size_t>(index_.of_halo()[k]), around[k]);
    }
}

void Coarsener::find_keys(Level& level) {
    for (std::size_t i = 0; i < scratch_.size(); ++i) scratch_[i] = std::bit_cast<double>(level.keys[i]);
    ask_others(level, [this](std::size_t index, double value) {
        halo_keys_[index - static_cast<std::size_t>(index_.own())] = std::bit_cast<MortonKey>(value);
    });
}

// Means of the aggregates.
void Coarsener::find_densities(Level& level, std::span<const double> densities) {
    densities_.assign(slot_.size(), 0.0);
    for (Index a = 0; a < index_.own(); ++a) {
        const auto at = static_cast<std::size_t>(a);
        double sum = 0;
        Index rows = 0;
        for (Index k = level.group[at]; k < level.group[at + 1]; ++k) {
            const auto& run = level.runs[static_cast<std::size_t>(k)];
            for (Index i = run.begin; i < run.end; ++i) sum += densities[static_cast<std::size_t>(i)];
            rows += run.end - run.begin;
        }
        densities_[at] = sum / rows;
    }
    for (std::size_t i = 0; i < scratch_.size(); ++i) {
        const Index at = level.aggregate[i];
        scratch_[i] = at < 0 ? 1.0 : densities_[static_cast<std::size_t>(at)];
    }
}

void Coarsener::make_grid(const Comm& comm, Level& level, const Rediscretisation& rule, CoarseRows& made) {
    number(comm, level);
    start_rows(level, made);
    halo_keys_.assign(index_.others(), 0);
    densities_.clear();
    const bool several = comm.any(!rule.densities.empty());
    if (comm.size() > 1) find_keys(level);
    if (several) {
        find_densities(level, rule.densities);
        if (comm.size() > 1) ask_others(level, [this](std::size_t index, double value) { densities_[index] = value; });
    }
    for (Index a = 0; a < index_.own(); ++a) {
        sum_rows(level, a);
        const MortonKey here = made.keys[static_cast<std::size_t>(a)];
        double diagonal = made.walls.empty() ? 0.0 : made.walls[static_cast<std::size_t>(a)];
        auto found = row_;
        row_.clear();
        for (int face = 0; face < 6; ++face) {
            const MortonKey there = beside(here, face);
            bool liquid = false;
            for (const auto& [index, value] : found) {
                if (index == a || key_at(made, index) != there) continue;
                liquid = true;
                const double coupling = 2 * rule.coupling / (density_at(a) + density_at(index));
                row_.emplace_back(index, -coupling);
                diagonal += coupling;
            }
            const auto& dirichlet = rule.dirichlet;
            if (!liquid && std::binary_search(dirichlet.begin(), dirichlet.end(), there)) {
                diagonal += rule.coupling / density_at(a);
            }
        }
        row_.emplace_back(a, diagonal);
        end_row(made);
    }
}

} // namespace treacle::solve
