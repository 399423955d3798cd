#include "grid/body_motion.hpp"

namespace treacle::grid {

void update_motion(const rigid::RigidBodies& bodies, const MacGrid& grid, BodyMotion& motion) {
    motion.bodies = static_cast<int>(bodies.size());
    for (int k = 0; k < 3; ++k) motion.period[k] = grid.cells.period[k];
    reserve(motion.frame, BodyMotion::width * bodies.size());
    auto host = Kokkos::create_mirror_view(motion.frame);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const auto& centre = bodies.pose(b).centre;
        const Vec3 velocity = bodies.moves(b) ? bodies.velocity(b) : Vec3{0, 0, 0};
        const Vec3 spin = bodies.moves(b) ? bodies.spin(b) : Vec3{0, 0, 0};
        for (std::size_t k = 0; k < 3; ++k) {
            host(BodyMotion::width * b + k) = centre[k];
            host(BodyMotion::width * b + 3 + k) = velocity[k];
            host(BodyMotion::width * b + 6 + k) = spin[k];
        }
    }
    Kokkos::deep_copy(motion.frame, host);
}

} // namespace treacle::grid
