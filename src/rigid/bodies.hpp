#pragma once
#include "rigid/joints.hpp"
#include "scene/sampling/signed_distance.hpp"

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace treacle::rigid {

struct Contact;

// A surface at one of its points.
struct SurfacePoint {
    Vec3 edge{0, 0, 0};    // unit tangent, where two faces meet; zero elsewhere and in 2D
    Vec3 inwards{0, 0, 0}; // unit
};

// A ball about a point of a body's surface, of radius 0, or the body itself when it is a ball.
struct ContactSample {
    Vec3 point{0, 0, 0};    // [m] at the start
    double radius = 0;      // [m]
    SurfacePoint surface{}; // that RigidBodies finds
};

// Constants of a body. Places are those at the start of the run.
struct BodySetup {
    std::string name;
    scene::BodyKind kind = scene::BodyKind::fixed;
    double mass = 0;                // [kg], [kg/m] in 2D; dynamic
    Matrix3 inertia{};              // about the centre, in the axes of space [kg m2]; dynamic
    Vec3 centre{0, 0, 0};           // [m] centre of mass; of a kinematic body what it turns about
    Vec3 velocity{0, 0, 0};         // [m/s] dynamic: at the start; kinematic: all the time
    Vec3 angular_velocity{0, 0, 0}; // [rad/s]
    std::vector<scene::Keyframe> keyframes;
    std::array<bool, 6> locked{};
    // Kinematic: its surface moves with the velocity while the body stays in its place, as that of a conveyor. It touches no
    // other body, and is there from `from` until `until` only.
    bool surface_velocity_only = false;
    double from = 0, until = std::numeric_limits<double>::infinity(); // [s]
    double restitution = 0, friction = 0;
    std::vector<scene::SolidRegion> region; // one: the solid at the start
    std::vector<ContactSample> probes;      // that touch other bodies and walls
    double bounding_radius = 0;             // [m] from the centre to the farthest point of the surface
};

// A side of the domain that stops bodies, at right angles to an axis.
struct Wall {
    int axis = 0;
    double at = 0;      // [m]
    double inwards = 1; // +1: the domain is above
};

// Input of RigidBodies, the same on every rank.
struct BodiesSetup {
    std::vector<BodySetup> bodies;         // the number of a body is its index
    std::vector<JointSetup> joints;        // between these bodies, or to the world
    std::vector<Wall> walls;               // sides of the domain that are walls
    std::array<double, 3> period{0, 0, 0}; // [m], 0: not periodic
    double spacing = 0;                    // [m] scale of what counts as close
    Vec3 gravity{0, 0, 0};                 // [m/s2]
    int dimensions = 3;                    // 2: motion in x and y, rotation about z

    // True when a joint links the two bodies.
    bool joined(std::size_t a, std::size_t b) const;
};

// The bodies of a run. Every rank holds all of them and does the same arithmetic on loads summed over the ranks.
// One step: begin(), accelerate() and push() in any order, move().
class RigidBodies {
public:
    RigidBodies() = default;
    explicit RigidBodies(BodiesSetup setup);

    // Number, input and kinds of the bodies; a body that moves is kinematic or dynamic.
    std::size_t size() const { return setup_.bodies.size(); }
    const BodiesSetup& setup() const { return setup_; }
    bool moves(std::size_t body) const { return setup_.bodies[body].kind != scene::BodyKind::fixed; }
    bool dynamic(std::size_t body) const { return setup_.bodies[body].kind == scene::BodyKind::dynamic; }
    bool any_moves() const { return any_moves_; }
    // True when a body is there now, as all are but those that convey out of their time.
    bool present(std::size_t body) const {
        const auto& setup = setup_.bodies[body];
        return !setup.surface_velocity_only || (time_ >= setup.from && time_ < setup.until);
    }
    bool any_dynamic() const { return any_dynamic_; }

    // Kinematic bodies take the velocity that carries them along their motion in the next step of dt [s].
    void begin(double dt);
    // Velocity of dynamic bodies by gravity in dt [s]. Then by joints, such that the motion of the step begun keeps them closed.
    void fall(double dt);
    // By force [N] and torque about their centres [N m], 6 numbers a body; those of bodies that are not dynamic
    // do not count. Then by joints as in fall(); where no step has begun, one of dt [s] counts.
    void push(std::span<const double> loads, double dt);
    // Impulses of contacts and joints, and the motion by dt: kinematic bodies to their next place, dynamic ones by
    // their velocities, which are those of the middle of the step, the rotation such that the angular momentum is kept exactly.
    // A body that bounces does so at the time of its impact within the step. Throws SimulationError when joints cannot be kept
    // closed.
    void move(double dt);

    double time() const { return time_; } // [s]
    double step() const { return step_; } // [s] of the step that begin() began, 0 outside of one
    const Pose& pose(std::size_t body) const { return states_[body].pose; }         // at time()
    const Vec3& velocity(std::size_t body) const { return states_[body].velocity; } // of the centre [m/s]
    Vec3 spin(std::size_t body) const;                                              // [rad/s]
    // A method whose velocities are those of the middles of steps sets by how much momenta of the ends, for what is
    // shown, are ahead of them: as free_momenta().
    void set_lead(std::vector<double> lead) { lead_ = std::move(lead); }
    // Angular momentum about the origin [kg m2/s] that leads of linear momentum have where the bodies are, beyond that where the
    // forces of the lead acted: what acted on bodies and liquid alike is less for the liquid by as much.
    Vec3 moment_of_lead() const;
    Vec3 end_velocity(std::size_t body) const;
    Vec3 end_spin(std::size_t body) const;
    // About the centre [kg m2/s]; of dynamic bodies.
    const Vec3& angular_momentum(std::size_t body) const { return states_[body].angular_momentum; }
    // About the centre, in the axes of space, where it is [kg m2]; of dynamic bodies.
    Matrix3 inertia(std::size_t body) const { return inertia(body, states_[body].pose.turn); }
    // Response of the bodies to impulses where they are, joints and locked degrees of freedom included.
    ConstrainedInverseMass mobility() const;
    // Numbers of a body in free_momenta(): momentum by velocity() [kg m/s], angular_momentum(), and that of the motion of the
    // centre about the origin [kg m2/s].
    static constexpr std::size_t momentum_numbers = 9;
    std::vector<double> free_momenta() const; // [bodies][9], 0 of what is not dynamic
    std::vector<double> weight_rates() const; // [bodies][9] rates of free_momenta() by gravity [1/s]
    // Changes of free_momenta() by the impacts of the last step.
    const std::vector<double>& impact_momenta() const { return impact_momenta_; }
    // Bound of the speed of any point of a body that moves [m/s].
    double max_speed() const;
    int contacts() const { return contacts_; } // of the last step
    // Mean of the last step, 6 numbers a body: force [N], and torque about the centre [N m]; of static bodies about
    // the origin. By contacts; and by joints and locked degrees of freedom.
    std::span<const double> contact_loads() const { return contact_loads_; }
    std::span<const double> joint_loads() const { return joint_loads_; }
    // The largest gap of the joints where the bodies are [m].
    double constraint_error() const;

    // Linear momentum [kg m/s] and angular momentum about the origin [kg m2/s] of the dynamic bodies, by end_velocity().
    std::array<double, 6> momentum() const;
    // Kinetic, and potential of gravity, zero at the origin, of the dynamic bodies [J].
    std::array<double, 2> energy() const;

    // State that fall() and push() change, to solve again from where they were.
    struct Snapshot {
        std::vector<double> motion, given, joint_loads; // state(); [bodies][6] [N s], [N m s]; joint_loads()
    };
    Snapshot snapshot() const { return {state(), given_, joint_loads_}; }
    void go_back(const Snapshot& to) {
        restore(to.motion);
        given_ = to.given;
        joint_loads_ = to.joint_loads;
    }

    // All that changes: the time, then 13 numbers a body.
    std::vector<double> state() const;
    void restore(std::span<const double> state);

private:
    struct State {
        Pose pose;
        Vec3 velocity{0, 0, 0};
        Vec3 angular_momentum{0, 0, 0}; // of a kinematic body in its place: the spin
    };
    Vec3 end_angular_momentum(std::size_t body) const { // that of end_spin(), about the centre
        return states_[body].angular_momentum + lead(body, 3);
    }
    Vec3 lead(std::size_t body, std::size_t part) const {
        const std::size_t at = momentum_numbers * body + part;
        return lead_.empty() ? Vec3{0, 0, 0} : Vec3{lead_[at], lead_[at + 1], lead_[at + 2]};
    }
    Matrix3 inertia(std::size_t body, const Quaternion& turn) const;
    std::array<bool, 3> free_turns(std::size_t body) const;
    Matrix3 inverse_inertia(std::size_t body, const Quaternion& turn) const;
    Vec3 spin_at(std::size_t body, const Quaternion& turn) const;
    Response response(std::size_t body) const;
    Pose pose_at(std::size_t body, double time) const;
    Pose next_pose(std::size_t body, double dt) const;
    Quaternion next_turn(std::size_t body, double dt) const;
    std::vector<ConstraintRow> joint_rows() const;
    std::vector<double> gaps(const std::vector<Pose>& poses) const;
    void apply_impulses(std::span<const double> impulses);
    double approach(const Contact& contact) const;
    double gravity_along(const Contact& contact) const;
    enum class Meeting { touches, hits, later };
    Meeting expect(Contact& contact, double dt) const;
    enum class Impacts { bounce, stop };
    double meet(double dt, Impacts impacts);
    void solve(const std::vector<Contact>& contacts, double dt);
    void hit(const std::vector<Contact>& contacts, double dt);
    void advance(double dt);
    void constrain_joints(double dt);
    std::array<double, 6> own_momentum(std::size_t body) const;
    void begin_load_sums();
    void close_ledger(double dt);

    BodiesSetup setup_;
    std::vector<State> states_;
    double time_ = 0, step_ = 0, gone_ = 0; // [s]; the last: of the step that move() is in
    bool any_moves_ = false, any_dynamic_ = false;
    int contacts_ = 0;
    std::vector<double> lead_; // empty: none
    // Impulses of this step, 6 numbers a body: by gravity and loads, by contacts, by joints; and what each had before.
    std::vector<double> given_, contact_loads_, joint_loads_, before_;
    std::vector<double> impact_momenta_;
};

} // namespace treacle::rigid
