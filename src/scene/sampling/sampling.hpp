#pragma once
#include "scene/sampling/signed_distance.hpp"
#include "scene/shapes/bounds.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace treacle::scene {

using Regions = std::vector<SolidRegion>; // their union

// Signed distance of their union [m], negative inside; Bounds::infinite of none.
double distance_to(const Regions& regions, const Vec3& x);
// Moments of their union; each must be of finite volume.
Moments moments_of(const Regions& regions);

// The points x = min + (i + 1/2) spacing of a domain. In the plane z is 0 and has one index.
struct Lattice {
    double spacing = 0; // d [m]
    Vec3 min{0, 0, 0};  // [m]
    Vec3 max{0, 0, 0};  // [m]
    int dimensions = 3;

    std::array<std::int64_t, 3>
    size() const; // points half a spacing clear of the domain's far sides, per axis; InputError when > 2^62 in all
    std::uint64_t points() const;                                  // product of size()
    Vec3 position(const std::array<std::int64_t, 3>& index) const; // [m], inside the domain or not
    bool fits(int axis) const;                                     // the domain's edge is a multiple of d, to 1e-6 d
};

// ---- liquids ----

// Lattice points that are taken beside solids, with a clearance of 0: those outside of them; or so many of those within half a spacing
// of a surface, spread evenly over it, as there is room for, moved out where they lie too deep.
enum class Filling { points, room };

// Request to fill_volume().
struct VolumeFill {
    std::vector<Regions> liquids; // where two overlap, the first one counts
    Regions solids;               // their union
    double clearance =
        0; // [m] least distance of a particle from the solids; 0: points on a face count as those of the liquid
    Lattice lattice;                   // of the whole domain
    Bounds part;                       // half-open box [min, max): only the particles in it are made
    Filling filling = Filling::points; // of points beside solids
};

// Particles of fill_volume(), all arrays in one order.
struct VolumeSamples {
    std::vector<Vec3> positions;    // [m], sorted by lattice index, x fastest
    std::vector<std::uint64_t> ids; // liquid * lattice.points() + lattice index, whatever the parts
    std::vector<int> liquids;       // index into VolumeFill::liquids
    double room = 0;                // with a clearance of 0: of the liquids outside the solids [points]
};

// The lattice points inside the liquids, `clearance` clear of the solids, and inside the part: the same
// particles, bit for bit, however the domain is cut into parts. A point on a face of a shape belongs to the
// shape when the inside lies towards +x (then +y, +z): a box of n spacings has n layers.
VolumeSamples fill_volume(const VolumeFill& fill);

// Particles of each liquid in the whole domain (`part` does not count), without making them: exact up to
// about 128 points an edge of the bounding box, beyond that to about 1 %.
std::vector<std::uint64_t> estimate_liquid_counts(const VolumeFill& fill);

// Lattice points of a liquid that lie in solids, or outside the domain.
struct Overlap {
    std::uint64_t count = 0; // lattice points concerned
    std::uint64_t total = 0; // lattice points of the liquid
    Vec3 example{0, 0, 0};   // [m] one of them, when count > 0
    // In [0, 1]; 0 without liquid.
    double fraction() const { return total > 0 ? static_cast<double>(count) / static_cast<double>(total) : 0; }
};

// Lattice points of the liquid inside a solid, by more than 1e-6 d.
Overlap find_overlap(const Regions& liquid, const Regions& solids, const Lattice& lattice);

// Points of the lattice, carried on beyond the domain, that are inside the liquid but outside the domain.
// Unbounded regions (planes, inverted shapes) mean "whatever is in the domain" and are left out.
Overlap find_outside(const Regions& liquid, const Lattice& lattice);

// Share of the domain that the solids take, to about 1 %.
double solid_fraction(const Regions& solids, const Lattice& lattice);

// ---- surfaces of solids ----

// Request to sample_surface().
struct SurfaceSampling {
    double spacing = 0; // d [m]
    double inset = 0;   // [m] depth of the layer below the surface
    Bounds clip;        // samples outside are left out; must be finite across a plane's extent
};

// Layer of points of one region.
struct SurfaceSamples {
    std::vector<Vec3> positions; // [m]
    std::vector<Vec3> normals;   // unit, out of the solid
    std::size_t thin = 0;        // samples where the solid is thinner than twice the inset; they lie in its middle
};

// One layer of points about d apart, at the depth `inset`, the same on every machine run and rank. Boxes,
// cylinders and cones have points exactly on their edges; in 2D outlines are divided evenly. Where an
// inverted shape is sampled at a depth, its edges stay sharp.
SurfaceSamples sample_surface(const SolidRegion& region, const SurfaceSampling& sampling);

// Upper estimate of sample_surface's number.
std::uint64_t estimate_surface_count(const SolidRegion& region, const SurfaceSampling& sampling);

// ---- walls of the domain ----

// Kind of a side: a wall has points, the others none.
enum class Side { wall, open, periodic };

// Request to sample_domain_walls().
struct WallSampling {
    Lattice lattice;             // of the liquid
    std::array<Side, 6> sides{}; // x_min, x_max, y_min, y_max, z_min, z_max
    double outset = 0;           // [m] distance of the layer outside the domain
    Bounds part;                 // half-open; a point belongs to the part that holds its nearest domain point
};

// Layer of points around a part of the domain.
struct WallSamples {
    std::vector<Vec3> positions;    // [m]
    std::vector<Vec3> normals;      // unit, into the domain
    std::vector<int> faces;         // side 0..5; edges and corners belong to the lowest of their sides
    std::vector<std::uint64_t> ids; // 0 .. count_domain_walls - 1, whatever the parts
};

// One layer on the lattice of the liquid, carried on round edges and corners between walls with steps of at
// most d. InputError when a periodic edge of the domain is not a multiple of d.
WallSamples sample_domain_walls(const WallSampling& sampling);
std::uint64_t count_domain_walls(const WallSampling& sampling);

} // namespace treacle::scene
