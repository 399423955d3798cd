#pragma once
#include "sph/viscosity/operator/viscous_scene.hpp"

namespace treacle::sph {

// Walls along which the liquid slips with a length b: each square metre holds it with the traction mu (u -
// u_w)/(b + height), which is drag on the particles beside it. A solid particle shares its area among the
// liquid particles around it by |W'|/r, so that the traction does not depend on how these lie; liquid that
// hardly wets it has only its part. u_w is taken at the liquid particle, as if the body reached that far:
// nothing holds a rotation of both together, and force and reaction have one line. The liquid between the
// wall and the particles' heights is sheared in that traction, so that its volume is taken off the particles'
// share of the viscous energy.
class WallSlip {
public:
    // With the length per solid [m], 0: none.
    explicit WallSlip(const std::vector<double>& lengths);

    // Collective. `viscous_coefficient` is dt/m V mu of the owned particles, which loses what the wall's traction stands
    // for.
    void prepare(
        const ViscousScene& scene, const MomentReferencePoints& points, const Array<double>& viscous_coefficient);

    bool any() const { return any_; } // some solid has a length
    // dt/m times the drag coefficient of each owned particle; when there is any.
    std::size_t bytes() const { return sizeof(double) * (slip_.span() + viscous_coefficient_.span() + drag_.span()); }
    const Array<double>& drag() const { return drag_; }

    // product += drag (u - u_w) of the owned particles, beside walls that rest, or that move. u:
    // LiquidParticles::motion.
    void add(const ViscousScene& scene, const Array3& product) const;
    void add(const ViscousScene& scene, const Array<double>& motion, const Array3& product) const;
    // Adds this rank's share of the pull on the solids, times `scale`.
    void add_loads(const ViscousScene& scene, const Array<double>& motion, double scale, BodyLoads& loads) const;
    // Adds the 6 x 6 derivative of the above by the motion of each solid, with the other sign, for scale 1.
    void add_stiffness(const ViscousScene& scene, std::vector<double>& stiffness) const;

private:
    bool any_ = false;
    MomentReferencePoints points_;
    Array<double> slip_;
    Array<double> viscous_coefficient_{"treacle::slip_viscous_coefficient", 0}; // dt/m V mu, whole
    Array<double> drag_{"treacle::wall_drag", 0};
};

} // namespace treacle::sph
