// Cuts by the plane z = 0 that have no formula: meshes, and bodies that lie askew.
#include "scene/sampling/poisson_disk_layer.hpp"
#include "scene/sampling/surface.hpp"
#include "scene/shapes/triangle_bvh.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace treacle::scene {
namespace {

constexpr int slice_cells = 1024; // along the longer edge of a cut
constexpr int first_cells = 256;  // along the longer edge of the body, to find the cut
constexpr int layer_cells = 4;    // of the contour grid per spacing
constexpr int block = 16;         // cells skipped at once where the surface is far
constexpr int bisections = 45;

struct ContourPiece {
    Piece piece;
    std::uint64_t from = 0, to = 0; // edges of the grid, equal where pieces meet
};

// Marching squares on a 1-Lipschitz function of the plane, negative inside; the crossings are bisected.
class Contour {
public:
    Contour(std::function<double(const Vec3&)> value, const Bounds& box, double cell)
        : value_(std::move(value)), cell_(cell) {
        for (int a = 0; a < 2; ++a) {
            origin_[a] = box.min[a] - 2 * cell; // a ring of cells outside, so that contours close
            n_[a] = static_cast<std::int64_t>(std::ceil((box.max[a] - box.min[a]) / cell)) + 4;
        }
        values_.assign(static_cast<std::size_t>((n_[0] + 1) * (n_[1] + 1)), std::numeric_limits<double>::quiet_NaN());
        for (std::int64_t j = 0; j < n_[1]; j += block)
            for (std::int64_t i = 0; i < n_[0]; i += block) march_block(i, j);
    }
    std::vector<ContourPiece> pieces;

private:
    Vec3 corner(std::int64_t i, std::int64_t j) const {
        return {origin_[0] + static_cast<double>(i) * cell_, origin_[1] + static_cast<double>(j) * cell_, 0};
    }
    double at(std::int64_t i, std::int64_t j) {
        double& v = values_[static_cast<std::size_t>(j * (n_[0] + 1) + i)];
        if (std::isnan(v)) v = value_(corner(i, j));
        return v;
    }
    void march_block(std::int64_t i0, std::int64_t j0) {
        const Vec3 middle = corner(i0, j0) + Vec3{0.5 * block * cell_, 0.5 * block * cell_, 0};
        if (std::abs(value_(middle)) > block * cell_) return;
        for (std::int64_t j = j0; j < std::min<std::int64_t>(j0 + block, n_[1]); ++j)
            for (std::int64_t i = i0; i < std::min<std::int64_t>(i0 + block, n_[0]); ++i) march_cell(i, j);
    }

    struct Crossing {
        Vec3 at;
        std::uint64_t edge;
    };
    // On the edge from corner (i, j) to the right (axis 0) or upwards (axis 1).
    Crossing cross_edge(std::int64_t i, std::int64_t j, int axis) {
        Vec3 a = corner(i, j), b = axis == 0 ? corner(i + 1, j) : corner(i, j + 1);
        const bool a_inside = at(i, j) < 0;
        for (int step = 0; step < bisections; ++step) {
            const Vec3 m = 0.5 * (a + b);
            ((value_(m) < 0) == a_inside ? a : b) = m;
        }
        return {0.5 * (a + b), static_cast<std::uint64_t>(2 * (j * (n_[0] + 1) + i) + axis)};
    }

    void march_cell(std::int64_t i, std::int64_t j) {
        const bool in[4] = {at(i, j) < 0, at(i + 1, j) < 0, at(i + 1, j + 1) < 0, at(i, j + 1) < 0};
        if (in[0] == in[1] && in[1] == in[2] && in[2] == in[3]) return;
        // Round the cell counter-clockwise: a piece starts where the walk comes out of the region and ends
        // where it goes in, so that the inside lies to its left.
        std::vector<Crossing> out, into;
        std::vector<int> out_side, into_side;
        for (int s = 0; s < 4; ++s) {
            if (in[s] == in[(s + 1) % 4]) continue;
            const Crossing c = s == 0   ? cross_edge(i, j, 0)
                               : s == 1 ? cross_edge(i + 1, j, 1)
                               : s == 2 ? cross_edge(i, j + 1, 0)
                                        : cross_edge(i, j, 1);
            (in[s] ? out : into).push_back(c);
            (in[s] ? out_side : into_side).push_back(s);
        }
        if (out.size() == 1) return add(out[0], into[0]);
        // A saddle: with an inside middle the pieces cut off the outside corners.
        const bool middle = value_(0.5 * (corner(i, j) + corner(i + 1, j + 1))) < 0;
        for (std::size_t o = 0; o < 2; ++o) {
            const int wanted = (out_side[o] + (middle ? 1 : 3)) % 4;
            add(out[o], into_side[0] == wanted ? into[0] : into[1]);
        }
    }
    void add(const Crossing& from, const Crossing& to) { pieces.push_back({{from.at, to.at}, from.edge, to.edge}); }

    std::function<double(const Vec3&)> value_;
    double cell_;
    Vec3 origin_{0, 0, 0};
    std::array<std::int64_t, 2> n_{0, 0};
    std::vector<double> values_;
};

// The closed lines that the pieces form, in the order of their first pieces.
std::vector<std::vector<Piece>> chain(const std::vector<ContourPiece>& pieces) {
    std::unordered_map<std::uint64_t, std::size_t> starting;
    for (std::size_t i = 0; i < pieces.size(); ++i) starting[pieces[i].from] = i;
    std::vector<char> used(pieces.size(), 0);
    std::vector<std::vector<Piece>> loops;
    for (std::size_t first = 0; first < pieces.size(); ++first) {
        if (used[first]) continue;
        std::vector<Piece> loop;
        for (std::size_t i = first; !used[i];) {
            used[i] = 1;
            loop.push_back(pieces[i].piece);
            const auto next = starting.find(pieces[i].to);
            if (next == starting.end()) break;
            i = next->second;
        }
        loops.push_back(std::move(loop));
    }
    return loops;
}

// Points at equal steps of the arc length.
std::vector<Vec3> stations(const std::vector<Piece>& loop, double spacing) {
    double total = 0;
    for (const Piece& p : loop) total += length(p.to - p.from);
    const auto n = std::max<std::int64_t>(1, count_intervals(total, spacing));
    std::vector<Vec3> result;
    double before = 0;
    for (const Piece& p : loop) {
        const double l = length(p.to - p.from);
        while (static_cast<std::int64_t>(result.size()) < n) {
            const double s = static_cast<double>(result.size()) * total / static_cast<double>(n) - before;
            if (s > l) break;
            result.push_back(p.from + (l > 0 ? s / l : 0) * (p.to - p.from));
        }
        before += l;
    }
    return result;
}

Vec3 outward(const Piece& p) {
    const Vec3 t = unit(p.to - p.from);
    return {t[1], -t[0], 0};
}

std::vector<Triangle> as_triangles(const std::vector<Piece>& pieces) {
    std::vector<Triangle> result;
    result.reserve(pieces.size());
    for (const Piece& p : pieces) result.push_back({p.from, p.to, p.to});
    return result;
}

Bounds bounds_of(const std::vector<Piece>& pieces) {
    Bounds box{pieces.front().from, pieces.front().from};
    for (const Piece& p : pieces)
        for (int a = 0; a < 2; ++a) {
            box.min[a] = std::min({box.min[a], p.from[a], p.to[a]});
            box.max[a] = std::max({box.max[a], p.from[a], p.to[a]});
        }
    return box;
}

class Cut final : public Surface {
public:
    Cut(const std::vector<Piece>& pieces, Inside inside)
        : pieces_(pieces), tree_(as_triangles(pieces)), inside_(std::move(inside)) {
        bounds_ = bounds_of(pieces);
        for (const Piece& p : pieces) {
            perimeter_ += length(p.to - p.from);
            area_ += 0.5 * (p.from[0] * p.to[1] - p.from[1] * p.to[0]);
        }
        size_ = length(bounds_.max - bounds_.min);
    }

    Nearest nearest(const Vec3& x) const override {
        const Vec3 flat{x[0], x[1], 0};
        const ClosestPoint c = tree_.closest(flat);
        const double sign = inside_(flat) ? -1 : 1;
        if (c.distance > 1e-9 * size_) return {sign * c.distance, (sign / c.distance) * (flat - c.point)};
        return {sign * c.distance, outward(pieces_[c.triangle])};
    }
    Bounds bounds() const override { return bounds_; }
    double volume() const override { return area_; }
    double area() const override { return perimeter_; }

    SurfaceSamples sample(const SurfaceSampling& sampling) const override {
        const double d = sampling.spacing;
        Bounds box = bounds_;
        for (int a = 0; a < 2; ++a) {
            box.min[a] -= std::abs(sampling.inset);
            box.max[a] += std::abs(sampling.inset);
        }
        const Contour contour(
            [&](const Vec3& x) { return nearest(x).distance + sampling.inset; }, box, d / layer_cells);
        PointGrid grid(d, 64);
        for (const auto& loop : chain(contour.pieces))
            for (const Vec3& x : stations(loop, d)) grid.add(project(*this, x, sampling.inset, 1e-4 * d).value_or(x));
        SurfaceSamples result;
        cover_thin_parts(sampling, grid, result);
        result.positions = grid.points();
        for (const Vec3& x : result.positions) result.normals.push_back(nearest(x).normal);
        return result;
    }

private:
    // Parts thinner than twice the inset have no contour at that depth: their middle is filled instead.
    void cover_thin_parts(const SurfaceSampling& sampling, PointGrid& grid, SurfaceSamples& result) const {
        const double d = sampling.spacing;
        for (const Piece& p : pieces_) {
            const auto n = std::max<std::int64_t>(1, count_intervals(length(p.to - p.from), 0.25 * d));
            for (std::int64_t i = 0; i < n; ++i) {
                const Vec3 c = p.from + ((static_cast<double>(i) + 0.5) / static_cast<double>(n)) * (p.to - p.from);
                if (grid.any_within(c - sampling.inset * outward(p), 0.6 * d)) continue;
                const auto s = project_to_inset(*this, c, outward(p), sampling.inset, d);
                if (!s || grid.any_within(s->point, 0.7 * d)) continue;
                grid.add(s->point);
                result.thin += s->thin;
            }
        }
    }

    std::vector<Piece> pieces_;
    TriangleBvh tree_;
    Inside inside_;
    Bounds bounds_;
    double area_ = 0, perimeter_ = 0, size_ = 0;
};

} // namespace

SurfacePointer make_cross_section(const std::vector<Piece>& pieces, Inside inside) {
    return std::make_shared<Cut>(pieces, std::move(inside));
}

namespace {

Vec3 crossing_of_edge(const TriangleMesh& mesh, int v, int w) {
    const Vec3 &a = mesh.vertices[std::min(v, w)], &b = mesh.vertices[std::max(v, w)];
    const Vec3 x = a + (a[2] / (a[2] - b[2])) * (b - a);
    return {x[0], x[1], 0};
}

} // namespace

std::vector<Piece> slice(const TriangleMesh& mesh) {
    // A vertex at z = 0 counts as above, which is a cut just below the plane: no vertex lies in it.
    const auto above = [&](int v) { return mesh.vertices[v][2] >= 0; };

    std::vector<Piece> pieces;
    for (const auto& t : mesh.triangles) {
        std::vector<Vec3> ends;
        for (int c = 0; c < 3; ++c)
            if (above(t[c]) != above(t[(c + 1) % 3])) ends.push_back(crossing_of_edge(mesh, t[c], t[(c + 1) % 3]));
        if (ends.size() != 2) continue;
        const Vec3 n = cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]);
        const Vec3 inside_left{-n[1], n[0], 0};
        Piece piece{ends[0], ends[1]};
        if (dot(inside_left, piece.to - piece.from) < 0) std::swap(piece.from, piece.to);
        if (length(piece.to - piece.from) > 0) pieces.push_back(piece);
    }
    return pieces;
}

std::vector<Piece> slice(const Surface& surface) {
    const auto cut = [&](const Bounds& box, int cells) {
        const double cell = std::max(box.max[0] - box.min[0], box.max[1] - box.min[1]) / cells;
        const Contour contour([&](const Vec3& x) { return surface.nearest(x).distance; }, box, cell);
        std::vector<Piece> pieces;
        for (const ContourPiece& p : contour.pieces)
            if (length(p.piece.to - p.piece.from) > 0) pieces.push_back(p.piece);
        return pieces;
    };
    const auto rough = cut(surface.bounds(), first_cells);
    return rough.empty() ? rough : cut(bounds_of(rough), slice_cells);
}

} // namespace treacle::scene
