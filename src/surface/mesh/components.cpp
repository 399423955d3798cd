#include "surface/mesh/components.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <unordered_map>

namespace treacle::surface {

HostPatch to_host(const Patch& patch) {
    HostPatch out;
    out.vertices = patch.vertices;
    out.triangles = patch.triangles;
    out.per = patch.corners_per_triangle;
    const auto copy = [](const auto& view, std::int64_t n, auto& to) {
        const auto host = on_host(view);
        to.assign(host.data(), host.data() + n);
    };
    copy(patch.position, 3 * std::int64_t(patch.vertices), out.position);
    copy(patch.key, patch.vertices, out.key);
    copy(patch.corner, std::int64_t(out.per) * patch.triangles, out.corner);
    copy(patch.own, patch.triangles, out.own);
    return out;
}

VertexOwners::VertexOwners(const Decomposition& decomposition, const Lattice& lattice)
    : decomposition_(decomposition), lattice_(lattice) {
    const auto& boxes = decomposition.boxes();
    const auto around = grown(decomposition.box(), 1, lattice.dimensions);
    for (int rank = 0; rank < static_cast<int>(boxes.size()); ++rank) {
        const auto& box = boxes[static_cast<std::size_t>(rank)];
        if (!box.empty() && !intersect(around, box).empty()) near_.push_back(rank);
    }
}

int VertexOwners::owner(std::int64_t key) const {
    int fine[3], tile[3] = {0, 0, 0};
    for (int k = 0; k < 3; ++k) fine[k] = static_cast<int>((key >> (21 * k)) & ((1 << 21) - 1)) - (1 << 20);
    for (int k = 0; k < lattice_.dimensions; ++k) {
        const int node = floor_divide(fine[k], 2) - tile_edge * lattice_.base[k];
        tile[k] = std::clamp(floor_divide(node, tile_edge), 0, lattice_.grid.count[k] - 1);
    }
    if (decomposition_.box().contains(tile)) return decomposition_.comm().rank();
    for (const int rank : near_) {
        if (decomposition_.boxes()[static_cast<std::size_t>(rank)].contains(tile)) return rank;
    }
    return -1;
}

namespace {
constexpr double volume_unit = 1 << 24; // parts of spacing^dimensions that volumes are counted in

class Sets {
public:
    explicit Sets(int n) : parent_(static_cast<std::size_t>(n)) { std::iota(parent_.begin(), parent_.end(), 0); }
    int find(int a) {
        while (parent_[static_cast<std::size_t>(a)] != a) {
            auto& up = parent_[static_cast<std::size_t>(a)];
            up = parent_[static_cast<std::size_t>(up)];
            a = up;
        }
        return a;
    }
    void join(int a, int b) {
        a = find(a);
        b = find(b);
        parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }

private:
    std::vector<int> parent_;
};

template <class T>
std::vector<T> unpack(const Message& message) {
    std::vector<T> out(message.bytes.size() / sizeof(T));
    std::memcpy(out.data(), message.bytes.data(), message.bytes.size());
    return out;
}
template <class T>
Message pack(int rank, const std::vector<T>& values) {
    Message out{rank, std::vector<char>(values.size() * sizeof(T))};
    std::memcpy(out.bytes.data(), values.data(), out.bytes.size());
    return out;
}

// Signed measure between a triangle (segment) and the origin, in spacings.
double enclosed(const HostPatch& patch, int t, double spacing) {
    Vec3 x[3];
    for (int k = 0; k < patch.per; ++k) {
        const auto v = static_cast<std::size_t>(patch.corner[static_cast<std::size_t>(patch.per * t + k)]);
        for (std::size_t a = 0; a < 3; ++a) x[k][a] = patch.position[3 * v + a] / spacing;
    }
    if (patch.per == 2) return (x[0][0] * x[1][1] - x[0][1] * x[1][0]) / 2;
    const Vec3 c{x[1][1] * x[2][2] - x[1][2] * x[2][1], x[1][2] * x[2][0] - x[1][0] * x[2][2],
        x[1][0] * x[2][1] - x[1][1] * x[2][0]};
    return (x[0][0] * c[0] + x[0][1] * c[1] + x[0][2] * c[2]) / 6;
}

// Labels spread over shared vertices until none changes.
class Labels {
public:
    Labels(
        const Comm& comm, const HostPatch& patch, const VertexOwners& owners, Sets& sets, const std::vector<char>& used)
        : comm_(comm) {
        label_.assign(static_cast<std::size_t>(patch.vertices), std::numeric_limits<std::int64_t>::max());
        for (int v = 0; v < patch.vertices; ++v) {
            auto& label = label_[static_cast<std::size_t>(sets.find(v))];
            if (used[static_cast<std::size_t>(v)]) label = std::min(label, patch.key[static_cast<std::size_t>(v)]);
        }
        if (comm.size() == 1) return;
        std::map<int, std::vector<std::int64_t>> asked;
        for (int v = 0; v < patch.vertices; ++v) {
            if (!used[static_cast<std::size_t>(v)]) continue;
            const auto key = patch.key[static_cast<std::size_t>(v)];
            const int rank = owners.owner(key);
            if (rank == comm.rank() || rank < 0) continue;
            asked[rank].push_back(key);
            roots_[rank].push_back(sets.find(v));
        }
        std::vector<Message> messages;
        messages.reserve(asked.size());
        for (const auto& [rank, keys] : asked) messages.push_back(pack(rank, keys));
        std::unordered_map<std::int64_t, int> rows;
        const auto arrived = exchange_sparse(comm, messages);
        if (!arrived.empty()) {
            for (int v = 0; v < patch.vertices; ++v) rows.emplace(patch.key[static_cast<std::size_t>(v)], v);
        }
        for (const auto& message : arrived) {
            for (const auto key : unpack<std::int64_t>(message)) {
                const auto at = rows.find(key);
                served_[message.rank].push_back(at == rows.end() ? -1 : sets.find(at->second));
            }
        }
        while (comm.any(spread())) {
        }
    }
    std::int64_t of(int root) const { return label_[static_cast<std::size_t>(root)]; }

private:
    bool spread() {
        const bool up = take(exchange_sparse(comm_, collect(roots_)), served_);
        const bool down = take(exchange_sparse(comm_, collect(served_)), roots_);
        return up || down;
    }
    std::vector<Message> collect(const std::map<int, std::vector<int>>& lists) const {
        std::vector<Message> out;
        for (const auto& [rank, roots] : lists) {
            std::vector<std::int64_t> labels;
            for (const int root : roots)
                labels.push_back(root < 0 ? std::numeric_limits<std::int64_t>::max() : of(root));
            out.push_back(pack(rank, labels));
        }
        return out;
    }
    bool take(const std::vector<Message>& messages, const std::map<int, std::vector<int>>& lists) {
        bool changed = false;
        for (const auto& message : messages) {
            const auto labels = unpack<std::int64_t>(message);
            const auto& roots = lists.at(message.rank);
            for (std::size_t k = 0; k < labels.size(); ++k) {
                if (roots[k] < 0 || labels[k] >= of(roots[k])) continue;
                label_[static_cast<std::size_t>(roots[k])] = labels[k];
                changed = true;
            }
        }
        return changed;
    }

    Comm comm_;
    std::vector<std::int64_t> label_;                // [vertices] of the root of each set
    std::map<int, std::vector<int>> roots_, served_; // by rank: sets of vertices that it owns, that it requested
};

// Collective: the sum of a label's volumes over the ranks, for the labels that this rank has.
std::map<std::int64_t, std::int64_t> sum_volumes(const Comm& comm, const std::map<std::int64_t, std::int64_t>& mine,
    std::int64_t limit, Summary& summary, double unit) {
    std::map<int, std::vector<std::int64_t>> parts;
    for (const auto& [label, volume] : mine) {
        auto& part = parts[static_cast<int>(label % comm.size())];
        part.push_back(label);
        part.push_back(volume);
    }
    std::vector<Message> messages;
    messages.reserve(parts.size());
    for (const auto& [rank, part] : parts) messages.push_back(pack(rank, part));
    const auto arrived = exchange_sparse(comm, messages);
    std::map<std::int64_t, std::int64_t> total;
    for (const auto& message : arrived) {
        const auto part = unpack<std::int64_t>(message);
        for (std::size_t k = 0; k < part.size(); k += 2) total[part[k]] += part[k + 1];
    }
    std::int64_t figures[4] = {0, 0, 0, 0}; // kept, dropped, volume of these
    for (const auto& [label, volume] : total) {
        const bool dropped = std::abs(volume) < limit;
        ++figures[dropped ? 1 : 0];
        figures[dropped ? 3 : 2] += volume;
    }
    comm.sum(std::span<std::int64_t>(figures));
    summary.components = figures[0];
    summary.dropped = figures[1];
    summary.volume = static_cast<double>(figures[2]) * unit;
    summary.dropped_volume = static_cast<double>(figures[3]) * unit;
    std::vector<Message> answers;
    for (const auto& message : arrived) {
        auto part = unpack<std::int64_t>(message);
        for (std::size_t k = 0; k < part.size(); k += 2) part[k + 1] = total[part[k]];
        answers.push_back(pack(message.rank, part));
    }
    std::map<std::int64_t, std::int64_t> out;
    for (const auto& message : exchange_sparse(comm, answers)) {
        const auto part = unpack<std::int64_t>(message);
        for (std::size_t k = 0; k < part.size(); k += 2) out[part[k]] = part[k + 1];
    }
    return out;
}
} // namespace

std::vector<char> find_components(const Comm& comm, const HostPatch& patch, const VertexOwners& owners, double spacing,
    double min_volume, Summary& summary) {
    Sets sets(patch.vertices);
    std::vector<char> used(static_cast<std::size_t>(patch.vertices), 0);
    const auto corner = [&](int t, int k) { return patch.corner[static_cast<std::size_t>(patch.per * t + k)]; };
    for (int t = 0; t < patch.triangles; ++t) {
        if (patch.own[static_cast<std::size_t>(t)] == 0) continue;
        for (int k = 0; k < patch.per; ++k) {
            used[static_cast<std::size_t>(corner(t, k))] = 1;
            if (k > 0) sets.join(corner(t, 0), corner(t, k));
        }
    }
    const Labels labels(comm, patch, owners, sets, used);
    std::map<std::int64_t, std::int64_t> volumes;
    std::vector<std::int64_t> by_root(static_cast<std::size_t>(patch.vertices), 0);
    for (int t = 0; t < patch.triangles; ++t) {
        if (patch.own[static_cast<std::size_t>(t)] == 0) continue;
        by_root[static_cast<std::size_t>(sets.find(corner(t, 0)))] +=
            std::llround(enclosed(patch, t, spacing) * volume_unit);
    }
    for (int v = 0; v < patch.vertices; ++v) {
        if (used[static_cast<std::size_t>(v)] && sets.find(v) == v)
            volumes[labels.of(v)] += by_root[static_cast<std::size_t>(v)];
    }
    const double unit = std::pow(spacing, patch.per) / volume_unit;
    const auto limit = static_cast<std::int64_t>(min_volume * volume_unit);
    const auto total = sum_volumes(comm, volumes, limit, summary, unit);
    std::vector<char> kept(static_cast<std::size_t>(patch.triangles), 0);
    std::vector<char> keep_root(static_cast<std::size_t>(patch.vertices), 0);
    for (int v = 0; v < patch.vertices; ++v) {
        if (!used[static_cast<std::size_t>(v)] || sets.find(v) != v) continue;
        keep_root[static_cast<std::size_t>(v)] = std::abs(total.at(labels.of(v))) >= limit ? 1 : 0;
    }
    for (int t = 0; t < patch.triangles; ++t) {
        if (patch.own[static_cast<std::size_t>(t)] != 0)
            kept[static_cast<std::size_t>(t)] = keep_root[static_cast<std::size_t>(sets.find(corner(t, 0)))];
    }
    return kept;
}

} // namespace treacle::surface
