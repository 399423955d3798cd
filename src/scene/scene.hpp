#pragma once
#include "base/text/vec3.hpp"
#include "scene/camera/camera_model.hpp"
#include "scene/shapes/shape.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace treacle {
class Declaration;
}

namespace treacle::scene {

// Treatment of liquid at a side: it stops, leaves, or enters again at the opposite side.
enum class BoundaryKind { wall, open, periodic };
// Condition on the velocity u along a solid: no stress, u = u_solid, or u - u_solid = slip_length du/dn (Navier).
enum class Slip { free_slip, no_slip, slip_length };

// One of the six sides of the domain, in the order x_min, x_max, y_min, y_max, z_min, z_max.
struct Face {
    BoundaryKind kind = BoundaryKind::wall;
    Slip slip = Slip::free_slip;
    double slip_length = 0;   // [m]
    double skin_friction = 0; // c_f
    Vec3 velocity{0, 0, 0};   // [m/s] of the wall, along itself
    int axis = 0;             // across it
    bool outflow = false;     // open: liquid may leave; else what does is lost
    bool mirror = false;      // a free-slip wall beyond which the mirror image of the scene is drawn
    std::string where;

    void declare(Declaration& d); // a side of `domain.boundaries`; values without effect are refused
    // The place at which it was written does not count.
    bool operator==(const Face& other) const {
        return kind == other.kind && slip == other.slip && slip_length == other.slip_length &&
               skin_friction == other.skin_friction && velocity == other.velocity && outflow == other.outflow &&
               mirror == other.mirror;
    }
};

// A plane of symmetry across an axis.
struct MirrorPlane {
    std::size_t axis = 0;
    double position = 0; // [m] along it
};

// Block `domain`.
struct Domain {
    int dimensions = 3;        // 2: plane, every z is 0
    Vec3 min{0, 0, 0};         // [m]
    Vec3 max{1, 1, 1};         // [m]
    std::array<Face, 6> faces; // x_min, x_max, y_min, y_max, z_min, z_max
    double spacing = 0;        // particle spacing d or grid width dx [m]
    Vec3 gravity{0, 0, -9.81}; // [m/s2]; in a 2D scene {0, -9.81, 0} unless given
    std::string where;         // of the spacing

    void declare(Declaration& d);             // takes `tilt` into gravity, and `symmetry` into min and a mirror
    bool any_side_moves() const;              // along itself
    std::vector<MirrorPlane> mirrors() const; // one for each side that is a mirror
    Domain with_images() const;               // its corners with the mirror images
};

// Laws of viscosity by shear rate; formulas: flow/viscosity_model.hpp.
enum class ViscosityModelKind { newtonian, power_law, carreau, cross, herschel_bulkley };

// Dependence of a liquid's viscosity on the shear rate; its `viscosity` is the law's own (flow/viscosity_model.hpp).
struct Rheology {
    ViscosityModelKind law = ViscosityModelKind::newtonian;
    double exponent = 1;                 // n in (0, 10]; not newtonian
    double infinite_shear_viscosity = 0; // [Pa s] Carreau, Cross: at high rates
    double relaxation_time = 0;          // [s] Carreau, Cross
    double yield_stress = 0;             // [Pa] Herschel-Bulkley
    double regularisation_time = 100;    // [s] Herschel-Bulkley
    double min_shear_rate = 1e-3;        // [1/s] power law, Herschel-Bulkley

    void declare(Declaration& d); // refuses values of another law
};

// The particles that start in a shape have a viscosity of their own.
struct ViscosityRegion {
    Shape shape;
    double viscosity = 0; // [Pa s]

    void declare(Declaration& d); // both keys are required
};

// Viscosity at a coordinate along the axis of a profile.
struct ViscosityPoint {
    double at = 0;        // [m]
    double viscosity = 0; // [Pa s]

    void declare(Declaration& d); // both keys are required
};

// Viscosity, or its logarithm, is linear between two points.
enum class Interpolation { linear, logarithmic };

// Viscosity of the particles by where they start along an axis; beyond the first and last point that of these.
struct ViscosityProfile {
    int axis = 0; // 0 x, 1 y, 2 z
    Interpolation interpolation = Interpolation::linear;
    std::vector<ViscosityPoint> points; // none: no profile

    void declare(Declaration& d); // refuses coordinates that do not rise
    double at(double x) const;    // [Pa s]
};

// Gradient of a velocity u [1/s]: row i is that of u_i.
struct VelocityGradient {
    std::array<Vec3, 3> rows{}; // [1/s]

    void declare(Declaration& d); // keys x, y, z: the rows
};

// Item of `liquids`.
struct Liquid {
    std::string name;                               // unique; default: the material
    std::string material = "none";                  // a preset of `treacle materials`, or "none"
    double density = 1000;                          // [kg/m3]
    double viscosity = 0;                           // [Pa s]
    Rheology rheology;                              // Newtonian unless given
    ViscosityProfile viscosity_profile;             // in the place of the viscosity
    std::vector<ViscosityRegion> viscosity_regions; // in the place of both; the last one that holds a particle counts
    double surface_tension = 0;                     // [N/m]
    std::vector<Shape> shapes;                      // none: it comes from inlets only
    bool subtract_bodies = false;                   // where a body is, the liquid is left out
    Vec3 velocity{0, 0, 0};                         // [m/s] at the pivot, at the start
    Vec3 angular_velocity{0, 0, 0};                 // [rad/s] about the pivot, at the start
    VelocityGradient velocity_gradient;             // at the start, besides the angular velocity
    std::optional<Vec3> pivot;                      // [m] without it the centre of the shapes' union
    std::string where;                              // "scene.yaml:14"

    void declare(Declaration& d); // values that are not given are the preset's
    // Gradient of the velocity at the start, rotation and velocity_gradient together [1/s]: row i is that of u_i.
    std::array<Vec3, 3> initial_gradient() const;
    // Velocity at the start, at x [m/s]; `centre` [m] is the pivot.
    Vec3 initial_velocity(const Vec3& x, const Vec3& centre) const;
    // True when that is not the same everywhere.
    bool sheared() const;
    // True when its particles may differ in viscosity.
    bool varies() const {
        return rheology.law != ViscosityModelKind::newtonian || !viscosity_profile.points.empty() ||
               !viscosity_regions.empty();
    }
};

// Motion of a body: none, as prescribed, by the forces on it. `fixed` is the key `static`.
enum class BodyKind { fixed, kinematic, dynamic };

// Place of a kinematic body at a time. Velocity and axis are constant from one to the next.
struct Keyframe {
    double time = 0;             // [s]
    Vec3 translation{0, 0, 0};   // [m] from the initial place
    Vec3 rotation_axis{0, 0, 1}; // of any length; z in 2D
    double rotation_angle = 0;   // [rad] from the initial orientation

    void declare(Declaration& d); // time is required
};

// Item of `bodies`.
struct Body {
    std::string name;                // unique; default "body"
    BodyKind kind = BodyKind::fixed; // decides which of the others count
    Shape shape;                     // at the start
    double density = 0;              // [kg/m3] dynamic: this, or the mass
    double mass = 0;                 // [kg], in 2D [kg/m]
    Slip slip = Slip::free_slip;     // of the liquid along the surface
    double slip_length = 0;          // [m]
    double skin_friction = 0;        // c_f
    Vec3 velocity{0, 0, 0};          // [m/s] dynamic: at the start; kinematic: all the time
    Vec3 angular_velocity{0, 0, 0};  // [rad/s] about the centre of mass, or the pivot
    std::optional<Vec3> pivot;       // [m] kinematic: point of the body, at the start, that rotations leave in place
    std::vector<Keyframe> keyframes; // kinematic: rising times; these or the velocities
    std::array<bool, 6> locked{};    // dynamic: motion along x, y, z, rotation about x, y, z
    double restitution = 0;          // of contacts: velocity after over velocity before
    double friction = 0.3;           // of contacts: Coulomb's coefficient
    std::string where;               // "scene.yaml:14"

    void declare(Declaration& d); // refuses values that the kind has no use for
};

// Relative motion that a joint leaves.
enum class JointKind {
    hinge,  // rotation about an axis through a point
    ball,   // rotation about a point
    slider, // motion along an axis
};

// Links a dynamic body to another body or to the world.
struct Joint {
    std::string name;
    JointKind kind = JointKind::hinge;
    std::string body;    // name of a dynamic body
    std::string to;      // name of another body; empty: the world
    Vec3 point{0, 0, 0}; // [m] at the start
    Vec3 axis{0, 0, 1};  // of a hinge or a slider, at the start, of any length
    std::string where;

    void declare(Declaration& d); // refuses an axis that the kind has no use for
};

// In 2D both are a piece of a line.
enum class InletShape { disc, rectangle };

// Liquid that flows in through a plane figure, in 2D through a piece of a line.
struct Inlet {
    std::string name;
    std::string liquid; // name; empty: the only one
    InletShape shape = InletShape::disc;
    Vec3 centre{0, 0, 0};         // [m]
    Vec3 direction{0, 0, -1};     // of the flow, of any length
    double radius = 0;            // [m] disc
    double width = 0, height = 0; // [m] rectangle; in 2D only the width counts
    Vec3 along{0, 0, 0};          // rectangle: direction of its width; zero: a coordinate axis
    double flow_rate = 0;         // [m3/s], in 2D [m2/s]: this, or the velocity
    double velocity = 0;          // [m/s]
    double start = 0, end = 0;    // [s]; end 0: with the run
    std::string where;

    void declare(Declaration& d); // exactly one of flow_rate and velocity is above 0
};

// Particles inside of the box, or behind the plane, are taken out.
enum class OutletShape { box, half_space };

// Region where liquid is taken out.
struct Outlet {
    std::string name;
    OutletShape shape = OutletShape::box;
    Vec3 min{0, 0, 0}, max{0, 0, 0};      // [m] box
    Vec3 point{0, 0, 0}, normal{0, 0, 1}; // half space behind the plane
    std::string where;

    void declare(Declaration& d); // exactly one of `box` and `half_space`
};

// Steps of one length, or of the largest one within `cfl` and the method's own limits.
enum class StepRule { fixed, cfl };

// Block `time`.
struct Time {
    double end = 1;                // [s]
    StepRule rule = StepRule::cfl; // fixed: all steps are `step`
    double step = 0;               // [s] fixed rule; with cfl the largest step, 0: none
    double cfl = 0;                // largest move of a particle per step, in spacings; 0: the method's own
    double min_step = 1e-7;        // [s] below it the run ends with exit code 3
    std::string where;             // of the step

    void declare(Declaration& d); // refuses a step below min_step
};

// Values per particle that frames may have.
const std::vector<std::string>& frame_fields();

// Block `output`.
struct Output {
    std::string name = "frame"; // start of file names: letters, digits, _ and -; not "solid"
    double interval = 0;        // [s] between frames; 0: none
    std::vector<double> times;  // [s] of frames besides those of the interval
    // Names of frame_fields().
    std::vector<std::string> fields{"velocity", "pressure", "density"};
    bool double_precision = false;       // frames of float64, else float32
    double checkpoint_interval = 0;      // [s] simulated; 0: none
    double checkpoint_wall_interval = 0; // [s] of the clock; 0: none
    int checkpoints_kept = 2;            // newest ones, at least 1
    double log_interval = 0;             // [s] simulated between lines of the terminal; 0: every frame

    void declare(Declaration& d); // refuses fields that are not in frame_fields()

    bool has_frames() const { return interval > 0 || !times.empty(); } // else next_frame() is infinite
    // The first time after `time` at which a frame is due [s]; infinite where none is.
    double next_frame(double time) const;
};

// A calibrated lens and its pose, as they stand in effective.yaml.
struct MeasuredCamera {
    Lens lens;                 // its size is that of the camera
    Vec3 rotation{0, 0, 0};    // [rad] rotation vector, scene to camera
    Vec3 translation{0, 0, 0}; // [m]

    void declare(Declaration& d); // fx, fy, cx, cy and translation are required
};

// Item of `cameras`: placed automatically, by position and target, or by a measured lens and pose.
struct Camera {
    std::string name = "main";              // part of the pictures' file names
    std::string file;                       // a camera file; found, read and emptied by app::load_scene
    std::string file_camera;                // the camera of that name in the file
    std::optional<MeasuredCamera> measured; // from the block `lens` or from `file`
    Vec3 position{0, 0, 0};                 // [m]
    Vec3 target{0, 0, 0};                   // [m]
    Vec3 up{0, 0, 1};                       // of any length
    double field_of_view = 0.7;             // vertical [rad]
    int width = 1280, height = 720;         // [pixels]
    bool automatic = true;                  // placed such that the whole domain is in the picture
    bool size_given = false;                // width or height stand in the scene
    std::string where;                      // of the file

    void declare(Declaration& d); // refuses a second source of the pose
    // The measured lens in its pose. InputError for a lens that is none.
    CameraModel model() const;
};

// Lengths [m]; flows [m3/s], in 2D [m2/s].
enum class MeasurementKind {
    front,  // largest coordinate of the liquid along `axis`
    height, // height of the liquid along the axis against gravity in a column around `position`
    flow,   // volume flow through the plane at `position` with normal `axis` [m3/s]
};

// Item of `measurements`.
struct Measurement {
    std::string name;                              // column of measurements.csv; default: the kind
    MeasurementKind kind = MeasurementKind::front; // required
    int axis = 0;                                  // 0 x, 1 y, 2 z
    Vec3 position{0, 0, 0};                        // [m]
    std::string liquid;                            // name; empty: all liquids together
    double interval = 0;                           // [s]; 0: every step

    void declare(Declaration& d); // refuses z as the axis in 2D
};

// Everything of the scene file that is not an option of a method. Declares its blocks side by side into the
// root; what parses is consistent in itself, but shapes and meshes have not been read.
struct Scene {
    int schema_version = 1;
    std::string title;
    Domain domain;
    std::vector<Liquid> liquids;
    std::vector<Inlet> inlets;
    std::vector<Outlet> outlets;
    std::vector<Body> bodies;
    std::vector<Joint> joints;
    Time time;
    Output output;
    std::vector<Camera> cameras;
    std::vector<Measurement> measurements;
    double max_lost_fraction = 0; // share of the particles that may be lost before the run ends (exit code 3)

    void declare(Declaration& d); // refuses names that stand twice, and names that no list has
};

} // namespace treacle::scene
