#include "surface/mesh/numbering.hpp"

#include <cmath>
#include <cstring>
#include <map>
#include <unordered_map>

namespace treacle::surface {

namespace {
struct Request {
    std::vector<std::int64_t> keys;
    std::vector<int> rows; // of the patch
};
using Requests = std::map<int, Request>; // by the owner's rank

std::vector<std::int64_t> words(const Message& message) {
    std::vector<std::int64_t> out(message.bytes.size() / sizeof(std::int64_t));
    std::memcpy(out.data(), message.bytes.data(), message.bytes.size());
    return out;
}
Message message_of(int rank, const std::vector<std::int64_t>& values) {
    Message out{rank, std::vector<char>(values.size() * sizeof(std::int64_t))};
    std::memcpy(out.bytes.data(), values.data(), out.bytes.size());
    return out;
}

// Vertices of the patch that the mesh has, in the mesh's order.
struct Numbering {
    std::vector<int> order;  // rows of the patch
    std::vector<int> row_of; // place of each vertex of the patch in the order, -1: not in the mesh

    explicit Numbering(std::size_t n) : row_of(n, -1) {}
    void add(int vertex) {
        row_of[static_cast<std::size_t>(vertex)] = static_cast<int>(order.size());
        order.push_back(vertex);
    }
};

// visit(corners) for the triangles of the patch that are kept.
template <class Visit>
void each_kept(const KeptPatch& kept, const Visit& visit) {
    const auto& patch = kept.patch;
    for (int t = 0; t < patch.triangles; ++t) {
        if (kept.kept[static_cast<std::size_t>(t)] != 0) visit(&patch.corner[static_cast<std::size_t>(patch.per * t)]);
    }
}

std::vector<char> used_by_triangles(const KeptPatch& kept) {
    std::vector<char> used(static_cast<std::size_t>(kept.patch.vertices), 0);
    each_kept(kept, [&](const int* corner) {
        for (int k = 0; k < kept.patch.per; ++k) used[static_cast<std::size_t>(corner[k])] = 1;
    });
    return used;
}

// Used vertices that other ranks own.
Requests requests_to_owners(
    const Comm& comm, const HostPatch& patch, const VertexOwners& owners, const std::vector<char>& used) {
    Requests out;
    if (comm.size() == 1) return out;
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (used[v] == 0) continue;
        const int rank = owners.owner(patch.key[v]);
        if (rank == comm.rank()) continue;
        out[rank].keys.push_back(patch.key[v]);
        out[rank].rows.push_back(static_cast<int>(v));
    }
    return out;
}

// Collective: sends the requests, and returns those of other ranks.
std::vector<Message> exchange_requests(const Comm& comm, const Requests& requests) {
    std::vector<Message> outgoing;
    for (const auto& [rank, request] : requests) outgoing.push_back(message_of(rank, request.keys));
    return comm.size() > 1 ? exchange_sparse(comm, outgoing) : std::vector<Message>();
}

// Vertices of the patch by their keys.
std::unordered_map<std::int64_t, int> rows_by_key(const HostPatch& patch) {
    std::unordered_map<std::int64_t, int> rows;
    rows.reserve(static_cast<std::size_t>(patch.vertices));
    for (std::size_t v = 0; v < static_cast<std::size_t>(patch.vertices); ++v)
        rows.emplace(patch.key[v], static_cast<int>(v));
    return rows;
}

// Collective: numbers this rank's own vertices, those that others need among them, and gets the numbers of the rest
// from their owners.
Numbering number_vertices(const Comm& comm, const KeptPatch& kept, const VertexOwners& owners, Mesh& mesh) {
    const auto& patch = kept.patch;
    auto used = used_by_triangles(kept);
    const auto requests = requests_to_owners(comm, patch, owners, used);
    const auto asked = exchange_requests(comm, requests);
    const auto rows = asked.empty() ? std::unordered_map<std::int64_t, int>() : rows_by_key(patch);
    for (const auto& message : asked) {
        for (const auto key : words(message)) used[static_cast<std::size_t>(rows.at(key))] = 1;
    }
    for (const auto& [rank, request] : requests) {
        for (const int v : request.rows) used[static_cast<std::size_t>(v)] = 0; // numbered by its owner
    }
    Numbering out(used.size());
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (used[v] != 0) out.add(static_cast<int>(v));
    }
    mesh.owned = static_cast<std::int64_t>(out.order.size());
    mesh.first_vertex = comm.exclusive_sum(mesh.owned);
    mesh.total_vertices = comm.sum(mesh.owned);
    mesh.global.clear();
    for (std::int64_t v = 0; v < mesh.owned; ++v) mesh.global.push_back(mesh.first_vertex + v);
    if (comm.size() == 1) return out;
    std::vector<Message> answers;
    for (const auto& message : asked) {
        auto keys = words(message);
        for (auto& key : keys) key = mesh.first_vertex + out.row_of[static_cast<std::size_t>(rows.at(key))];
        answers.push_back(message_of(message.rank, keys));
    }
    for (const auto& message : exchange_sparse(comm, answers)) {
        const auto numbers = words(message);
        const auto& request = requests.at(message.rank);
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            out.add(request.rows[k]);
            mesh.global.push_back(numbers[k]);
        }
    }
    return out;
}

// Collective.
void number_triangles(const Comm& comm, const KeptPatch& kept, const Numbering& numbering, Mesh& mesh) {
    mesh.triangles.clear();
    each_kept(kept, [&](const int* corner) {
        auto& triangle = mesh.triangles.emplace_back(std::array<int, 3>{-1, -1, -1});
        for (int k = 0; k < kept.patch.per; ++k)
            triangle[static_cast<std::size_t>(k)] = numbering.row_of[static_cast<std::size_t>(corner[k])];
    });
    const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
    mesh.first_triangle = comm.exclusive_sum(triangles);
    mesh.total_triangles = comm.sum(triangles);
}

void copy_values(const HostPatch& patch, const VertexValues& values, const std::vector<int>& order, Mesh& mesh) {
    const auto n = static_cast<std::size_t>(patch.vertices);
    const auto normal = on_host(values.normal), velocity = on_host(values.velocity),
               pressure = on_host(values.pressure);
    const auto liquid = on_host(values.liquid);
    const auto scalar = on_host(values.scalar);
    const auto size = order.size();
    mesh.vertices.resize(3 * size);
    mesh.normals.resize(3 * size);
    mesh.velocity.resize(3 * size);
    mesh.pressure.resize(size);
    mesh.liquid.resize(size);
    mesh.key.resize(size);
    mesh.scalars.assign(static_cast<std::size_t>(values.scalars), std::vector<double>(size));
    for (std::size_t v = 0; v < size; ++v) {
        const auto from = static_cast<std::size_t>(order[v]);
        for (std::size_t k = 0; k < 3; ++k) {
            mesh.vertices[3 * v + k] = patch.position[3 * from + k];
            mesh.normals[3 * v + k] = normal(3 * from + k);
            mesh.velocity[3 * v + k] = velocity(3 * from + k);
        }
        mesh.pressure[v] = pressure(from);
        mesh.liquid[v] = liquid(from);
        mesh.key[v] = patch.key[from];
        for (std::size_t k = 0; k < mesh.scalars.size(); ++k) mesh.scalars[k][v] = scalar(k * n + from);
    }
}
} // namespace

void number_mesh(
    const Comm& comm, const KeptPatch& kept, const VertexOwners& owners, const VertexValues& values, Mesh& mesh) {
    const auto numbering = number_vertices(comm, kept, owners, mesh);
    number_triangles(comm, kept, numbering, mesh);
    copy_values(kept.patch, values, numbering.order, mesh);
}

double area_of(const Mesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles) {
        double u[3], w[3] = {0, 0, 1};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto at = [&](int v) { return mesh.vertices[3 * static_cast<std::size_t>(v) + k]; };
            u[k] = at(t[1]) - at(t[0]);
            if (mesh.dimensions == 3) w[k] = at(t[2]) - at(t[0]);
        }
        const double c[3] = {u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]};
        sum += std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]) * (mesh.dimensions == 3 ? 0.5 : 1);
    }
    return sum;
}

} // namespace treacle::surface
