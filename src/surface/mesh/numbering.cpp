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
} // namespace

void number_mesh(const Comm& comm, const HostPatch& patch, const std::vector<char>& kept, const VertexOwners& owners,
                 const VertexValues& values, Mesh& mesh) {
    const auto n = static_cast<std::size_t>(patch.vertices);
    std::vector<char> used(n, 0); // 1: by a triangle of this rank, 2: asked for by another
    for (int t = 0; t < patch.triangles; ++t) {
        if (kept[static_cast<std::size_t>(t)] == 0) continue;
        for (int k = 0; k < patch.per; ++k) used[static_cast<std::size_t>(patch.corner[static_cast<std::size_t>(patch.per * t + k)])] = 1;
    }
    std::map<int, Request> requests;
    std::vector<char> mine(n, 1);
    if (comm.size() > 1) {
        for (std::size_t v = 0; v < n; ++v) {
            if (used[v] == 0) continue;
            const int rank = owners.owner(patch.key[v]);
            if (rank == comm.rank()) continue;
            mine[v] = 0;
            requests[rank].keys.push_back(patch.key[v]);
            requests[rank].rows.push_back(static_cast<int>(v));
        }
    }
    std::vector<Message> outgoing;
    for (const auto& [rank, request] : requests) outgoing.push_back(message_of(rank, request.keys));
    const auto asked = comm.size() > 1 ? exchange_sparse(comm, outgoing) : std::vector<Message>();
    std::unordered_map<std::int64_t, int> rows;
    if (!asked.empty()) {
        rows.reserve(n);
        for (std::size_t v = 0; v < n; ++v) rows.emplace(patch.key[v], static_cast<int>(v));
    }
    for (const auto& message : asked) {
        for (const auto key : words(message)) {
            auto& use = used[static_cast<std::size_t>(rows.at(key))];
            if (use == 0) use = 2;
        }
    }
    std::vector<int> order, row_of(n, -1);
    for (std::size_t v = 0; v < n; ++v) {
        if (used[v] == 0 || mine[v] == 0) continue;
        row_of[v] = static_cast<int>(order.size());
        order.push_back(static_cast<int>(v));
    }
    mesh.owned = static_cast<std::int64_t>(order.size());
    mesh.first_vertex = comm.exclusive_sum(mesh.owned);
    mesh.total_vertices = comm.sum(mesh.owned);
    std::vector<Message> answers;
    for (const auto& message : asked) {
        auto keys = words(message);
        for (auto& key : keys) key = mesh.first_vertex + row_of[static_cast<std::size_t>(rows.at(key))];
        answers.push_back(message_of(message.rank, keys));
    }
    mesh.global.clear();
    for (std::int64_t v = 0; v < mesh.owned; ++v) mesh.global.push_back(mesh.first_vertex + v);
    if (comm.size() > 1) {
        for (const auto& message : exchange_sparse(comm, answers)) {
            const auto numbers = words(message);
            const auto& request = requests.at(message.rank);
            for (std::size_t k = 0; k < numbers.size(); ++k) {
                row_of[static_cast<std::size_t>(request.rows[k])] = static_cast<int>(order.size());
                order.push_back(request.rows[k]);
                mesh.global.push_back(numbers[k]);
            }
        }
    }
    mesh.triangles.clear();
    for (int t = 0; t < patch.triangles; ++t) {
        if (kept[static_cast<std::size_t>(t)] == 0) continue;
        auto& triangle = mesh.triangles.emplace_back(std::array<int, 3>{-1, -1, -1});
        for (int k = 0; k < patch.per; ++k) {
            triangle[static_cast<std::size_t>(k)] = row_of[static_cast<std::size_t>(patch.corner[static_cast<std::size_t>(patch.per * t + k)])];
        }
    }
    const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
    mesh.first_triangle = comm.exclusive_sum(triangles);
    mesh.total_triangles = comm.sum(triangles);

    const auto normal = on_host(values.normal), velocity = on_host(values.velocity), pressure = on_host(values.pressure);
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
