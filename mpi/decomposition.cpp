#include "mpi/decomposition.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace treacle {

namespace {
// One box of the bisection still to be cut among the ranks [first, last).
struct Part {
    CellBox box;
    int first, last;
    int parent; // node whose child this is, or -1
    bool is_left;
};

// Cost of a ghost for its rank, in owned particles: a ghost is sent, received and stored, not computed.
constexpr double ghost_cost = 0.3;
// Coarse cells of multigrid that a cut divides are two of half the size, and worse ones: a plane that divides none of a
// level's is worth this much of the least load, on as many levels.
constexpr double whole_cells_worth = 0.02;
constexpr int most_levels = 2;

struct Cut {
    int axis = 0;
    int at = 0;          // first layer of the right side
    double load = 1e300; // of the heavier side, over what each of its ranks should have
};

int extent(const CellBox& box, int axis) { return std::max(0, box.hi[axis] - box.lo[axis]); }

int longest_axis(const CellBox& box) {
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
        if (extent(box, k) > extent(box, axis)) axis = k;
    }
    return axis;
}

// The planes across `axis`, each with the load of its heavier side, the layer beyond the plane as ghosts; both sides
// keep a layer while there are layers to give: use(Cut).
template <class Use>
void each_plane(std::span<const double> histogram, double fraction, int axis, int lo, const Use& use) {
    double total = 0;
    for (const double w : histogram) total += w;
    double below = 0;
    for (std::size_t k = 1; k < histogram.size(); ++k) {
        const double left = histogram[k - 1], right = histogram[k];
        below += left;
        use(Cut{axis, lo + static_cast<int>(k),
            std::max((below + ghost_cost * right) / fraction, (total - below + ghost_cost * left) / (1 - fraction))});
    }
}

// Levels of coarse cells, each of 2 x 2 x 2 of the level before, that a plane divides none of.
int undivided_levels(int plane) {
    return plane == 0 ? most_levels : std::min(most_levels, std::countr_zero(static_cast<unsigned>(plane)));
}

double worth(const Cut& cut) { return cut.load * (1 - whole_cells_worth * undivided_levels(cut.at)); }

// Best cut among all planes across all axes; `histograms` are the weights of the layers along x, then y, then z.
Cut best_cut(std::span<const double> histograms, double fraction, const CellBox& box) {
    const int longest = longest_axis(box);
    std::size_t start = 0;
    double total = 0;
    Cut best{longest, box.hi[longest], 1e300};
    for (int k = 0; k < 3; ++k) {
        const auto layers = static_cast<std::size_t>(extent(box, k));
        const auto histogram = histograms.subspan(start, layers);
        start += layers;
        if (k == 0) {
            for (const double w : histogram) total += w;
        }
        each_plane(histogram, fraction, k, box.lo[k], [&](const Cut& cut) {
            if (worth(cut) < worth(best)) best = cut;
        });
    }
    const int n = extent(box, longest);
    if (total > 0 || n <= 1) return best;
    return {longest, box.lo[longest] + std::clamp(static_cast<int>(std::lround(fraction * n)), 1, n - 1), 0};
}
// Weights of the layers of each part, along x, then y, then z.
struct Histograms {
    std::vector<std::size_t> start{0}; // of each part's three
    std::vector<double> weight;

    std::span<const double> of(std::size_t part) const {
        return std::span(weight).subspan(start[part], start[part + 1] - start[part]);
    }
};

// A level of the bisection: its open parts, how each is cut, and the parts that this leaves.
struct Level {
    std::vector<Part> parts, next;
    std::vector<Cut> cuts;
    std::vector<int> left, right; // of `next`, -1: not cut

    explicit Level(std::vector<Part> open)
        : parts(std::move(open)), cuts(parts.size()), left(parts.size(), -1), right(parts.size(), -1) {}

    // Cuts a part in two, the children of a node.
    void split(std::size_t p, const Cut& cut, int node) {
        const auto& part = parts[p];
        const int middle = part.first + (part.last - part.first) / 2;
        Part low{part.box, part.first, middle, node, true};
        Part high{part.box, middle, part.last, node, false};
        low.box.hi[cut.axis] = cut.at;
        high.box.lo[cut.axis] = cut.at;
        cuts[p] = cut;
        left[p] = static_cast<int>(next.size());
        next.push_back(low);
        right[p] = static_cast<int>(next.size());
        next.push_back(high);
    }
};

// Cells with a weight, and the open part that each lies in; -1: in a box that is cut no more.
struct WeightedCells {
    std::span<const int> cells; // [n][3]
    std::span<const double> weights;
    std::vector<int> part_of;

    WeightedCells(std::span<const int> indices, std::span<const double> loads)
        : cells(indices), weights(loads), part_of(loads.size(), 0) {}

    // Collective: sums over all ranks.
    Histograms histograms(const Comm& comm, const std::vector<Part>& parts) const {
        Histograms out;
        for (const auto& part : parts) {
            std::size_t layers = 0;
            for (int k = 0; k < 3; ++k) layers += static_cast<std::size_t>(extent(part.box, k));
            out.start.push_back(out.start.back() + layers);
        }
        out.weight.assign(out.start.back(), 0.0);
        for (std::size_t i = 0; i < weights.size(); ++i) {
            if (part_of[i] < 0) continue;
            const auto p = static_cast<std::size_t>(part_of[i]);
            const auto& box = parts[p].box;
            std::size_t from = out.start[p];
            for (int k = 0; k < 3; ++k) {
                const int layer = cells[3 * i + static_cast<std::size_t>(k)] - box.lo[k];
                out.weight[from + static_cast<std::size_t>(layer)] += weights[i];
                from += static_cast<std::size_t>(extent(box, k));
            }
        }
        comm.sum(std::span(out.weight));
        return out;
    }
    // Goes on to the parts of the next level.
    void descend(const Level& level) {
        for (std::size_t i = 0; i < weights.size(); ++i) {
            if (part_of[i] < 0) continue;
            const auto p = static_cast<std::size_t>(part_of[i]);
            if (level.left[p] < 0) {
                part_of[i] = -1;
            } else {
                const bool is_left = cells[3 * i + static_cast<std::size_t>(level.cuts[p].axis)] < level.cuts[p].at;
                part_of[i] = is_left ? level.left[p] : level.right[p];
            }
        }
    }
};
} // namespace

Decomposition::Decomposition(const Comm& comm, const CellGrid& grid)
    : comm_(comm), grid_(grid), boxes_(static_cast<std::size_t>(comm.size())) {
    repartition({}, {});
}

void Decomposition::repartition(std::span<const int> cells, std::span<const double> weights) {
    WeightedCells weighted(cells, weights);
    std::vector<Part> parts{{grid_.all(), 0, comm_.size(), -1, false}};
    nodes_.clear();
    int root = -1;
    while (!parts.empty()) {
        Level level(std::move(parts));
        const auto histograms = weighted.histograms(comm_, level.parts);
        for (std::size_t p = 0; p < level.parts.size(); ++p) {
            const auto& part = level.parts[p];
            const int ranks = part.last - part.first;
            int value = -1 - part.first;
            if (ranks == 1) {
                boxes_[static_cast<std::size_t>(part.first)] = part.box;
            } else {
                const int lower = ranks / 2;
                const double fraction = double(lower) / ranks;
                const auto cut = best_cut(histograms.of(p), fraction, part.box);
                value = static_cast<int>(nodes_.size());
                nodes_.push_back({cut.axis, cut.at, 0, 0});
                level.split(p, cut, value);
            }
            if (part.parent < 0) {
                root = value;
            } else {
                auto& parent = nodes_[static_cast<std::size_t>(part.parent)];
                (part.is_left ? parent.left : parent.right) = value;
            }
        }
        weighted.descend(level);
        parts = std::move(level.next);
    }
    upload(nodes_, root);
}

void Decomposition::upload(const std::vector<Node>& nodes, int root) {
    const auto copy = [&](Array<int>& to, int Node::*member) {
        to = Array<int>("treacle::tree", nodes.size());
        auto host = Kokkos::create_mirror_view(to);
        for (std::size_t k = 0; k < nodes.size(); ++k) host(k) = nodes[k].*member;
        Kokkos::deep_copy(to, host);
    };
    copy(tree_.axis, &Node::axis);
    copy(tree_.cut, &Node::cut);
    copy(tree_.left, &Node::left);
    copy(tree_.right, &Node::right);
    tree_.root = root;
}

// Layout: ranks, root, boxes [rank][6], nodes [node][4].
std::vector<std::int64_t> Decomposition::state() const {
    std::vector<std::int64_t> out{static_cast<std::int64_t>(boxes_.size()), tree_.root};
    for (const auto& box : boxes_) {
        for (const int v : box.lo) out.push_back(v);
        for (const int v : box.hi) out.push_back(v);
    }
    for (const auto& node : nodes_) {
        for (const int v : {node.axis, node.cut, node.left, node.right}) out.push_back(v);
    }
    return out;
}

void Decomposition::restore(std::span<const std::int64_t> state) {
    std::size_t at = 2;
    const auto next = [&] { return static_cast<int>(state[at++]); };
    for (auto& box : boxes_) {
        for (int& v : box.lo) v = next();
        for (int& v : box.hi) v = next();
    }
    nodes_.clear();
    while (at + 4 <= state.size()) {
        Node node{};
        node.axis = next();
        node.cut = next();
        node.left = next();
        node.right = next();
        nodes_.push_back(node);
    }
    upload(nodes_, static_cast<int>(state[1]));
}

} // namespace treacle
