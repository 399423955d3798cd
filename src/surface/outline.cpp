#include "surface/silhouette.hpp"

#include "mpi/exchange.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

namespace treacle::surface {

namespace {
using scene::Projection;
using scene::Seen;

constexpr double beside = 0.75; // [pixels] from an edge to where no liquid is to be
constexpr double stride = 0.25; // [pixels] between points of the outline

// One triangle's view of an edge, between the lower and the higher vertex by number.
struct EdgeSide {
    std::int64_t low, high;
    double a[3], b[3]; // camera axes [m]
    double outward;    // 1: the triangle is on the left of a to b in the picture, -1: on the right, 0: seen on edge
};

// Edges of this rank's triangles; those of which both triangles are known here are paired at once.
std::vector<EdgeSide> outline_edges(const Comm& comm, const Mesh& mesh, const std::vector<Seen>& seen) {
    std::map<std::pair<std::int64_t, std::int64_t>, EdgeSide> open;
    std::vector<EdgeSide> out;
    const auto meet = [&](const EdgeSide& side) {
        const std::pair key(side.low, side.high);
        const auto other = open.find(key);
        if (other == open.end()) {
            open.emplace(key, side);
            return;
        }
        // Both triangles on the same side of the edge: one of them faces the camera, the other does not.
        if (other->second.outward == side.outward && side.outward != 0) out.push_back(side);
        open.erase(other);
    };
    for (const auto& t : mesh.triangles) {
        const Seen* p[3];
        for (std::size_t k = 0; k < 3; ++k) p[k] = &seen[static_cast<std::size_t>(t[k])];
        if (std::any_of(p, p + 3, [](const Seen* s) { return s->camera[2] < Projection::near; })) continue;
        const double area = (p[1]->x - p[0]->x) * (p[2]->y - p[0]->y) - (p[1]->y - p[0]->y) * (p[2]->x - p[0]->x);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t n = (k + 1) % 3;
            const auto i = mesh.global[static_cast<std::size_t>(t[k])], j = mesh.global[static_cast<std::size_t>(t[n])];
            const bool turned = j < i;
            EdgeSide side{std::min(i, j), std::max(i, j), {}, {},
                (area > 0      ? 1.0
                    : area < 0 ? -1.0
                               : 0.0) *
                    (turned ? -1 : 1)};
            std::copy_n((turned ? p[n] : p[k])->camera.data(), 3, side.a);
            std::copy_n((turned ? p[k] : p[n])->camera.data(), 3, side.b);
            meet(side);
        }
    }
    std::map<int, std::vector<EdgeSide>> away;
    for (const auto& [key, side] : open) away[static_cast<int>((key.first + key.second) % comm.size())].push_back(side);
    open.clear();
    std::vector<Message> messages;
    for (const auto& [rank, sides] : away) {
        Message message{rank, std::vector<char>(sides.size() * sizeof(EdgeSide))};
        std::memcpy(message.bytes.data(), sides.data(), message.bytes.size());
        messages.push_back(std::move(message));
    }
    for (const auto& message : exchange_sparse(comm, messages)) {
        std::vector<EdgeSide> sides(message.bytes.size() / sizeof(EdgeSide));
        std::memcpy(sides.data(), message.bytes.data(), message.bytes.size());
        for (const auto& side : sides) meet(side);
    }
    return out;
}
} // namespace

std::vector<float> outline_distance(const Comm& comm, const Mesh& mesh, const scene::CameraModel& camera,
    const Silhouette& silhouette, const Exposure& exposure, double band) {
    const Projection projection(camera, exposure);
    std::vector<Seen> seen(static_cast<std::size_t>(mesh.size()));
    for (std::size_t v = 0; v < seen.size(); ++v) {
        seen[v] = projection.see(
            mesh.vertices.data() + 3 * v, mesh.velocity.empty() ? nullptr : mesh.velocity.data() + 3 * v);
    }
    const int width = silhouette.width, height = silhouette.height;
    const auto covered = [&](double x, double y) {
        const int column = static_cast<int>(std::lround(x)), row = static_cast<int>(std::lround(y));
        return column >= 0 && column < width && row >= 0 && row < height &&
               silhouette.mask[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                               static_cast<std::size_t>(column)] != 0;
    };
    std::vector<double> nearness(silhouette.mask.size(), -band); // minus the distance
    const auto radius = static_cast<int>(std::ceil(band));
    for (const auto& edge : outline_edges(comm, mesh, seen)) {
        const Seen a = projection.at({edge.a[0], edge.a[1], edge.a[2]}),
                   b = projection.at({edge.b[0], edge.b[1], edge.b[2]});
        const double length = std::hypot(b.x - a.x, b.y - a.y);
        if (length == 0) continue;
        // The liquid is where both triangles are: on the left by `outward` (rows go down).
        const double nx = edge.outward * (b.y - a.y) / length, ny = -edge.outward * (b.x - a.x) / length;
        const int points = 1 + static_cast<int>(length / stride);
        for (int k = 0; k <= points; ++k) {
            const double s = static_cast<double>(k) / points;
            const double x = a.x + s * (b.x - a.x), y = a.y + s * (b.y - a.y);
            if (covered(x + beside * nx, y + beside * ny)) continue;
            const int column = static_cast<int>(std::lround(x)), row = static_cast<int>(std::lround(y));
            for (int j = std::max(0, row - radius); j <= std::min(height - 1, row + radius); ++j) {
                for (int i = std::max(0, column - radius); i <= std::min(width - 1, column + radius); ++i) {
                    auto& nearest = nearness[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                                             static_cast<std::size_t>(i)];
                    nearest = std::max(nearest, -std::hypot(i - x, j - y));
                }
            }
        }
    }
    comm.max(std::span<double>(nearness));
    std::vector<float> out(nearness.size());
    for (std::size_t k = 0; k < out.size(); ++k)
        out[k] = static_cast<float>(silhouette.mask[k] != 0 ? -nearness[k] : nearness[k]);
    return out;
}

} // namespace treacle::surface
