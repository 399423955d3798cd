#include "surface/mesh/mesh_check.hpp"

#include "mpi/exchange.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <tuple>
#include <vector>

namespace treacle::surface {

namespace {
// A triangle relative to its corner `vertex`: its other corners, in its order. In 2D a segment that leaves the vertex
// (`to`) or reaches it (`from`), the other is -1.
struct Spoke {
    std::int64_t vertex, from, to;
    bool operator<(const Spoke& other) const {
        return std::tie(vertex, from, to) < std::tie(other.vertex, other.from, other.to);
    }
};

bool is_flat(const Mesh& mesh, const std::array<int, 3>& t) {
    if (mesh.dimensions == 2) return t[0] == t[1];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return true;
    double u[3], v[3];
    for (std::size_t k = 0; k < 3; ++k) {
        const auto at = [&](int corner) {
            return mesh.vertices[3 * static_cast<std::size_t>(t[static_cast<std::size_t>(corner)]) + k];
        };
        u[k] = at(1) - at(0);
        v[k] = at(2) - at(0);
    }
    return u[1] * v[2] == u[2] * v[1] && u[2] * v[0] == u[0] * v[2] && u[0] * v[1] == u[1] * v[0];
}

// Each spoke to the rank that checks its vertex.
std::vector<Spoke> exchange_spokes(const Comm& comm, const std::vector<std::vector<Spoke>>& outgoing) {
    std::vector<Message> messages;
    for (std::size_t rank = 0; rank < outgoing.size(); ++rank) {
        if (outgoing[rank].empty()) continue;
        Message message{static_cast<int>(rank), std::vector<char>(outgoing[rank].size() * sizeof(Spoke))};
        std::memcpy(message.bytes.data(), outgoing[rank].data(), message.bytes.size());
        messages.push_back(std::move(message));
    }
    std::vector<Spoke> spokes;
    for (const auto& message : exchange_sparse(comm, messages)) {
        const auto before = spokes.size();
        spokes.resize(before + message.bytes.size() / sizeof(Spoke));
        std::memcpy(spokes.data() + before, message.bytes.data(), message.bytes.size());
    }
    return spokes;
}

// The spokes of one vertex, in order: their rims must join to one ring.
void look_at(std::span<const Spoke> spokes, MeshFaults& faults) {
    const auto next = [&](std::int64_t from) {
        const auto at = std::lower_bound(
            spokes.begin(), spokes.end(), from, [](const Spoke& s, std::int64_t v) { return s.from < v; });
        return at != spokes.end() && at->from == from ? at : spokes.end();
    };
    std::int64_t open = 0, crowded = 0;
    for (std::size_t k = 0; k < spokes.size(); ++k) {
        if (k > 0 && spokes[k].from == spokes[k - 1].from) ++crowded;
        if (next(spokes[k].to) == spokes.end()) ++open;
    }
    faults.open += open;
    faults.crowded += crowded;
    if (open > 0 || crowded > 0) return;
    auto at = spokes.begin();
    std::size_t steps = 0;
    do {
        at = next(at->to);
        ++steps;
    } while (at != spokes.begin() && steps < spokes.size());
    if (steps < spokes.size()) ++faults.pinched;
}

void look_at_plane(std::span<const Spoke> spokes, MeshFaults& faults) {
    const auto ends = std::count_if(spokes.begin(), spokes.end(), [](const Spoke& s) { return s.to < 0; });
    const auto left = std::ssize(spokes) - ends;
    faults.open += std::abs(ends - left);
    if (ends == left && ends > 1) ++faults.pinched;
}
} // namespace

MeshFaults check_mesh(const Comm& comm, const Mesh& mesh) {
    MeshFaults faults;
    std::vector<std::vector<Spoke>> outgoing(static_cast<std::size_t>(comm.size()));
    const auto add = [&](std::int64_t vertex, std::int64_t from, std::int64_t to) {
        outgoing[static_cast<std::size_t>(vertex % comm.size())].push_back({vertex, from, to});
    };
    for (const auto& t : mesh.triangles) {
        if (is_flat(mesh, t)) ++faults.flat;
        const auto number = [&](std::size_t k) { return mesh.global[static_cast<std::size_t>(t[k])]; };
        if (mesh.dimensions == 2) {
            add(number(0), -1, number(1));
            add(number(1), number(0), -1);
            continue;
        }
        for (std::size_t k = 0; k < 3; ++k) add(number(k), number((k + 1) % 3), number((k + 2) % 3));
    }
    auto spokes = exchange_spokes(comm, outgoing);
    std::sort(spokes.begin(), spokes.end());
    for (std::size_t begin = 0; begin < spokes.size();) {
        auto end = begin;
        while (end < spokes.size() && spokes[end].vertex == spokes[begin].vertex) ++end;
        const std::span<const Spoke> fan(spokes.data() + begin, end - begin);
        if (mesh.dimensions == 2)
            look_at_plane(fan, faults);
        else
            look_at(fan, faults);
        begin = end;
    }
    std::int64_t sums[] = {faults.open, faults.crowded, faults.pinched, faults.flat};
    comm.sum(std::span<std::int64_t>(sums));
    return {sums[0], sums[1], sums[2], sums[3]};
}

} // namespace treacle::surface
