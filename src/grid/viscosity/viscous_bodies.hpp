#pragma once
#include "grid/viscosity/viscous_parts.hpp"
#include "grid/viscosity/viscous_system.hpp"

#include <span>
#include <vector>

namespace treacle::grid {

// Dynamic bodies as unknowns beside the faces (V5). Their velocities are V* + L q, with M^-1 = L L^T the bodies'
// response to impulses with their joints and locked degrees of freedom: what cannot move has no column, and (V - V*) M
// (V - V*) = q.q. With the strains D W_S R V of the bodies' motions,
//   C = W_F D^T K D W_S R,   G = (W_S R)^T D^T K D W_S R + the mass of liquid that they hold, over dt, and likewise by the
// tractions of slip surfaces,
// the rows beside those of the faces are  L^T C^T u + (1/dt + L^T G L) q = -L^T (G V* - h),  h the held momentum over dt.
// C is kept face by face; G is small and dense. R is taken at the faces, so that common rigid motions strain nothing.
// Every rank has all of q, V and G and does the same arithmetic on them.
class ViscousBodies {
public:
    // Columns of L of the bodies where they are.
    void prepare(const rigid::RigidBodies& bodies);
    // Columns of as many solids whose motion is given, in the `bend` and `wall_bend` of the faces.
    void prepare(std::size_t solids);
    int unknowns() const { return static_cast<int>(columns_.size()); }

    // Collective: C, G, h for an assembled system.
    void build(const Comm& comm, const ViscousScene& scene, const ViscousFaces& faces, const ViscousSystem& system,
        const BodyMotion& motion, const FaceField& velocity);

    // 1/dt + L^T G L, unknowns x unknowns.
    std::vector<double> block(double dt) const;
    // -L^T (G V - h), for the bodies' present velocities V, 6 numbers a body.
    std::vector<double> right_hand_side(std::span<const double> velocities) const;
    // y += C L q and C^T x, on this rank's faces: what a product needs beside the stored matrix.
    void add_coupling(std::span<const double> q, std::span<double> y) const;
    std::vector<double> project(std::span<const double> x) const; // L^T C^T x, of this rank's faces
    // Collective: -(C^T u + G V - h), forces [N] and torques about the centres [N m].
    std::vector<double> loads(const Comm& comm, std::span<const double> u, std::span<const double> velocities) const;
    std::vector<double> forces(std::span<const double> loads) const; // L^T loads
    // V + L q.
    std::vector<double> moved(std::span<const double> velocities, std::span<const double> q) const;
    // For bodies in liquid whose motion is given: (1/dt + L^T G L) q = L^T loads.
    std::vector<double> answer(std::span<const double> loads, double dt) const;

    std::size_t bytes() const; // of this rank [bytes]

    // Six numbers of a body at a face: list by list, owned faces in order, those of face n from first(n) to last(n) - 1.
    struct List {
        // Indices [owned faces + 1], [owned faces]; [entries] numbers of bodies.
        Array<int> first{"treacle::viscous_body_first", 0}, last{"treacle::viscous_body_last", 0};
        Array<int> body{"treacle::viscous_body", 0};
        Array<double> u{"treacle::viscous_body_row", 0}; // [entries][6]
    };
    // Parts of build(); not private, since nvcc takes no kernel in a private function.
    void list(const ViscousScene& scene, const ViscousFaces& faces, const CellBox& owned, const BodyMotion& motion);
    void list_surfaces(
        const ViscousScene& scene, const ViscousFaces& faces, const CellBox& owned, const BodyMotion& motion);

private:
    struct Entry {
        int row, body;
        double u[6];
    };
    void add_stiffness(int b, const double* left, int other, const double* right, double factor);
    void sum_slip(const ViscousFaces& faces, const CellBox& owned);
    void sum_faces(
        const ViscousFaces& faces, const ViscousSystem& system, const CellBox& owned, const FaceField& velocity);

    std::vector<std::vector<double>> columns_; // of L, 6 numbers a body
    std::size_t size_ = 0;                     // 6 numbers a body
    List stress_coupling_;        // (D^T K D W_S R) of a face: what a body's motion pulls at it, per unit of its share
    List slip_coupling_;          // the same by slip surfaces, whose bodies have no share in faces
    List moved_;                  // W_S R of a face
    List surface_;                // of slip surfaces, by owned cells: R along each axis
    std::vector<Entry> coupling_; // C
    Array<double> given_pull_{"treacle::given_pull", 0}; // [owned faces] D^T K (e - D W_S bend) and of slip surfaces
    std::vector<double> stiffness_, prescribed_load_;    // G [size][size], h [size]
};

} // namespace treacle::grid
