#pragma once
#include "app/input/input.hpp"
#include "app/setup/spanning.hpp"
#include "flow/viscosity_model.hpp"
#include "mpi/comm.hpp"
#include "scene/sampling/sampling.hpp"
#include "sph/model/domain.hpp"
#include "sph/model/lattice.hpp"
#include "sph/model/neighbourhood.hpp"

namespace treacle::app {

// The shapes of a scene, read and placed; nothing large has been allocated yet.
struct Geometry {
    scene::Lattice lattice;
    std::vector<scene::Regions> liquids; // one union per liquid
    std::vector<Vec3> pivots; // [m] per liquid, of its velocity at the start; 0 where that is the same everywhere
    std::vector<scene::Regions> viscosity_regions; // per liquid
    scene::Regions bodies;
    std::vector<char> moving; // per body: 1 when its place changes
    scene::WallSampling walls;
    double offset = 0;              // depth of a solid's particle layer below its surface [m]
    std::vector<std::string> notes; // fallbacks taken and the like
    scene::Regions originals;       // the bodies without their images, for masses and extents
    std::vector<Axes> spans;        // of the bodies, the periods that they are as long as
};

// Index of a body's loads and slip: the six sides of the domain come first, then the bodies of the scene.
inline constexpr int domain_sides = 6;

// Kernel, support radius [m] and spacings [m] of the particles on solids, as src/sph takes them.
sph::WallSetup wall_setup(const Input& input);

// Depth of a solid's particle layer below its surface, at which a resting lattice of liquid that touches the
// surface keeps its rest density [m].
double solid_offset(const Input& input);

// Spacing of the lattice that the liquid starts on [m].
double particle_spacing(const Input& input);

// Reads meshes and builds the regions. Throws InputError.
Geometry build_geometry(const Input& input);

// Sampling of the surfaces of bodies: where the domain has walls, up to the layer of these, so that the two layers
// meet; bodies that move are sampled whole.
scene::SurfaceSampling body_sampling(const Geometry& geometry, std::size_t body);

// Share of a solid's surface, in the domain, behind which it is thinner than the spacing.
double thin_surface(const scene::SolidRegion& region, const Geometry& geometry, double spacing);

// Note to users when bodies are thinner than two layers.
std::string thin_note(std::size_t samples);

// Numbers of particles, without making them.
struct ParticleCounts {
    std::uint64_t liquid = 0;
    std::uint64_t solid = 0;
};
// The liquids' points on a lattice beside the bodies. Where SPH recovers the density in positions, liquid fills the room up to the solids and is then spread
// (IsphStep::spread): cut half a spacing off, a liquid around a body would lack half a layer, and fall into the gaps.
scene::VolumeFill liquid_fill(const Input& input, const Geometry& geometry, const scene::Lattice& lattice);

// Local, the same on each rank. Without inflow; no solid particles with method grid.
ParticleCounts estimate_particles(const Input& input, const Geometry& geometry);

// Checks a geometry for faults: bodies in each other, liquid in a solid or outside of the domain, no liquid at all,
// more particles than the machine's memory holds. Throws InputError with all of it.
void validate_geometry(const Input& input, const Geometry& geometry, const Comm& comm);

// Bytes that a run needs per liquid and per solid particle, in total.
double bytes_per_particle(const Input& input);

// The largest that a liquid has anywhere and at any shear rate [Pa s].
double largest_viscosity(const scene::Liquid& liquid);

// Viscosity of what an inlet at x pours: a liquid's regions apply to its initial particles only [Pa s].
double inflow_viscosity(const scene::Liquid& liquid, const Vec3& x);

// Viscosity of a particle of liquid `which` of the scene that starts at x [Pa s].
double initial_viscosity(const Input& input, const Geometry& geometry, std::size_t which, const Vec3& x);

// Dependence of each liquid's viscosity on the shear rate; none where that of no liquid depends on it.
std::vector<flow::ViscosityModel> viscosity_models(const Input& input);

// True when any liquid's particles differ in viscosity, or any viscosity depends on the shear rate.
bool viscosities_vary(const Input& input);

// Materials of the scene's liquids, with their largest viscosities.
std::vector<sph::LiquidMaterial> liquid_materials(const Input& input);

// Viscosity of one liquid, with the density of liquid 0, that has the same explicit step limit as all liquids together
// [Pa s].
double limiting_viscosity(const Input& input);

// True when a wall or body has a slip length.
bool any_slip_length(const Input& input);

// Resolves `integration: automatic`: implicit where viscosities vary, solids have slip lengths, or where the explicit
// viscosity would affect the step, that is where its limit is within four times the largest step that
// all else allows.
sph::ViscosityIntegration viscosity_integration(const Input& input);

// Largest step of the viscosity if that is explicit, else 1e300 [s].
double viscous_step_limit(const Input& input);

// Largest step of the surface tension if it is modelled, else 1e300 [s].
double capillary_step_limit(const Input& input);

// Masses, volumes and rest densities of the first liquid from the lattice.
sph::Constants make_constants(const Input& input);

} // namespace treacle::app
