#pragma once
// Shapes, meshes and random points that the tests of geometry share.
#include "../own_folder.hpp"
#include "base/text/error.hpp"
#include "base/text/vec3.hpp"
#include "scene/sampling/signed_distance.hpp"
#include "scene/shapes/mesh.hpp"
#include "scene/shapes/shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <string>

namespace treacle::scene::testing {

inline Shape box(const Vec3& min, const Vec3& max) {
    Shape s;
    s.kind = ShapeKind::box;
    s.min = min;
    s.max = max;
    s.where = "scene.yaml:7";
    return s;
}

inline Shape round(ShapeKind kind, const Vec3& centre, double radius, double height = 0, double tube = 0) {
    Shape s;
    s.kind = kind;
    s.centre = centre;
    s.radius = radius;
    s.height = height;
    s.tube_radius = tube;
    s.where = "scene.yaml:7";
    return s;
}

inline Shape mesh_shape(const std::string& file) {
    Shape s;
    s.kind = ShapeKind::mesh;
    s.file = file;
    s.where = "scene.yaml:7";
    return s;
}

inline Vec3 plus(const Vec3& a, double s, const Vec3& b) { return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]}; }
inline double gap(const Vec3& a, const Vec3& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

inline TriangleMesh cube_mesh() {
    TriangleMesh m;
    for (int i = 0; i < 8; ++i) m.vertices.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
    const int quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& q : quads) {
        m.triangles.push_back({q[0], q[1], q[2]});
        m.triangles.push_back({q[0], q[2], q[3]});
    }
    return m;
}

// The unit sphere from an octahedron cut `levels` times.
inline TriangleMesh sphere_mesh(int levels) {
    TriangleMesh m;
    m.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    m.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<int, int>, int> middles;
        const auto middle = [&](int a, int b) {
            const auto [slot, fresh] = middles.try_emplace(std::minmax(a, b), int(m.vertices.size()));
            if (fresh) {
                const Vec3 x = plus(m.vertices[a], 1, m.vertices[b]);
                m.vertices.push_back(plus({0, 0, 0}, 1 / gap(x, {0, 0, 0}), x));
            }
            return slot->second;
        };
        std::vector<std::array<int, 3>> finer;
        for (const auto& [a, b, c] : m.triangles) {
            const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        m.triangles = finer;
    }
    return m;
}

// Writes a mesh to a file that is removed again.
class MeshFile {
public:
    MeshFile(const std::string& name, const TriangleMesh& mesh) : path_(folder_.path() / name) {
        std::ofstream out(path_);
        out.precision(17);
        for (const Vec3& v : mesh.vertices) out << "v " << v[0] << " " << v[1] << " " << v[2] << "\n";
        for (const auto& t : mesh.triangles) out << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
    }
    std::string path() const { return path_.string(); }

private:
    test::OwnFolder folder_;
    std::filesystem::path path_;
};

// A model of the folder that TREACLE_DATA names; empty when absent.
inline std::string model(const std::string& name) {
    const char* data = std::getenv("TREACLE_DATA");
    if (data == nullptr) return "";
    for (const auto& folder : {std::filesystem::path(data), std::filesystem::path(data) / "models"})
        if (std::filesystem::exists(folder / name)) return (folder / name).string();
    return "";
}

// The time that this process computes, which other processes do not lengthen; with sanitizers and without
// optimisation, about what it would be in a release build.
class Stopwatch {
public:
    double seconds() const { return double(std::clock() - start_) / CLOCKS_PER_SEC / slowness; }

private:
#ifdef __SANITIZE_ADDRESS__
    static constexpr double slowness = 30; // measured: 3.3 s in place of 0.1 s
#else
    static constexpr double slowness = 1;
#endif
    std::clock_t start_ = std::clock();
};

class RandomPoints {
public:
    RandomPoints(const Vec3& min, const Vec3& max) : min_(min), max_(max) {}
    Vec3 operator()() {
        Vec3 x;
        for (int a = 0; a < 3; ++a) x[a] = min_[a] + (max_[a] - min_[a]) * unit_(generator_);
        return x;
    }

private:
    Vec3 min_, max_;
    std::mt19937_64 generator_{42};
    std::uniform_real_distribution<double> unit_{0, 1};
};

// The message with which a shape is refused; empty when it is not.
inline std::string refusal(const Shape& shape, int dimensions = 3) {
    try {
        SolidRegion(shape, dimensions);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

} // namespace treacle::scene::testing
