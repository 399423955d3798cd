#pragma once
// Private to src/scene: the surfaces behind SolidRegion.
#include "scene/sampling/sampling.hpp"
#include "scene/shapes/bounds.hpp"
#include "scene/shapes/mesh.hpp"

#include <functional>
#include <memory>
#include <optional>

namespace treacle::scene {

// Signed distance of a point from a surface.
struct Nearest {
    double distance = 0;  // [m] negative inside
    Vec3 normal{0, 0, 0}; // unit gradient of the distance
};

// Boundary of a solid, without an end for a plane. Lengths [m], areas [m2], volumes [m3]; in 2D an outline in z = 0,
// with its length [m] as area and its area [m2] as volume.
class Surface {
public:
    virtual ~Surface() = default;
    virtual Nearest nearest(const Vec3& x) const = 0; // exact, x [m]
    // [m] nearest(x).distance, from what is known of it.
    virtual double distance(const Vec3& x, const DistanceBound&) const { return nearest(x).distance; }
    // [m] a distance of the same sign that is no larger in magnitude, and quicker to find.
    virtual double bound(const Vec3& x) const { return nearest(x).distance; }
    virtual Bounds bounds() const = 0;
    virtual double volume() const = 0;
    virtual double area() const = 0;
    // A negative inset puts the layer outside.
    virtual SurfaceSamples sample(const SurfaceSampling& sampling) const = 0;
    // Points and normals of the surface about a spacing apart, less evenly and more quickly; the inset does not count.
    virtual SurfaceSamples scatter(const SurfaceSampling& sampling) const { return sample(sampling); }
};

using SurfacePointer = std::shared_ptr<const Surface>; // immutable, shared by copies of a region

// A box at any angle.
struct BoxPose {
    // Middle, and half of the edges along the axes [m].
    Vec3 centre{0, 0, 0};
    Vec3 half{0, 0, 0};
    std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}; // of its edges, unit
    bool turned = false;                                                   // the axes are not those of space
    Vec3 min{0, 0, 0}, max{0, 0, 0}; // the corners themselves, used when it is not turned
};
SurfacePointer make_box(const BoxPose& pose, int dimensions); // 2: a rectangle turned about z

// Half-space behind the plane through a point [m]; the normal is unit, outward, and in 2D has no z.
SurfacePointer make_plane(const Vec3& point, const Vec3& normal, int dimensions);

// Shape of a body of revolution; `height` is that of cylinder, capsule and cone, `tube` that of the torus.
enum class Profile { sphere, cylinder, capsule, cone, torus };

// A body of revolution, whose profile lies in the half-plane (distance from the axis, height along it).
struct SurfaceOfRevolution {
    Profile profile = Profile::sphere;
    Vec3 centre{0, 0, 0};                    // [m] middle
    Vec3 axis{0, 0, 1};                      // unit
    double radius = 0, tube = 0, height = 0; // [m] as in Shape
};
SurfacePointer make_revolved(const SurfaceOfRevolution& body);
// The cut of a body whose axis and centre lie on the plane z = 0.
SurfacePointer make_outline(const SurfaceOfRevolution& body);
// Disc (inner radius 0) or ring on the plane z = 0.
SurfacePointer make_ring(const Vec3& centre, double inner, double outer);

// Surface of a closed mesh; bounds, area and volume are those of the report, in the mesh's present place [m].
SurfacePointer make_mesh(const TriangleMesh& mesh, const MeshReport& report);

// Equal steps of about d along a length: never longer than 1.05 d, 0 for no length at all.
std::int64_t count_intervals(double length, double spacing);

// ---- layers below a surface ----

// Point of a layer below a surface.
struct InsetPoint {
    Vec3 point{0, 0, 0}; // [m]
    bool thin = false;   // the body is thinner than twice the inset here: its middle instead
};
// From the surface point c with outward normal n to the depth `inset`; nothing where the body has no such
// depth although it is thick along the normal, as on the rim of a plate.
std::optional<InsetPoint> project_to_inset(
    const Surface& surface, const Vec3& c, const Vec3& n, double inset, double spacing);

// The point at depth `inset` next to x, by Newton steps until the depth is right to the tolerance [m] before
// the last one; or nothing where the body is thinner.
std::optional<Vec3> project(const Surface& surface, const Vec3& x, double inset, double tolerance);

// A region of the plane z = 0 bounded by straight pieces, inside to the left of each.
struct Piece {
    Vec3 from{0, 0, 0}, to{0, 0, 0}; // [m]
};
using Inside = std::function<bool(const Vec3&)>;
SurfacePointer make_cross_section(const std::vector<Piece>& pieces, Inside inside);
std::vector<Piece> slice(const TriangleMesh& mesh); // at z just below 0
std::vector<Piece> slice(const Surface& surface);   // on a grid, to 1e-5 of its size

} // namespace treacle::scene
