#include "grid/mac/body_motion.hpp"

#include "rigid/algebra.hpp"

#include <algorithm>

namespace treacle::grid {

namespace {
// (R - I)/dt - [spin]x of the turn by spin dt.
void upload_bend(const Vec3& spin, double dt, double* out) {
    using namespace rigid;
    const double angle = dt * length(spin);
    std::fill_n(out, 9, 0.0);
    if (!(angle > 0)) return;
    const auto turn = to_matrix(rotation_by(dt * spin));
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) out[3 * i + j] = (turn[i][j] - (i == j ? 1.0 : 0.0)) / dt;
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        out[3 * i + k] -= spin[j];
        out[3 * i + j] += spin[k];
    }
}
} // namespace

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
        upload_bend(spin, bodies.step(), &host(BodyMotion::width * b + 9));
    }
    Kokkos::deep_copy(motion.frame, host);
}

} // namespace treacle::grid
