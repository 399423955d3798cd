#pragma once
#include "grid/mac/body_motion.hpp"
#include "grid/viscosity/viscosity.hpp"
#include "grid/viscosity/viscous_faces.hpp"

namespace treacle::grid {

// Stresses, faces and solids of a scene as the viscous system takes them (V1)-(V3).
class ViscousParts {
public:
    // For the bodies as they are and move. Local: all within the window.
    void build(const ViscousScene& scene, const ViscosityOptions& options, const BodyMotion& motion, double dt);
    const ViscousFaces& faces() const { return faces_; }
    std::size_t bytes() const;

    // Parts of the above; not private, since nvcc takes no kernel in a private function.
    void weigh_stresses(const ViscousScene& scene, const ViscosityOptions& options);
    void weigh_slip(const ViscousScene& scene, const ViscosityOptions& options);
    void classify_faces(const ViscousScene& scene, const ViscosityOptions& options, double dt);
    void move_solids(const ViscousScene& scene, const BodyMotion& motion);

private:
    ViscousFaces faces_;
};

// Volume of a cube [m3], of a 2D scene per metre of depth [m2].
inline double cube_volume(const MacGrid& grid) {
    return grid.dimensions == 3 ? grid.dx * grid.dx * grid.dx : grid.dx * grid.dx;
}

} // namespace treacle::grid
