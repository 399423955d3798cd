#pragma once
#include "grid/viscosity/mechanisms.hpp"
#include "grid/viscosity/viscous_bodies.hpp"
#include "solve/krylov/field_split_preconditioner.hpp"
#include "solve/multigrid/rigid_multilevel.hpp"
#include "solve/rows/soft_pairs.hpp"

#include <optional>

namespace treacle::grid {

// The viscous system of one step (viscosity.md): built once, for any number of right-hand sides. This rank's rows are its
// faces, then, on rank 0, the motions q of the bodies (viscous_bodies.hpp). Vectors are [rows()].
class ViscousProblem {
public:
    ViscousProblem(const Comm& comm, const ViscosityOptions& options, Coupling coupling);
    ViscousProblem(const ViscousProblem&) = delete; // the solver refers to it
    ViscousProblem& operator=(const ViscousProblem&) = delete;

    // Finds the faces that there are, and those that solids prescribe; build() does it, too. Local.
    void update_faces(const ViscousScene& scene, const rigid::RigidBodies& bodies, double dt);
    // Collective, for the liquid and the bodies as they are. `velocity` is that of the liquid whose velocity bodies prescribe.
    void build(const ViscousScene& scene, const FaceField& velocity, const rigid::RigidBodies& bodies, double dt);

    // Rows and faces of this rank; faces of all ranks.
    std::size_t rows() const { return static_cast<std::size_t>(system_.rows()); }
    std::size_t faces() const { return static_cast<std::size_t>(system_.faces()); }
    std::int64_t global_faces() const { return system_.global_rows() - coupled_; }
    solve::Matrix& matrix() { return *matrix_; }                         // after build()
    bool built() const { return matrix_.has_value(); }                   // matrix() is there
    const ViscousFaces& viscous_faces() const { return parts_.faces(); } // roles and fractions of the faces
    // The faces' part of the system.
    const ViscousSystem& system() const { return system_; }
    ViscousSystem& system() { return system_; }
    int motions() const { return coupled_; } // of bodies that are unknowns, on all ranks

    // b, for velocities of before; bodies move as they did at build().
    void right_hand_side(const FaceField& velocity, std::span<double> b);
    // The velocities of this rank's faces, and no motion of bodies besides their own.
    void read(const FaceField& velocity, std::span<double> x);
    // To the places of the faces, in the field of a window; others keep what they have.
    void write(std::span<const double> x, const FaceField& velocity);
    void precondition(std::span<const double> r, std::span<double> z) { solver_.precondition(r, z); }
    void set_up_preconditioner() { solver_.set_up(*matrix_); }
    void set_fine_sweeps(solve::FineSweeps sweeps) { multilevel_.set_fine_sweeps(sweeps); } // of the multilevel one
    solve::SolveReport solve(std::span<const double> b, std::span<double> x, const solve::ConvergenceTest& test) {
        return solver_.solve(*matrix_, b, x, test);
    }

    // Collective: the motions q, on all ranks; and the change of the bodies' velocities that they are, 6 numbers a body.
    std::vector<double> motions(std::span<const double> x) const;
    std::vector<double> changes(std::span<const double> q) const;
    // L^T loads, the forces on the motions.
    std::vector<double> forces(std::span<const double> loads) const { return bodies_.forces(loads); }

    // Collective: what the solution makes of the liquid and the bodies. Bodies are pushed by the viscous loads and by
    // `others`, whose effect is already in the solution as far as the system has their motions. Returns the viscous
    // loads.
    std::vector<double> apply(const ViscousScene& scene, std::span<const double> x, std::span<const double> others,
        const FaceField& velocity, rigid::RigidBodies& bodies);

    // Loads on the solids at rest, as apply() found them: 6 numbers each, numbered as RestingSolids does, about the
    // origin [N], [N m].
    const std::vector<double>& resting_loads() const { return resting_loads_; }

    std::size_t bytes() const; // of this rank [bytes]

private:
    solve::KrylovOptions krylov();
    void load_resting(const ViscousScene& scene, std::span<const double> u, const FaceField& velocity);
    solve::BorderedBodies border() const;
    void describe_rows(const MacGrid& grid);
    void make_matrix();
    void couple(std::span<const double> from, std::span<double> to);
    std::vector<double> push(std::span<const double> x, std::span<const double> others, rigid::RigidBodies& bodies);

    Comm comm_;
    ViscosityOptions options_;
    Coupling coupling_;
    solve::RigidMultilevel multilevel_;
    Mechanisms mechanisms_;
    solve::SoftPairs soft_pairs_; // mechanisms that weak stresses hold
    solve::FieldSplitPreconditioner components_;
    solve::KrylovSolver solver_;
    BodyMotion motion_;
    ViscousParts parts_;
    ViscousSystem system_;
    ViscousBodies bodies_, resting_; // resting: solids at rest, for their loads
    std::vector<double> resting_loads_;
    Array<int> resting_number_{"treacle::resting_slip", 0}; // [window] whose surface slips in a cell
    std::optional<solve::Matrix> matrix_;
    std::vector<double> before_; // velocities of the bodies, 6 numbers each
    std::vector<double> block_;  // of the bodies
    Array<double> faces_{"treacle::viscous_faces", 0};
    double dx_ = 0, dt_ = 0;
    int dimensions_ = 3, coupled_ = 0;                 // coupled: unknowns of the bodies
    bool has_moving_bodies_ = false, answers_ = false; // there are bodies that move; their motion depends on the liquid
    std::vector<int> cells_;
    std::vector<double> positions_;
    std::vector<signed char> axes_;
    std::vector<unsigned char> aside_;
};

// Velocities of all bodies, 6 numbers each.
std::vector<double> body_velocities(const rigid::RigidBodies& bodies);

} // namespace treacle::grid
