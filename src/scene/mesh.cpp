#include "scene/mesh.hpp"

#include "base/error.hpp"
#include "scene/triangle_tree.hpp"
#include "scene/vector_math.hpp"

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace treacle::scene {
namespace {

constexpr double weld_share = 1e-9;            // of the size of the mesh
constexpr std::size_t thickness_rays = 20'000; // at most, one per triangle

// Disjoint sets of 0..n-1.
class Sets {
public:
    explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
    std::size_t find(std::size_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::size_t a, std::size_t b) {
        parent_[std::max(find(a), find(b))] = std::min(find(a), find(b));
    }

private:
    std::vector<std::size_t> parent_;
};

Bounds bounds_of(const std::vector<Vec3>& points) {
    Bounds box{points.front(), points.front()};
    for (const Vec3& p : points)
        for (int a = 0; a < 3; ++a) {
            box.min[a] = std::min(box.min[a], p[a]);
            box.max[a] = std::max(box.max[a], p[a]);
        }
    return box;
}

// Merges vertices closer than the tolerance; looks into every bin that the tolerance touches, mostly one.
void weld(TriangleMesh& mesh, MeshReport& report) {
    const double tolerance = weld_share * length(report.bounds.max - report.bounds.min);
    const double bin = std::max(1e3 * tolerance, 1e-300);
    const auto hash = [](std::int64_t i, std::int64_t j, std::int64_t k) {
        std::uint64_t h = 0;
        for (const std::int64_t v : {i, j, k})
            h = (h ^ static_cast<std::uint64_t>(v)) * 0x9E3779B97F4A7C15ull;
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
    report.degenerate = std::erase_if(mesh.triangles, [](const std::array<int, 3>& t) {
        return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    });
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

void count_edges(const TriangleMesh& mesh, const std::vector<Edge>& edges, MeshReport& report) {
    Sets parts(mesh.vertices.size()), loops(mesh.vertices.size());
    std::vector<int> open_vertices;
    for_each_edge(edges, [&](std::size_t begin, std::size_t end) {
        const Edge& edge = edges[begin];
        parts.join(edge.low, edge.high);
        if (end - begin > 2) ++report.shared_edges;
        if ((end - begin) % 2 == 0) return;
        ++report.open_edges;
        loops.join(edge.low, edge.high);
        open_vertices.insert(open_vertices.end(), {edge.low, edge.high});
    });
    std::sort(open_vertices.begin(), open_vertices.end());
    open_vertices.erase(std::unique(open_vertices.begin(), open_vertices.end()), open_vertices.end());
    for (const int v : open_vertices) report.holes += loops.find(v) == static_cast<std::size_t>(v);
    std::vector<char> used(mesh.vertices.size(), 0);
    for (const auto& triangle : mesh.triangles)
        for (const int v : triangle) used[parts.find(v)] = 1;
    report.components = static_cast<std::size_t>(std::count(used.begin(), used.end(), 1));
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

void measure(TriangleMesh& mesh, MeshReport& report) {
    const Vec3 origin = 0.5 * (report.bounds.min + report.bounds.max);
    for (const auto& t : mesh.triangles) {
        const Vec3 a = mesh.vertices[t[0]] - origin, b = mesh.vertices[t[1]] - origin,
                   c = mesh.vertices[t[2]] - origin;
        report.volume += dot(a, cross(b, c)) / 6;
        report.area += 0.5 * length(cross(b - a, c - a));
    }
    if (report.volume >= 0) return;
    report.volume = -report.volume;
    report.inside_out = true;
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
}

// Thickness below which 1 % of the sampled area lies, by rays inwards from the middle of triangles.
double thin_quantile(const TriangleMesh& mesh, const MeshReport& report) {
    std::vector<Triangle> corners;
    corners.reserve(mesh.triangles.size());
    for (const auto& t : mesh.triangles)
        corners.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
    const TriangleTree tree(corners);
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

} // namespace

std::vector<std::string> MeshReport::notes() const {
    std::vector<std::string> result;
    if (welded > 0) result.push_back(std::to_string(welded) + " vertices merged with equal ones");
    if (degenerate > 0) result.push_back(std::to_string(degenerate) + " triangles without area left out");
    if (turned > 0)
        result.push_back(std::to_string(turned) + " triangles turned round to agree with their neighbours");
    if (inside_out) result.push_back("all triangles faced inwards and were turned round");
    if (shared_edges > 0)
        result.push_back(std::to_string(shared_edges) + " edges belong to more than two triangles");
    return result;
}

TriangleMesh read_mesh(const std::string& path, const std::string& where) {
    Assimp::Importer importer;
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS |
                                                            aiComponent_TANGENTS_AND_BITANGENTS |
                                                            aiComponent_COLORS | aiComponent_TEXCOORDS);
    const aiScene* file = importer.ReadFile(path, aiProcess_RemoveComponent | aiProcess_Triangulate |
                                                      aiProcess_PreTransformVertices);
    if (file == nullptr)
        throw InputError({where, "mesh '" + path + "' cannot be read", importer.GetErrorString(),
                          "give a PLY, OBJ or STL file"});
    TriangleMesh mesh;
    for (unsigned m = 0; m < file->mNumMeshes; ++m) {
        const aiMesh& part = *file->mMeshes[m];
        const int offset = static_cast<int>(mesh.vertices.size());
        for (unsigned v = 0; v < part.mNumVertices; ++v)
            mesh.vertices.push_back({part.mVertices[v].x, part.mVertices[v].y, part.mVertices[v].z});
        for (unsigned f = 0; f < part.mNumFaces; ++f) {
            const aiFace& face = part.mFaces[f];
            if (face.mNumIndices != 3) continue; // loose points and lines bound nothing
            mesh.triangles.push_back({offset + static_cast<int>(face.mIndices[0]),
                                      offset + static_cast<int>(face.mIndices[1]),
                                      offset + static_cast<int>(face.mIndices[2])});
        }
    }
    if (mesh.triangles.empty())
        throw InputError({where, "mesh '" + path + "' holds no triangle", "a solid needs a surface", ""});
    if (!std::all_of(mesh.vertices.begin(), mesh.vertices.end(), is_finite))
        throw InputError({where, "mesh '" + path + "' holds a coordinate that is not a number", "", ""});
    return mesh;
}

CheckedMesh check_mesh(TriangleMesh mesh) {
    MeshReport report;
    report.bounds = bounds_of(mesh.vertices);
    weld(mesh, report);
    const auto edges = sorted_edges(mesh);
    count_edges(mesh, edges, report);
    orient(mesh, edges, report);
    measure(mesh, report);
    if (report.closed() && report.volume > 0) report.thinnest = thin_quantile(mesh, report);
    report.vertices = mesh.vertices.size();
    report.triangles = mesh.triangles.size();
    return {std::move(mesh), std::move(report)};
}

CheckedMesh load_closed_mesh(const std::string& path, const std::string& where) {
    CheckedMesh result = check_mesh(read_mesh(path, where));
    MeshReport& report = result.report;
    report.path = path;
    if (!report.closed())
        throw InputError(
            {where,
             "mesh '" + path + "' is not closed: " + std::to_string(report.open_edges) +
                 " open edges around " + std::to_string(report.holes) +
                 (report.holes == 1 ? " hole" : " holes"),
             "an open surface has no inside",
             "fill the holes in a mesh editor (MeshLab: Filters, Close Holes; Blender: Mesh, Fill)"});
    const Vec3 size = report.bounds.max - report.bounds.min;
    if (!(report.volume > 1e-12 * size[0] * size[1] * size[2]) || !(report.volume > 0))
        throw InputError({where, "mesh '" + path + "' encloses no volume", "a solid has an inside",
                          "give the surface a thickness, or orient its triangles outwards"});
    return result;
}

} // namespace treacle::scene
