// Unions, intersections and differences.
#include "scene/sampling/joined_fold.hpp"
#include "scene/sampling/poisson_disk_layer.hpp"
#include "scene/shapes/triangle_bvh.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace treacle::scene {
namespace {

constexpr int cells_3d = 48, cells_2d = 512; // points of the surface along its longest edge
constexpr double most_points = 2e4;          // of one part
constexpr double finer = 3.5;                // candidates of a layer per spacing, along each axis
constexpr int newton_steps = 20;
constexpr int slides = 12;     // along the surface to where it is nearest, at most
constexpr double sharp = 0.94; // cosine between the faces of a part's own edge, at most
constexpr int no_other = -1, own = -2;
constexpr double parallel = 1e-4; // sine between two faces that have no edge

// A point of the surface: of one part's face, of the edge of two, or of a part's own edge.
struct Mark {
    Vec3 x{0, 0, 0};
    int leaf = 0, other = no_other;
    Vec3 normal{0, 0, 0}; // of a face or own edge: of the leaf, outwards
};

// Marks by where they are.
class Marks {
public:
    explicit Marks(std::vector<Mark> marks) : marks_(std::move(marks)), tree_(as_triangles(marks_)) {}
    const Mark& nearest(const Vec3& x) const { return marks_[tree_.closest(x).triangle]; }
    bool empty() const { return marks_.empty(); }
    const std::vector<Mark>& all() const { return marks_; }

private:
    static std::vector<Triangle> as_triangles(const std::vector<Mark>& marks) {
        std::vector<Triangle> out;
        out.reserve(marks.size());
        for (const Mark& mark : marks) out.push_back({mark.x, mark.x, mark.x});
        return out;
    }
    std::vector<Mark> marks_;
    TriangleBvh tree_;
};

class Joined final : public Surface {
public:
    Joined(const Solid& solid, int dimensions) : fold_(solid), dimensions_(dimensions), bounds_(bounds_of(solid)) {
        if (dimensions_ == 2) bounds_.min[2] = bounds_.max[2] = 0;
        for (int a = 0; a < dimensions_; ++a) nowhere_ = nowhere_ || bounds_.min[a] > bounds_.max[a];
        if (nowhere_) return;
        ended_ = true;
        for (int a = 0; a < dimensions_; ++a)
            ended_ = ended_ && std::isfinite(bounds_.min[a]) && std::isfinite(bounds_.max[a]);
        if (!ended_) {
            find_size();
            return;
        }
        const Vec3 edges = bounds_.max - bounds_.min;
        const double longest = std::max({edges[0], edges[1], edges[2]});
        if (!(longest > 0)) return;
        size_ = length(edges);
        gap_ = longest / (dimensions_ == 2 ? cells_2d : cells_3d);
        mark_surface();
        nowhere_ = faces_.empty();
    }

    bool nowhere() const { return nowhere_; }

    Nearest nearest(const Vec3& at) const override {
        const Vec3 x = dimensions_ == 2 ? Vec3{at[0], at[1], 0} : at;
        const Hit hit = fold_.at(x);
        if (hit.leaf < 0 || (!ended_)) return {hit.distance, hit.normal};
        const Vec3 foot = x - hit.distance * hit.normal;
        if (on_surface(hit.leaf, foot, sign_of(hit.leaf) * hit.normal)) return {hit.distance, hit.normal};
        return nearest_mark(x, hit);
    }
    double bound(const Vec3& x) const override { return fold_.at(x).distance; }
    Bounds bounds() const override { return bounds_; }
    double volume() const override { return Bounds::infinite; } // SolidRegion integrates what has an end
    double area() const override { return ended_ ? area_ : Bounds::infinite; }

    SurfaceSamples sample(const SurfaceSampling& sampling) const override {
        const double d = sampling.spacing;
        std::vector<Vec3> candidates, fixed, stuck;
        visit_faces([&](const Surface&) { return d / finer; }, sampling.clip, d + std::abs(sampling.inset),
            [&](const Mark& mark) {
                add_edges(mark, sampling, fixed);
                if (sampling.inset == 0 && ended_ && on_own_edge(mark)) fixed.push_back(mark.x);
                if (!on_surface(mark.leaf, mark.x, mark.normal)) return;
                if (const auto s = lower(mark, sampling)) (s->thin ? stuck : candidates).push_back(s->point);
            });
        const std::size_t edges = fixed.size();
        fixed.insert(fixed.end(), stuck.begin(), stuck.end());
        PoissonDiskLayer layer(
            d, [&](const Vec3& x, double tolerance) { return project(*this, x, sampling.inset, tolerance); });
        layer.choose(candidates, fixed);
        layer.relax();
        layer.fill(fixed);
        layer.fill(candidates);
        fixed.erase(fixed.begin(), fixed.begin() + static_cast<std::ptrdiff_t>(edges));
        SurfaceSamples result;
        result.positions = layer.points();
        for (const Vec3& x : result.positions) result.normals.push_back(nearest(x).normal);
        PointGrid grid(d, fixed.size());
        for (const Vec3& x : fixed) grid.add(x);
        for (const Vec3& x : result.positions) result.thin += grid.any_within(x, 1e-9 * d) ? 1 : 0;
        return result;
    }

private:
    double sign_of(int leaf) const { return fold_.leaves()[static_cast<std::size_t>(leaf)].sign; }
    const Surface& surface_of(int leaf) const { return *fold_.leaves()[static_cast<std::size_t>(leaf)].surface; }
    double eps() const { return 1e-6 * size_; }
    bool on_surface(int leaf, const Vec3& p, const Vec3& normal) const { return fold_.bounds(leaf, p, normal, eps()); }

    // Size of the parts that have an end, for solids without one.
    void find_size() {
        for (const Leaf& leaf : fold_.leaves()) {
            if (!leaf.surface || !std::isfinite(leaf.surface->area())) continue;
            size_ = std::max(size_, length(leaf.surface->bounds().max - leaf.surface->bounds().min));
        }
        if (!(size_ > 0)) size_ = 1;
    }

    // Points of all parts' surfaces, whether they are on that of the whole or not.
    template <class Spacing, class Visit>
    void visit_faces(const Spacing& spacing_of, Bounds clip, double margin, const Visit& visit) const {
        if (ended_) clip = bounds_;
        for (int a = 0; a < dimensions_; ++a) {
            clip.min[a] -= margin;
            clip.max[a] += margin;
        }
        for (std::size_t l = 0; l < fold_.leaves().size(); ++l) {
            const Leaf& leaf = fold_.leaves()[l];
            if (!leaf.surface) continue;
            const auto samples = leaf.surface->scatter({spacing_of(*leaf.surface), 0, clip});
            for (std::size_t i = 0; i < samples.positions.size(); ++i)
                visit(Mark{samples.positions[i], static_cast<int>(l), no_other, samples.normals[i]});
        }
    }

    void mark_surface() {
        std::vector<Mark> faces, edges;
        PointGrid taken(gap_, 64);
        std::vector<double> all(fold_.leaves().size(), 0), kept(all);
        // A part that is much larger than the whole has its points farther apart.
        max_slide_ = 3 * gap_;
        const auto spacing_of = [&](const Surface& surface) {
            const double area = surface.area();
            const double least = !std::isfinite(area) ? 0
                                 : dimensions_ == 2   ? area / most_points
                                                      : std::sqrt(area / most_points);
            max_slide_ = std::max(max_slide_, 3 * least);
            return std::max(gap_, least);
        };
        visit_faces(spacing_of, {}, gap_, [&](const Mark& mark) {
            const auto l = static_cast<std::size_t>(mark.leaf);
            all[l] += 1;
            const auto take_edge = [&](const Mark& edge) {
                if (taken.any_within(edge.x, 0.3 * gap_)) return;
                taken.add(edge.x);
                edges.push_back(edge);
            };
            if (on_own_edge(mark)) take_edge({mark.x, mark.leaf, own, mark.normal});
            for_edges(mark, 1.5 * gap_, 0, take_edge);
            if (!on_surface(mark.leaf, mark.x, mark.normal)) return;
            kept[l] += 1;
            faces.push_back(mark);
        });
        for (std::size_t l = 0; l < all.size(); ++l) {
            if (all[l] == 0) continue;
            const double whole = fold_.leaves()[l].surface->area();
            area_ += std::isfinite(whole) ? whole * kept[l] / all[l] : kept[l] * std::pow(gap_, dimensions_ - 1);
        }
        tighten(faces, edges);
        faces_ = Marks(std::move(faces));
        edges_ = Marks(std::move(edges));
    }

    // The bounds of the points, where the parts' leave room.
    void tighten(const std::vector<Mark>& faces, const std::vector<Mark>& edges) {
        Bounds box = Bounds::nothing();
        for (const auto* marks : {&faces, &edges})
            for (const Mark& mark : *marks)
                for (int a = 0; a < 3; ++a) {
                    box.min[a] = std::min(box.min[a], mark.x[a]);
                    box.max[a] = std::max(box.max[a], mark.x[a]);
                }
        for (int a = 0; a < dimensions_; ++a) {
            // A round side has no point at its farthest, and the parts' bounds are that exactly.
            if (box.min[a] > bounds_.min[a] + gap_) bounds_.min[a] = box.min[a];
            if (box.max[a] < bounds_.max[a] - gap_) bounds_.max[a] = box.max[a];
        }
    }

    // The point near p where two parts are at these distances, by Newton's method with the shortest steps.
    std::optional<Vec3> corner(int leaf, int other, double level, double other_level, Vec3 p) const {
        for (int step = 0; step < newton_steps; ++step) {
            const Nearest a = surface_of(leaf).nearest(p), b = surface_of(other).nearest(p);
            const double ra = a.distance - level, rb = b.distance - other_level;
            const double cosine = dot(a.normal, b.normal), squared_sine = 1 - cosine * cosine;
            if (squared_sine < parallel * parallel) return std::nullopt;
            if (std::abs(ra) < 1e-3 * eps() && std::abs(rb) < 1e-3 * eps()) return p;
            p = p - ((ra - cosine * rb) / squared_sine) * a.normal - ((rb - cosine * ra) / squared_sine) * b.normal;
        }
        return std::nullopt;
    }

    // True when some of the sectors between two faces around a point of their edge are inside and some outside.
    bool parts_sectors(const Vec3& a, const Vec3& b, const Vec3& p) const {
        int inside = 0;
        for (int sector = 0; sector < 4; ++sector) {
            const Vec3 way = (sector & 1 ? 1.0 : -1.0) * a + (sector & 2 ? 1.0 : -1.0) * b;
            inside += fold_.at(p + eps() * unit(way)).distance < 0;
        }
        return inside > 0 && inside < 4;
    }
    bool edge_of_whole(int leaf, int other, const Vec3& p) const {
        return parts_sectors(surface_of(leaf).nearest(p).normal, surface_of(other).nearest(p).normal, p);
    }
    // True when a part has an edge there, which is one of the whole.
    bool on_own_edge(const Mark& mark) const {
        const Vec3 u = perpendicular(mark.normal), v = dimensions_ == 2 ? u : cross(mark.normal, u);
        std::array<Vec3, 4> faces;
        for (int k = 0; k < 4; ++k)
            faces[k] = surface_of(mark.leaf).nearest(mark.x + (k & 2 ? -1e-3 : 1e-3) * gap_ * (k & 1 ? u : v)).normal;
        for (int k = 1; k < 4; ++k)
            if (dot(faces[0], faces[k]) < sharp && parts_sectors(faces[0], faces[k], mark.x)) return true;
        return false;
    }

    // The edges with other parts near a point of one's surface, at a depth below the whole's surface. Each pair once, from the
    // lower one's points and from the other's.
    template <class Visit>
    void for_edges(const Mark& mark, double range, double inset, const Visit& visit) const {
        const auto& leaves = fold_.leaves();
        for (std::size_t m = 0; m < leaves.size(); ++m) {
            const int other = static_cast<int>(m);
            if (other == mark.leaf || !leaves[m].surface) continue;
            if (std::abs(leaves[m].surface->nearest(mark.x).distance) > range) continue;
            const double level = -inset * sign_of(mark.leaf), other_level = -inset * sign_of(other);
            const auto p = corner(mark.leaf, other, level, other_level, mark.x);
            if (!p || length(*p - mark.x) > 2 * range) continue;
            if (inset == 0 && !edge_of_whole(mark.leaf, other, *p)) continue;
            visit(Mark{*p, mark.leaf, other, mark.normal});
        }
    }

    void add_edges(const Mark& mark, const SurfaceSampling& sampling, std::vector<Vec3>& out) const {
        const double tolerance = 1e-3 * sampling.spacing;
        for_edges(
            mark, 1.5 * sampling.spacing / finer + 2 * std::abs(sampling.inset), sampling.inset, [&](const Mark& edge) {
                if (std::abs(nearest(edge.x).distance + sampling.inset) < tolerance) out.push_back(edge.x);
            });
    }

    // From a point of the whole's surface to the depth of the layer.
    std::optional<InsetPoint> lower(const Mark& mark, const SurfaceSampling& sampling) const {
        if (sampling.inset == 0) return InsetPoint{mark.x, false};
        const Vec3 out = sign_of(mark.leaf) * mark.normal, p = mark.x - sampling.inset * out;
        if (std::abs(nearest(p).distance + sampling.inset) < 1e-6 * sampling.spacing) return InsetPoint{p, false};
        return project_to_inset(*this, mark.x, out, sampling.inset, sampling.spacing);
    }

    // Along a face from the mark to where that is nearest to x.
    std::optional<Vec3> slide_on_face(const Mark& mark, const Vec3& x) const {
        const Surface& surface = surface_of(mark.leaf);
        Vec3 y = mark.x, normal = mark.normal;
        for (int step = 0; step < slides; ++step) {
            const Vec3 way = x - y, before = y;
            y = y + (way - dot(way, normal) * normal);
            const Nearest near = surface.nearest(y);
            y = y - near.distance * near.normal;
            normal = surface.nearest(y).normal;
            if (length(y - before) < 1e-5 * eps()) break;
        }
        if (length(y - mark.x) > max_slide_ || !on_surface(mark.leaf, y, normal)) return std::nullopt;
        return y;
    }
    std::optional<Vec3> slide_on_edge(const Mark& mark, const Vec3& x) const {
        if (mark.other == own) return slide_on_own_edge(mark, x);
        Vec3 y = mark.x;
        for (int step = 0; step < slides; ++step) {
            const Vec3 along =
                unit(cross(surface_of(mark.leaf).nearest(y).normal, surface_of(mark.other).nearest(y).normal));
            const auto next = corner(mark.leaf, mark.other, 0, 0, y + dot(x - y, along) * along);
            if (!next) return std::nullopt;
            const double moved = length(*next - y);
            y = *next;
            if (moved < 1e-5 * eps()) break;
        }
        if (length(y - mark.x) > max_slide_ || !edge_of_whole(mark.leaf, mark.other, y)) return std::nullopt;
        return y;
    }
    // From far enough outside, the edge is the nearest point of a part.
    std::optional<Vec3> slide_on_own_edge(const Mark& mark, const Vec3& x) const {
        const Surface& surface = surface_of(mark.leaf);
        Vec3 y = mark.x, normal = mark.normal;
        for (int step = 0; step < slides; ++step) {
            const Vec3 way = x - y, aside = way - dot(way, normal) * normal;
            const Vec3 from = y + aside + (1.5 * length(aside) + gap_) * normal;
            const Nearest near = surface.nearest(from);
            const Vec3 next = from - near.distance * near.normal;
            const double moved = length(next - y);
            y = next;
            normal = turned_along(surface, y, normal);
            if (moved < 1e-5 * eps()) break;
        }
        if (length(y - mark.x) > max_slide_) return std::nullopt;
        return on_own_edge({y, mark.leaf, own, normal}) ? std::optional(y) : std::nullopt;
    }
    // The middle of the normals of the faces that meet at y, near that of a point beside it.
    Vec3 turned_along(const Surface& surface, const Vec3& y, const Vec3& normal) const {
        const Vec3 u = perpendicular(normal), v = dimensions_ == 2 ? u : cross(normal, u);
        Vec3 sum{0, 0, 0};
        for (const Vec3& way : {u, v, -u, -v}) sum += surface.nearest(y + 1e-3 * gap_ * way).normal;
        return unit(sum, normal);
    }

    // Nearest point of the whole where that of the part is none of the whole's.
    Nearest nearest_mark(const Vec3& x, const Hit& hit) const {
        Vec3 best = faces_.nearest(x).x;
        double least = length(x - best);
        const auto take = [&](const std::optional<Vec3>& y) {
            if (!y || length(x - *y) >= least) return;
            best = *y;
            least = length(x - best);
        };
        take(slide_on_face(faces_.nearest(x), x));
        if (!edges_.empty()) {
            take(edges_.nearest(x).x);
            take(slide_on_edge(edges_.nearest(x), x));
        }
        // On a face that two parts share, a side of either is one of the whole.
        const bool on_part = std::abs(hit.distance) < 2 * eps();
        const bool inside = (on_part ? fold_.at(x + 4 * eps() * hit.normal).distance : hit.distance) < 0;
        const double side = inside ? -1 : 1;
        if (least < eps()) return {side * least, hit.normal};
        return {side * std::max(least, std::abs(hit.distance)), (side / least) * (x - best)};
    }

    Fold fold_;
    int dimensions_;
    Bounds bounds_;
    bool ended_ = false, nowhere_ = false;
    double max_slide_ = 0;                 // [m] of a slide
    double size_ = 0, gap_ = 0, area_ = 0; // [m], [m], [m2]
    Marks faces_{{}}, edges_{{}};
};

} // namespace

SurfacePointer join(const Solid& solid, int dimensions) {
    auto out = std::make_shared<Joined>(solid, dimensions);
    return out->nowhere() ? nullptr : out;
}

} // namespace treacle::scene
