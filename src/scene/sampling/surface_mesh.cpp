// Closed triangle meshes.
#include "scene/sampling/poisson_disk_layer.hpp"
#include "scene/sampling/surface.hpp"
#include "scene/shapes/triangle_bvh.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

namespace treacle::scene {
namespace {

constexpr double candidate_density = 12; // candidates per d^2 of the surface
constexpr double check_density = 40;     // places per d^2 where the coverage is checked

std::vector<Triangle> corners_of(const TriangleMesh& mesh) {
    std::vector<Triangle> result;
    result.reserve(mesh.triangles.size());
    for (const auto& t : mesh.triangles)
        result.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
    return result;
}

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

class Mesh final : public Surface {
public:
    Mesh(const TriangleMesh& mesh, const MeshReport& report)
        : corners_(corners_of(mesh)), indices_(mesh.triangles), tree_(corners_), bounds_(report.bounds),
          volume_(report.volume), area_(report.area), size_(length(bounds_.max - bounds_.min)) {
        find_normals(mesh);
    }

    Nearest nearest(const Vec3& x) const override {
        const ClosestPoint c = tree_.closest(x);
        const double sign = sign_at(x);
        if (c.distance > 1e-9 * size_) return {sign * c.distance, (sign / c.distance) * (x - c.point)};
        return {sign * c.distance, feature_normal(c)};
    }
    double distance(const Vec3& x, const DistanceBound& known) const override {
        const ClosestPoint c = tree_.closest(x, known.at_most);
        const int sign = known.sign != 0 ? known.sign : sign_at(x);
        return sign * c.distance;
    }
    Bounds bounds() const override { return bounds_; }
    double volume() const override { return volume_; }
    double area() const override { return area_; }

    // Layers are found once: checks, contacts, output and solids ask for the same ones.
    SurfaceSamples sample(const SurfaceSampling& sampling) const override {
        const std::lock_guard lock(layers_mutex_);
        const std::pair request(sampling.spacing, sampling.inset);
        auto layer = layers_.find(request);
        if (layer == layers_.end()) layer = layers_.emplace(request, find_layer(sampling)).first;
        return layer->second;
    }

    SurfaceSamples scatter(const SurfaceSampling& sampling) const override {
        constexpr double per_square = 2; // chance gaps are then no wider than a spacing
        SurfaceSamples result;
        sample_triangles(per_square / (sampling.spacing * sampling.spacing), 0, [&](const Vec3& c, const Vec3& n) {
            result.positions.push_back(c);
            result.normals.push_back(n);
        });
        return result;
    }

private:
    SurfaceSamples find_layer(const SurfaceSampling& sampling) const {
        const double d = sampling.spacing;
        std::vector<Vec3> candidates;
        std::vector<Vec3> stuck; // in the middle of thin parts
        sample_triangles(candidate_density / (d * d), 0, [&](const Vec3& c, const Vec3& n) {
            const auto s = lower(c, n, sampling);
            if (s) (s->thin ? stuck : candidates).push_back(s->point);
        });
        PoissonDiskLayer layer(
            d, [&](const Vec3& x, double tolerance) { return to_inset(x, sampling.inset, tolerance); });
        layer.choose(candidates, stuck);
        layer.relax();
        layer.fill(candidates);
        // Small triangles leave chance gaps between the candidates: sampled again, more densely.
        sample_triangles(check_density / (d * d), 0.5, [&](const Vec3& c, const Vec3& n) {
            if (layer.covers(c - sampling.inset * n)) return;
            const auto s = lower(c, n, sampling);
            if (!s || layer.covers(s->point)) return;
            layer.add(s->point);
            if (s->thin) stuck.push_back(s->point);
        });
        SurfaceSamples result;
        result.positions = layer.points();
        for (const Vec3& x : result.positions) result.normals.push_back(nearest(x).normal);
        result.thin = count_thin(result.positions, stuck, sampling);
        return result;
    }

    // project() of this surface; to the surface itself in one step.
    std::optional<Vec3> to_inset(const Vec3& x, double inset, double tolerance) const {
        if (inset == 0) return tree_.closest(x).point;
        return project(*this, x, inset, tolerance);
    }
    int sign_at(const Vec3& x) const { return tree_.winding(x) > 0.5 ? -1 : 1; }

    // project_to_inset(), with a short cut: where c stays the closest point, nothing is in between.
    std::optional<InsetPoint> lower(const Vec3& c, const Vec3& n, const SurfaceSampling& sampling) const {
        if (sampling.inset == 0) return InsetPoint{c, false};
        const Vec3 p = c - sampling.inset * n;
        if (length(tree_.closest(p).point - c) < 1e-6 * sampling.spacing) return InsetPoint{p, false};
        return project_to_inset(*this, c, n, sampling.inset, sampling.spacing);
    }

    static std::size_t count_thin(
        const std::vector<Vec3>& samples, const std::vector<Vec3>& stuck, const SurfaceSampling& sampling) {
        PointGrid grid(sampling.spacing, stuck.size());
        for (const Vec3& x : stuck) grid.add(x);
        return static_cast<std::size_t>(std::count_if(samples.begin(), samples.end(),
            [&](const Vec3& x) { return grid.any_within(x, 1e-9 * sampling.spacing); }));
    }

    // Visits points spread over all triangles by a low-discrepancy sequence (R2, Roberts 2018).
    template <class Visit>
    void sample_triangles(double density, double shift, Visit&& visit) const {
        const double count = std::max(64.0, std::ceil(area_ * density));
        double before = 0;
        std::uint64_t k = 0;
        for (const Triangle& t : corners_) {
            const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
            const double after = before + 0.5 * length(normal) / area_ * count;
            for (; static_cast<double>(k) + 0.5 < after; ++k) {
                double u = std::fmod(shift + 0.7548776662466927 * static_cast<double>(k), 1);
                double v = std::fmod(shift + 0.5698402909980532 * static_cast<double>(k), 1);
                if (u + v > 1) u = 1 - u, v = 1 - v;
                visit(t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]), unit(normal));
            }
            before = after;
        }
    }

    // Angle-weighted pseudonormals of vertices and edges (Baerentzen and Aanaes 2005).
    void find_normals(const TriangleMesh& mesh) {
        vertex_normals_.assign(mesh.vertices.size(), {0, 0, 0});
        std::map<std::pair<int, int>, Vec3> edges;
        const auto edge = [](int a, int b) { return std::pair(std::min(a, b), std::max(a, b)); };
        for (std::size_t i = 0; i < corners_.size(); ++i) {
            const Triangle& t = corners_[i];
            const Vec3 normal = unit(cross(t[1] - t[0], t[2] - t[0]));
            for (int c = 0; c < 3; ++c) {
                const double angle = angle_between(t[(c + 1) % 3] - t[c], t[(c + 2) % 3] - t[c]);
                vertex_normals_[indices_[i][c]] += angle * normal;
                edges[edge(indices_[i][c], indices_[i][(c + 1) % 3])] += normal;
            }
        }
        for (Vec3& n : vertex_normals_) n = unit(n);
        edge_normals_.resize(corners_.size());
        for (std::size_t i = 0; i < corners_.size(); ++i)
            for (int c = 0; c < 3; ++c)
                edge_normals_[i][c] = unit(edges[edge(indices_[i][c], indices_[i][(c + 1) % 3])]);
    }

    Vec3 feature_normal(const ClosestPoint& c) const {
        constexpr double edge_width = 1e-6; // barycentric
        for (int v = 0; v < 3; ++v)
            if (c.weights[v] > 1 - edge_width) return vertex_normals_[indices_[c.triangle][v]];
        for (int v = 0; v < 3; ++v)
            if (c.weights[v] < edge_width) return edge_normals_[c.triangle][(v + 1) % 3];
        const Triangle& t = corners_[c.triangle];
        return unit(cross(t[1] - t[0], t[2] - t[0]));
    }

    std::vector<Triangle> corners_;
    std::vector<std::array<int, 3>> indices_;
    TriangleBvh tree_;
    Bounds bounds_;
    double volume_, area_, size_;
    std::vector<Vec3> vertex_normals_;
    std::vector<std::array<Vec3, 3>> edge_normals_;                      // of the edge from corner c to c + 1
    mutable std::map<std::pair<double, double>, SurfaceSamples> layers_; // by spacing and inset [m]
    mutable std::mutex layers_mutex_;
};

} // namespace

SurfacePointer make_mesh(const TriangleMesh& mesh, const MeshReport& report) {
    return std::make_shared<Mesh>(mesh, report);
}

} // namespace treacle::scene
