#pragma once
#include "rigid/algebra.hpp"

#include <span>
#include <vector>

namespace treacle::rigid {

// Body k responds to an impulse P and an angular impulse T about its centre with the velocity linear P and
// the angular velocity angular T.
struct Response {
    Matrix3 linear{};  // [1/kg]
    Matrix3 angular{}; // [1/kg/m2]
};

// One condition on the velocities V and spins W of two bodies, or of one and the world: no change of
// linear . (V - V_other) + angular . W - other_angular . W_other.
struct ConstraintRow {
    std::size_t body = 0;
    int other = -1;                                // -1: the world
    Vec3 linear{0, 0, 0};                          // unit or 0
    Vec3 angular{0, 0, 0}, other_angular{0, 0, 0}; // [m]
};

// Response of bodies linked by joints to impulses: the matrix M^-1 - M^-1 J^T (J M^-1 J^T)^+ J M^-1, symmetric and
// positive semidefinite, with the rows J of the joints. Rows that depend linearly on others are left out. Impulses and
// velocities are 6 numbers a body, angular ones about its centre.
class ConstrainedInverseMass {
public:
    ConstrainedInverseMass() = default;
    ConstrainedInverseMass(std::vector<Response> bodies, std::vector<ConstraintRow> rows);

    bool linked(std::size_t body) const { return !linked_.empty() && linked_[body] != 0; } // by any joint
    // Velocities that impulses give.
    std::vector<double> respond(std::span<const double> impulses) const;
    // Columns of L, 6 numbers a body, with L L^T this matrix: one for each independent motion that impulses can give.
    std::vector<std::vector<double>> columns() const;
    // Impulses of the joints while these act.
    std::vector<double> reaction(std::span<const double> impulses) const;
    // Impulses of the joints that change what the rows hold by `changes`, as far as they can.
    std::vector<double> impulses_for(std::span<const double> changes) const;
    // Velocities of each body by itself.
    std::vector<double> alone(std::span<const double> impulses) const;
    // True when any impulse on the body moves it.
    bool can_move(std::size_t body) const;

private:
    std::vector<double> rates(std::span<const double> velocities) const;
    double meet(const ConstraintRow& a, const ConstraintRow& b) const; // entry of J M^-1 J^T
    double most(const ConstraintRow& row) const;
    void factorise();

    std::vector<Response> bodies_;
    std::vector<ConstraintRow> rows_;
    std::vector<char> linked_;
    // Data of the rows that count, in the order of their elimination: number, scale, row of the Cholesky factor.
    std::vector<std::size_t> kept_;
    std::vector<double> scale_;
    std::vector<std::vector<double>> factor_;
};

} // namespace treacle::rigid
