#include "sph/solids/bodies.hpp"

namespace treacle::sph {

namespace {
// Numbers of a body: turn (rows of its matrix), centre at the start.
enum Frame { turn = 0, start = 9, frame_width = 12 };
} // namespace

Bodies::Bodies(rigid::BodiesSetup setup, const std::vector<double>& scale, int first, int count,
    const DomainBox& domain, std::vector<Vec3> sides)
    : rigid(std::move(setup)), domain_(domain), first_(first), points_(count), sides_(std::move(sides)),
      motion_("treacle::solid_motion", static_cast<std::size_t>(6 * count)) {
    if (!rigid.any_moves()) {
        auto motion = Kokkos::create_mirror_view(motion_);
        move_sides(motion);
        Kokkos::deep_copy(motion_, motion);
        return;
    }
    points_.moving = true;
    points_.centre = Array<double>("treacle::body_centres", static_cast<std::size_t>(4 * count));
    for (int k = 0; k < 3; ++k) points_.period[k] = domain.period[k];
    frames_ = Array<double>("treacle::body_frames", static_cast<std::size_t>(count) * frame_width);
    points_.scale = Array<double>("treacle::boundary_volume_factor", static_cast<std::size_t>(count));
    auto factors = Kokkos::create_mirror_view(points_.scale);
    for (int k = 0; k < count; ++k) {
        const int body = k - first;
        factors(k) = body >= 0 && body < static_cast<int>(scale.size()) ? scale[static_cast<std::size_t>(body)] : 1;
    }
    Kokkos::deep_copy(points_.scale, factors);
    upload();
}

void Bodies::move_sides(const Array<double>::HostMirror& motion) const {
    for (std::size_t side = 0; side < sides_.size(); ++side) {
        for (std::size_t k = 0; k < 3; ++k) motion(6 * side + k) = sides_[side][k];
    }
}

void Bodies::upload() {
    auto centres = Kokkos::create_mirror_view(points_.centre);
    auto frames = Kokkos::create_mirror_view(frames_);
    auto motion = Kokkos::create_mirror_view(motion_); // of solids that rest it stays 0
    move_sides(motion);
    for (std::size_t b = 0; b < rigid.size(); ++b) {
        if (!rigid.moves(b)) continue;
        const auto load = static_cast<std::size_t>(first_) + b;
        const auto axes = rigid::to_matrix(rigid.pose(b).turn);
        const auto spinning = rigid.spin(b);
        const auto row = load * frame_width;
        for (std::size_t k = 0; k < 3; ++k) {
            centres(4 * load + k) = rigid.pose(b).centre[k];
            motion(6 * load + k) = rigid.velocity(b)[k];
            motion(6 * load + 3 + k) = spinning[k];
            frames(row + start + k) = rigid.setup().bodies[b].centre[k];
            for (std::size_t l = 0; l < 3; ++l) frames(row + turn + 3 * k + l) = axes[k][l];
        }
        centres(4 * load + 3) = 1;
    }
    Kokkos::deep_copy(points_.centre, centres);
    Kokkos::deep_copy(frames_, frames);
    Kokkos::deep_copy(motion_, motion);
}

void Bodies::mark_start(const SolidParticles& solid) const {
    const auto x = solid.position(), reference = solid.reference();
    const auto normal = solid.normal(), reference_normal = solid.reference_normal();
    Kokkos::parallel_for(
        "treacle::mark_start", solid.store.owned(), KOKKOS_LAMBDA(int s) {
            for (int k = 0; k < 3; ++k) {
                reference(s, k) = x(s, k);
                reference_normal(s, k) = normal(s, k);
            }
        });
}

void Bodies::set_velocities(const SolidParticles& solid) {
    if (!any_moves()) return;
    upload();
    const auto points = points_;
    const auto motion = motion_;
    const auto x = solid.position(), v = solid.velocity();
    const auto body = solid.body();
    Kokkos::parallel_for(
        "treacle::solid_velocities", solid.store.total(), KOKKOS_LAMBDA(int s) {
            if (!points.moves(body(s))) return;
            const double position[3] = {x(s, 0), x(s, 1), x(s, 2)};
            double velocity[3];
            points.velocity(motion, body(s), position, velocity);
            for (int k = 0; k < 3; ++k) v(s, k) = velocity[k];
        });
}

void Bodies::update_positions(const SolidParticles& solid) {
    if (!any_moves()) return;
    upload();
    const auto points = points_;
    const auto frames = frames_;
    const auto domain = domain_;
    const auto x = solid.position(), reference = solid.reference();
    const auto normal = solid.normal(), reference_normal = solid.reference_normal();
    const auto body = solid.body();
    Kokkos::parallel_for(
        "treacle::update_solid_positions", solid.store.owned(), KOKKOS_LAMBDA(int s) {
            if (!points.moves(body(s))) return;
            const double* frame = &frames(static_cast<std::size_t>(body(s)) * frame_width);
            double arm[3];
            for (int k = 0; k < 3; ++k) {
                arm[k] = reference(s, k) - frame[start + k];
                const double period = domain.period[k];
                if (period > 0) arm[k] -= period * math::floor(arm[k] / period + 0.5);
            }
            for (int k = 0; k < domain.dimensions; ++k) {
                const double* axes = frame + turn + 3 * k;
                normal(s, k) = axes[0] * reference_normal(s, 0) + axes[1] * reference_normal(s, 1) +
                               axes[2] * reference_normal(s, 2);
                double position =
                    points.centre(4 * body(s) + k) + axes[0] * arm[0] + axes[1] * arm[1] + axes[2] * arm[2];
                const double period = domain.period[k];
                if (period > 0) position -= period * math::floor((position - domain.lo[k]) / period);
                x(s, k) = domain.wrap(k, position);
            }
        });
}

} // namespace treacle::sph
