#include "scene/camera/triangle_raster.hpp"

#include "scene/shapes/vector_math.hpp"

namespace treacle::scene {

namespace {
constexpr double farthest = 1 << 20; // [pixels] of a point outside of the picture
constexpr int deepest = 12;          // splits of a triangle one within the other
} // namespace

Seen Projection::at(const Vec3& in_camera) const {
    Seen out{in_camera, 0, 0};
    if (in_camera[2] >= near) {
        const auto pixel = camera_.project_camera(in_camera);
        out.x = std::clamp(pixel.x, -farthest, farthest);
        out.y = std::clamp(pixel.y, -farthest, farthest);
    }
    return out;
}

Seen Projection::see(const double* position, const double* velocity) const {
    const double middle = 0.5 * (camera_.lens().height - 1);
    double time = exposure_.shift;
    Seen out;
    // The row that a point is seen in depends on the time, and the time on the row.
    const int rounds = velocity != nullptr && exposure_.row_time != 0 ? 3 : 1;
    for (int round = 0; round < rounds; ++round) {
        Vec3 x{position[0], position[1], position[2]};
        if (velocity != nullptr) {
            for (std::size_t k = 0; k < 3; ++k) x[k] += time * velocity[k];
        }
        out = at(camera_.to_camera(x));
        const double row = std::clamp(out.y, 0.0, double(camera_.lens().height - 1));
        time = exposure_.shift + exposure_.row_time * (row - middle);
    }
    return out;
}

Seen Projection::middle(const Seen& a, const Seen& b) const {
    Vec3 m;
    for (std::size_t k = 0; k < 3; ++k) m[k] = 0.5 * (a.camera[k] + b.camera[k]);
    return at(m);
}

bool Projection::bent(const Seen& a, const Seen& b, double straightness) const {
    const bool swap = std::pair(b.x, b.y) < std::pair(a.x, a.y);
    const Seen& p = swap ? b : a;
    const Seen& q = swap ? a : b;
    const Seen m = middle(p, q);
    const double dx = q.x - p.x, dy = q.y - p.y, length = std::hypot(dx, dy);
    if (length < straightness) return false;
    return std::abs(dx * (m.y - p.y) - dy * (m.x - p.x)) > straightness * length;
}

TriangleRaster::TriangleRaster(const Projection& projection, int samples, double straightness)
    : projection_(projection), samples_(samples), width_(projection.camera().lens().width * samples),
      height_(projection.camera().lens().height * samples),
      straightness_(straightness), parts_{{{0, 0, -1}, -Projection::near}} {}

bool TriangleRaster::is_simple(const Piece& piece) const {
    for (const auto& part : parts_) {
        for (const auto& corner : piece.corner)
            if (dot(part.normal, corner.seen.camera) > part.offset) return false;
    }
    for (int k = 0; k < 3; ++k)
        if (projection_.bent(piece.corner[k].seen, piece.corner[(k + 1) % 3].seen, straightness_)) return false;
    return true;
}

TriangleRaster::Corner TriangleRaster::middle(const Corner& a, const Corner& b) const {
    return {projection_.middle(a.seen, b.seen), 0.5 * (a.barycentric + b.barycentric)};
}

// The polygon that is left of a triangle in the half-spaces; edges are cut from the end that stays, whichever comes first.
void TriangleRaster::cut(const Piece& piece) {
    std::vector<Corner> polygon(piece.corner, piece.corner + 3), kept;
    for (const auto& part : parts_) {
        kept.clear();
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Corner &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
            const double from_a = dot(part.normal, a.seen.camera) - part.offset,
                         from_b = dot(part.normal, b.seen.camera) - part.offset;
            if (from_a <= 0) kept.push_back(a);
            if ((from_a <= 0) == (from_b <= 0)) continue;
            const Corner &in = from_a <= 0 ? a : b, &out = from_a <= 0 ? b : a;
            const double d_in = from_a <= 0 ? from_a : from_b, d_out = from_a <= 0 ? from_b : from_a;
            const double t = d_in / (d_in - d_out);
            auto point = in.seen.camera + t * (out.seen.camera - in.seen.camera);
            // Rounding must not bring it before the near plane, where it has no pixel.
            point[2] = std::max(point[2], std::min(Projection::near, in.seen.camera[2]));
            kept.push_back({projection_.at(point), in.barycentric + t * (out.barycentric - in.barycentric)});
        }
        polygon = kept;
    }
    for (std::size_t k = 2; k < polygon.size(); ++k) split({{polygon[0], polygon[k - 1], polygon[k]}}, 0);
}

// Splits at edges whose images are bent; both triangles of an edge split it alike.
void TriangleRaster::split(const Piece& piece, int level) {
    const auto& corner = piece.corner;
    bool bent[3];
    int count = 0;
    for (int k = 0; k < 3; ++k) {
        bent[k] = level < deepest && projection_.bent(corner[k].seen, corner[(k + 1) % 3].seen, straightness_);
        count += bent[k] ? 1 : 0;
    }
    if (count == 0) {
        pieces_.push_back(piece);
        return;
    }
    Corner m[3];
    for (int k = 0; k < 3; ++k) {
        if (bent[k]) m[k] = middle(corner[k], corner[(k + 1) % 3]);
    }
    if (count == 3) {
        for (int k = 0; k < 3; ++k) split({{corner[k], m[k], m[(k + 2) % 3]}}, level + 1);
        return split({{m[0], m[1], m[2]}}, level + 1);
    }
    int first = 0;
    while (!bent[first]) ++first;
    if (count == 2 && bent[(first + 2) % 3]) first = (first + 2) % 3; // the two bent edges follow each other
    const Corner &a = corner[first], &b = corner[(first + 1) % 3], &c = corner[(first + 2) % 3];
    if (count == 1) {
        split({{a, m[first], c}}, level + 1);
        return split({{m[first], b, c}}, level + 1);
    }
    const Corner& next = m[(first + 1) % 3];
    split({{m[first], b, next}}, level + 1);
    split({{a, m[first], next}}, level + 1);
    split({{a, next, c}}, level + 1);
}

} // namespace treacle::scene
