#include "solve/multigrid/rigid_coarsen.hpp"

#include <algorithm>

namespace treacle::solve {

Index DisconnectedSplit::root(Index row) {
    auto at = static_cast<std::size_t>(row);
    while (parent_[at] != static_cast<Index>(at)) {
        parent_[at] = parent_[static_cast<std::size_t>(parent_[at])];
        at = static_cast<std::size_t>(parent_[at]);
    }
    return static_cast<Index>(at);
}

void DisconnectedSplit::unite(Index a, Index b) {
    a = root(a);
    b = root(b);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
}

// Rows of an aggregate belong together when some row, of it or not, is joined to both: of a surface that boxes cut, one
// layer of rows may be joined to the next box alone.
void DisconnectedSplit::join_rows(const Level& level, int joined) {
    parent_.resize(static_cast<std::size_t>(level.rows));
    first_met_.assign(static_cast<std::size_t>(level.aggregates()), {-1, -1});
    for (Index i = 0; i < level.rows; ++i) parent_[static_cast<std::size_t>(i)] = i - i % joined;
    const auto& own = level.own();
    for (Index i = 0; i < level.rows; ++i) {
        const Index hub = i / joined;
        for (Index e = own.offsets[i]; e < own.offsets[i + 1]; ++e) {
            const Index j = own.columns[e], aggregate = level.aggregate[static_cast<std::size_t>(j)];
            if (aggregate < 0 || own.values[e] == 0) continue;
            auto& [met_by, first] = first_met_[static_cast<std::size_t>(aggregate)];
            if (met_by != hub) {
                met_by = hub;
                first = j;
            } else if (parent_[static_cast<std::size_t>(first)] != parent_[static_cast<std::size_t>(j)]) {
                unite(first, j);
            }
        }
    }
}

// True when the rows from first on are joined to no others.
bool DisconnectedSplit::alone(const Level& level, Index first, int joined) const {
    for (Index i = first; i < first + joined; ++i) {
        const auto& own = level.own();
        for (Index e = own.offsets[i]; e < own.offsets[i + 1]; ++e) {
            if (own.values[e] != 0 && (own.columns[e] < first || own.columns[e] >= first + joined)) return false;
        }
        const auto& other = level.other();
        for (Index e = other.offsets[i]; e < other.offsets[i + 1]; ++e) {
            if (other.values[e] != 0) return false;
        }
    }
    return true;
}

void DisconnectedSplit::split(Level& level, int joined) {
    join_rows(level, joined);
    pieces_.clear();
    for (const auto& run : level.runs) {
        for (Index i = run.begin; i < run.end; i += joined) {
            const Index from = root(i);
            if (joined > 1 && alone(level, i, joined)) {
                std::fill_n(level.aggregate.begin() + i, joined, -1);
            } else if (!pieces_.empty() && pieces_.back().end == i && pieces_.back().root == from &&
                       pieces_.back().key == run.key) {
                pieces_.back().end += joined;
            } else {
                pieces_.push_back({run.key, from, i, i + joined});
            }
        }
    }
    std::sort(pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) {
        if (a.key != b.key) return a.key < b.key;
        return a.root != b.root ? a.root < b.root : a.begin < b.begin;
    });
    level.runs.clear();
    level.group.clear();
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
        const auto& piece = pieces_[k];
        if (k == 0 || piece.key != pieces_[k - 1].key || piece.root != pieces_[k - 1].root) {
            level.group.push_back(static_cast<Index>(k));
        }
        level.runs.push_back({piece.key, piece.begin, piece.end});
        std::fill(level.aggregate.begin() + piece.begin, level.aggregate.begin() + piece.end,
            static_cast<Index>(level.group.size()) - 1);
    }
    level.group.push_back(static_cast<Index>(pieces_.size()));
}

} // namespace treacle::solve
