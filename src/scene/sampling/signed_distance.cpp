#include "scene/sampling/signed_distance.hpp"

#include "base/text/error.hpp"
#include "scene/sampling/solid.hpp"
#include "scene/shapes/vector_math.hpp"

#include <cmath>

namespace treacle::scene {
namespace {

[[noreturn]] void reject(
    const Shape& shape, const std::string& problem, const std::string& reason, const std::string& cure) {
    throw InputError({shape.where, std::string(name_of(shape.kind)) + problem, reason, cure});
}

[[noreturn]] void reject_empty(const Shape& shape, int dimensions) {
    if (shape.clip)
        throw InputError({shape.where, std::string(name_of(shape.parts.front().kind)) + ".clip leaves nothing",
            "it is all outside of the domain", "move it into the domain"});
    const std::string at = dimensions == 2 ? " at z = 0, which is all that a plane scene sees" : "";
    if (shape.kind == ShapeKind::subtract)
        reject(shape, " is empty", "what is subtracted covers all of `from`" + at, "move or shrink what is subtracted");
    if (shape.kind == ShapeKind::intersect)
        reject(shape, " is empty", "its shapes have nothing in common" + at, "move them until they overlap");
    reject(shape, " does not meet the plane z = 0", "a plane scene sees only the cut of a shape at z = 0",
        "move it to z = 0");
}

bool is_infinite(const Bounds& box, int dimensions) {
    for (int a = 0; a < dimensions; ++a)
        if (!std::isfinite(box.min[a]) || !std::isfinite(box.max[a])) return true;
    return false;
}

} // namespace

SolidRegion::SolidRegion(const Shape& shape, int dimensions) : dimensions_(dimensions) {
    SolidNotes notes;
    Solid solid = make_solid(shape, dimensions, notes);
    meshes_ = notes.meshes;
    if (!solid.joined()) {
        inverted_ = solid.inverted;
        surface_ = solid.surface;
        if (!surface_) reject_empty(shape, dimensions);
        moments_ = notes.moments;
        return;
    }
    // The surface belongs to whichever of a solid and its outside has an end.
    if (is_infinite(bounds_of(solid), dimensions)) {
        Solid outside = solid;
        outside.inverted ^= true;
        if (!is_infinite(bounds_of(outside), dimensions)) {
            solid = outside;
            inverted_ = true;
        }
    }
    surface_ = join(solid, dimensions);
    if (!surface_) reject_empty(shape, dimensions);
    if (!closed()) return;
    SampledSolid sampled;
    sampled.distance = [this](const Vec3& x) { return surface_->nearest(x).distance; };
    sampled.bound = [this](const Vec3& x) { return surface_->bound(x); };
    sampled.normal = [this](const Vec3& x) { return surface_->nearest(x).normal; };
    sampled.bounds = surface_->bounds();
    sampled.dimensions = dimensions_;
    moments_ = moments_of(sampled);
    if (!(moments_->volume > 0)) reject_empty(shape, dimensions);
    if (shape.kind != ShapeKind::mesh || dimensions_ == 2) return;
    meshes_.front().separate_volume = meshes_.front().volume;
    meshes_.front().volume = moments_->volume;
}

double SolidRegion::distance(const Vec3& x, DistanceBound known) const {
    if (inverted_) known.sign = -known.sign;
    const double distance = surface_->distance(x, known);
    return inverted_ ? -distance : distance;
}

Vec3 SolidRegion::normal(const Vec3& x) const {
    const Vec3 normal = surface_->nearest(x).normal;
    return inverted_ ? -normal : normal;
}

Bounds SolidRegion::bounds() const { return inverted_ ? Bounds{} : surface_->bounds(); }
Bounds SolidRegion::surface_bounds() const { return surface_->bounds(); }
double SolidRegion::volume() const {
    if (inverted_) return Bounds::infinite;
    return moments_ ? moments_->volume : surface_->volume();
}
double SolidRegion::area() const { return surface_->area(); }
Moments SolidRegion::moments() const {
    if (moments_) return *moments_;
    SampledSolid sampled;
    sampled.distance = [this](const Vec3& x) { return surface_->nearest(x).distance; };
    sampled.bounds = surface_->bounds();
    sampled.dimensions = dimensions_;
    sampled.volume = surface_->volume();
    return moments_of(sampled);
}
bool SolidRegion::closed() const { return std::isfinite(surface_->area()); }

} // namespace treacle::scene
