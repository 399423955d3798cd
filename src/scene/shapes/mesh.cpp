#include "scene/shapes/mesh.hpp"

#include "base/disjoint_sets.hpp"

#include "scene/shapes/triangle_bvh.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <sstream>
#include <tuple>
#include <unordered_map>

namespace treacle::scene {
namespace {

constexpr double weld_fraction = 1e-9;         // of the size of the mesh
constexpr double buried_points = 20'000;       // of the whole surface
constexpr std::size_t thickness_rays = 20'000; // at most, one per triangle

Bounds bounds_of(const std::vector<Vec3>& points) {
    Bounds box{points.front(), points.front()};
    for (const Vec3& p : points)
        for (int a = 0; a < 3; ++a) {
            box.min[a] = std::min(box.min[a], p[a]);
            box.max[a] = std::max(box.max[a], p[a]);
        }
    return box;
}

// Merges vertices closer than the tolerance; searches every bin that the tolerance touches, mostly one.
void weld(TriangleMesh& mesh, MeshReport& report) {
    const double tolerance = weld_fraction * length(report.bounds.max - report.bounds.min);
    const double bin = std::max(1e3 * tolerance, 1e-300);
    const auto hash = [](std::int64_t i, std::int64_t j, std::int64_t k) {
        std::uint64_t h = 0;
        for (const std::int64_t v : {i, j, k}) h = (h ^ static_cast<std::uint64_t>(v)) * 0x9E3779B97F4A7C15ull;
        return h;
    };
    const auto index = [&](double x, int a) {
        return static_cast<std::int64_t>(std::floor((x - report.bounds.min[a]) / bin));
    };
    std::unordered_map<std::uint64_t, std::vector<int>> bins;
    bins.reserve(mesh.vertices.size());
    std::vector<Vec3> kept;
    std::vector<int> renumbered(mesh.vertices.size());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const Vec3 x = mesh.vertices[v];
        int match = -1;
        for (auto i = index(x[0] - tolerance, 0); i <= index(x[0] + tolerance, 0); ++i)
            for (auto j = index(x[1] - tolerance, 1); j <= index(x[1] + tolerance, 1); ++j)
                for (auto k = index(x[2] - tolerance, 2); k <= index(x[2] + tolerance, 2); ++k)
                    if (const auto found = bins.find(hash(i, j, k)); found != bins.end())
                        for (const int other : found->second)
                            if (match < 0 && length(kept[other] - x) <= tolerance) match = other;
        if (match < 0) {
            match = static_cast<int>(kept.size());
            kept.push_back(x);
            bins[hash(index(x[0], 0), index(x[1], 1), index(x[2], 2))].push_back(match);
        }
        renumbered[v] = match;
    }
    report.welded = mesh.vertices.size() - kept.size();
    mesh.vertices = std::move(kept);
    for (auto& triangle : mesh.triangles)
        for (int& v : triangle) v = renumbered[v];
    report.degenerate = std::erase_if(
        mesh.triangles, [](const std::array<int, 3>& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

struct Edge {
    int low = 0, high = 0; // vertices
    int triangle = 0;
    bool forward = true; // the triangle runs from low to high
};

// All edges of all triangles; those between the same vertices are neighbours.
std::vector<Edge> sorted_edges(const TriangleMesh& mesh) {
    std::vector<Edge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int c = 0; c < 3; ++c) {
            const int a = mesh.triangles[t][c], b = mesh.triangles[t][(c + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), a < b});
        }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    return edges;
}

template <class Visit>
void for_each_edge(const std::vector<Edge>& edges, Visit&& visit) {
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t j = i;
        while (j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high) ++j;
        visit(i, j);
        i = j;
    }
}

std::size_t count_components(const TriangleMesh& mesh, DisjointSets& parts) {
    std::vector<char> used(mesh.vertices.size(), 0);
    for (const auto& triangle : mesh.triangles)
        for (const int v : triangle) used[parts.find(v)] = 1;
    return static_cast<std::size_t>(std::count(used.begin(), used.end(), 1));
}

void count_edges(const TriangleMesh& mesh, const std::vector<Edge>& edges, MeshReport& report) {
    DisjointSets parts(mesh.vertices.size()), loops(mesh.vertices.size());
    std::vector<int> open_vertices;
    for_each_edge(edges, [&](std::size_t begin, std::size_t end) {
        const Edge& edge = edges[begin];
        parts.join(edge.low, edge.high);
        if (end - begin > 2) ++report.shared_edges;
        if ((end - begin) % 2 == 0) return;
        ++report.open_edges;
        if (end - begin > 2) ++report.wall_edges;
        loops.join(edge.low, edge.high);
        open_vertices.insert(open_vertices.end(), {edge.low, edge.high});
    });
    std::sort(open_vertices.begin(), open_vertices.end());
    open_vertices.erase(std::unique(open_vertices.begin(), open_vertices.end()), open_vertices.end());
    for (const int v : open_vertices) report.holes += loops.find(v) == static_cast<std::size_t>(v);
    report.components = count_components(mesh, parts);
}

void count_duplicates(const TriangleMesh& mesh, MeshReport& report) {
    auto triangles = mesh.triangles;
    // The lowest corner first: what turns the same way is then the same.
    for (auto& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(triangles.begin(), triangles.end());
    for (std::size_t i = 1; i < triangles.size(); ++i) report.duplicates += triangles[i] == triangles[i - 1];
}

// For each triangle the neighbours across edges of two triangles, and whether the two disagree.
struct Neighbour {
    int triangle = 0;
    bool disagrees = false;
};

std::vector<std::vector<Neighbour>> neighbours_of(const TriangleMesh& mesh, const std::vector<Edge>& edges) {
    std::vector<std::vector<Neighbour>> result(mesh.triangles.size());
    for_each_edge(edges, [&](std::size_t begin, std::size_t end) {
        if (end - begin != 2) return;
        const Edge &a = edges[begin], &b = edges[begin + 1];
        result[a.triangle].push_back({b.triangle, a.forward == b.forward});
        result[b.triangle].push_back({a.triangle, a.forward == b.forward});
    });
    return result;
}

// Turns triangles so that neighbours agree; in each connected part the majority stays as it was.
void orient(TriangleMesh& mesh, const std::vector<Edge>& edges, MeshReport& report) {
    bool consistent = true;
    for_each_edge(edges, [&](std::size_t begin, std::size_t end) {
        if (end - begin == 2 && edges[begin].forward == edges[begin + 1].forward) consistent = false;
    });
    if (consistent) return;
    const auto neighbours = neighbours_of(mesh, edges);
    enum : char { unseen, as_is, to_turn };
    std::vector<char> state(mesh.triangles.size(), unseen);
    for (std::size_t seed = 0; seed < state.size(); ++seed) {
        if (state[seed] != unseen) continue;
        std::vector<int> part{static_cast<int>(seed)};
        state[seed] = as_is;
        std::size_t turned = 0;
        for (std::size_t i = 0; i < part.size(); ++i)
            for (const Neighbour& n : neighbours[part[i]]) {
                if (state[n.triangle] != unseen) continue;
                state[n.triangle] = (state[part[i]] == to_turn) != n.disagrees ? to_turn : as_is;
                turned += state[n.triangle] == to_turn;
                part.push_back(n.triangle);
            }
        const char minority = 2 * turned > part.size() ? as_is : to_turn;
        for (const int t : part)
            if (state[t] == minority) {
                std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
                ++report.turned;
            }
    }
}

struct Integrals {
    double volume = 0, area = 0;
};
Integrals integrate(const TriangleMesh& mesh, const Bounds& bounds) {
    const Vec3 origin = 0.5 * (bounds.min + bounds.max);
    Integrals out;
    for (const auto& t : mesh.triangles) {
        const Vec3 a = mesh.vertices[t[0]] - origin, b = mesh.vertices[t[1]] - origin, c = mesh.vertices[t[2]] - origin;
        out.volume += dot(a, cross(b, c)) / 6;
        out.area += 0.5 * length(cross(b - a, c - a));
    }
    return out;
}

void measure(TriangleMesh& mesh, MeshReport& report) {
    const Integrals sums = integrate(mesh, report.bounds);
    report.volume = sums.volume;
    report.area = sums.area;
    if (report.volume >= 0) return;
    report.volume = -report.volume;
    report.inside_out = true;
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
}

// By points spread over all triangles (R2, Roberts 2018): winding numbers on the two sides of each, 1 and 0 on the surface of
// what the mesh bounds.
void find_buried(const TriangleMesh& mesh, MeshReport& report) {
    std::vector<Triangle> corners;
    for (const auto& t : mesh.triangles)
        corners.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
    const TriangleBvh tree(corners);
    const double off = 1e-6 * length(report.bounds.max - report.bounds.min);
    double before = 0, buried = 0, inwards = 0;
    std::size_t k = 0;
    for (const Triangle& t : corners) {
        const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
        const double after = before + 0.5 * length(normal) / report.area * buried_points;
        for (; static_cast<double>(k) + 0.5 < after; ++k) {
            double u = std::fmod(0.7548776662466927 * static_cast<double>(k), 1);
            double v = std::fmod(0.5698402909980532 * static_cast<double>(k), 1);
            if (u + v > 1) u = 1 - u, v = 1 - v;
            const Vec3 x = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
            const double above = tree.winding(x + off * unit(normal)), below = tree.winding(x - off * unit(normal));
            if (above < -0.5)
                inwards += 1;
            else if (above > 0.5 || below > 1.5)
                buried += 1;
        }
        before = after;
    }
    report.buried = buried / std::max<std::size_t>(1, k);
    report.inwards = inwards / std::max<std::size_t>(1, k);
}

// Thickness below which 1 % of the sampled area lies, by rays inwards from the middle of triangles.
double thin_quantile(const TriangleMesh& mesh, const MeshReport& report) {
    std::vector<Triangle> corners;
    corners.reserve(mesh.triangles.size());
    for (const auto& t : mesh.triangles)
        corners.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
    const TriangleBvh tree(corners);
    const double skip = 1e-7 * length(report.bounds.max - report.bounds.min);
    struct Ray {
        double thickness, area;
    };
    std::vector<Ray> rays;
    double total = 0;
    const std::size_t stride = 1 + corners.size() / thickness_rays;
    for (std::size_t i = 0; i < corners.size(); i += stride) {
        const Triangle& t = corners[i];
        const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
        const double area = 0.5 * length(normal);
        if (area <= 0) continue;
        // A little off the centroid: from there a ray through a symmetric mesh would meet edges.
        const Vec3 middle = 0.31 * t[0] + 0.33 * t[1] + 0.36 * t[2];
        rays.push_back({tree.first_hit(middle, -unit(normal), skip), area});
        total += area;
    }
    std::sort(rays.begin(), rays.end(), [](const Ray& a, const Ray& b) { return a.thickness < b.thickness; });
    double sum = 0;
    for (const Ray& ray : rays)
        if ((sum += ray.area) >= 0.01 * total) return ray.thickness;
    return 0;
}

std::string text_of(double value) {
    std::ostringstream out;
    out << value;
    return out.str();
}

} // namespace

std::vector<std::string> MeshReport::notes() const {
    std::vector<std::string> result;
    if (welded > 0) result.push_back(std::to_string(welded) + " vertices merged with equal ones");
    if (degenerate > 0) result.push_back(std::to_string(degenerate) + " triangles without area left out");
    if (turned > 0) result.push_back(std::to_string(turned) + " triangles turned round to agree with their neighbours");
    if (inside_out) result.push_back("all triangles faced inwards and were turned round");
    if (shared_edges > 0) result.push_back(std::to_string(shared_edges) + " edges belong to more than two triangles");
    if (separate_volume > 0)
        result.push_back("its parts overlap: volume and mass are those of their union; one by one they have " +
                         text_of(separate_volume) + " m3");
    return result;
}

CheckedMesh check_mesh(TriangleMesh mesh) {
    MeshReport report;
    report.bounds = bounds_of(mesh.vertices);
    weld(mesh, report);
    const auto edges = sorted_edges(mesh);
    count_edges(mesh, edges, report);
    orient(mesh, edges, report);
    measure(mesh, report);
    count_duplicates(mesh, report);
    if (report.closed() && report.volume > 0) {
        report.thickness_p01 = thin_quantile(mesh, report);
        find_buried(mesh, report);
    }
    report.vertices = mesh.vertices.size();
    report.triangles = mesh.triangles.size();
    return {std::move(mesh), std::move(report)};
}

std::vector<CheckedMesh> split(const CheckedMesh& checked) {
    const TriangleMesh& mesh = checked.mesh;
    DisjointSets sets(mesh.vertices.size());
    for (const auto& t : mesh.triangles)
        for (const int v : t) sets.join(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(v));
    std::unordered_map<std::size_t, std::size_t> number; // of the part by its lowest vertex
    std::vector<CheckedMesh> parts;
    std::vector<int> renumbered(mesh.vertices.size(), -1);
    for (const auto& t : mesh.triangles) {
        const auto [slot, fresh] = number.try_emplace(sets.find(static_cast<std::size_t>(t[0])), parts.size());
        if (fresh) parts.emplace_back();
        TriangleMesh& part = parts[slot->second].mesh;
        std::array<int, 3> corners;
        for (std::size_t c = 0; c < 3; ++c) {
            int& v = renumbered[static_cast<std::size_t>(t[c])];
            if (v < 0) {
                v = static_cast<int>(part.vertices.size());
                part.vertices.push_back(mesh.vertices[static_cast<std::size_t>(t[c])]);
            }
            corners[c] = v;
        }
        part.triangles.push_back(corners);
    }
    for (CheckedMesh& part : parts) {
        part.report.path = checked.report.path;
        part.report.bounds = bounds_of(part.mesh.vertices);
        const Integrals sums = integrate(part.mesh, part.report.bounds);
        part.report.volume = sums.volume;
        part.report.area = sums.area;
        part.report.vertices = part.mesh.vertices.size();
        part.report.triangles = part.mesh.triangles.size();
        part.report.components = 1;
    }
    return parts;
}

} // namespace treacle::scene
