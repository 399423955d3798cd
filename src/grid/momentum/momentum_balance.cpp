#include "grid/momentum/momentum_balance.hpp"

#include "grid/mac/particle_momentum.hpp"
#include "rigid/algebra.hpp"

#include <Eigen/Dense>

#include <algorithm>

namespace treacle::grid {

namespace {
struct SumLoop {
    using value_type = double[];
    using size_type = std::size_t;
    size_type value_count = MomentumSums::count;
    MomentumParticles particles;
    CellBox window;
    Array<int> group;
    int wanted;

    KOKKOS_INLINE_FUNCTION void init(value_type sum) const {
        for (int k = 0; k < MomentumSums::count; ++k) sum[k] = 0;
    }
    KOKKOS_INLINE_FUNCTION void join(value_type sum, const value_type other) const {
        for (int k = 0; k < MomentumSums::count; ++k) sum[k] += other[k];
    }
    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        int cell[3];
        const auto& x = particles.x;
        particles.grid.cells.locate(x(i, 0), x(i, 1), x(i, 2), cell);
        if (group(window.index(cell[0], cell[1], cell[2])) != wanted) return;
        particles.add(i, sum);
    }
};
} // namespace

MomentumSums MomentumBalance::sums(const Comm& comm, const Scene& scene, int group) const {
    SumLoop loop;
    loop.particles = MomentumParticles(scene);
    loop.window = scene.halo.window();
    loop.group = group_;
    loop.wanted = group;
    MomentumSums out;
    Kokkos::parallel_reduce("treacle::momentum_sums", scene.particles.store.owned(), loop,
        Kokkos::View<double*, Kokkos::HostSpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>>(out.of, MomentumSums::count));
    comm.sum(std::span<double>(out.of));
    if (scene.grid.dimensions == 2) std::ranges::for_each(out.of, [&](double& sum) { sum /= scene.grid.dx; });
    return out;
}

void MomentumBalance::move(const Scene& scene, int group, const RigidMotion& motion) const {
    const MomentumParticles particles(scene);
    const CellBox window = scene.halo.window();
    const auto of = group_;
    Kokkos::parallel_for(
        "treacle::balance_momentum", scene.particles.store.owned(), KOKKOS_LAMBDA(int i) {
            int cell[3];
            const auto& x = particles.x;
            particles.grid.cells.locate(x(i, 0), x(i, 1), x(i, 2), cell);
            if (of(window.index(cell[0], cell[1], cell[2])) == group) particles.move(i, motion);
        });
}

void keep_angular_momenta(const MomentumScene& scene, int begin) {
    const MomentumParticles particles(scene);
    Kokkos::parallel_for(
        "treacle::keep_angular_momenta", Kokkos::RangePolicy<>(begin, std::max(begin, scene.particles.store.owned())),
        KOKKOS_LAMBDA(int i) { particles.keep(i); });
}

void MomentumBalance::begin(const Comm& comm, const Scene& scene, const rigid::RigidBodies& bodies) {
    groups_.clear();
    // Liquid at an inlet is pushed by what is behind it.
    acts_ = false;
    for (std::size_t b = 0; b < bodies.size(); ++b)
        acts_ = acts_ || (bodies.moves(b) && !bodies.setup().bodies[b].surface_velocity_only);
    if (!acts_) return;
    connect(comm, scene, bodies);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (!groups_[g].balanced) continue;
        auto& before = groups_[g].before;
        before = sums(comm, scene, static_cast<int>(g));
        std::copy_n(before.of + MomentumSums::kept, 3, before.of + MomentumSums::angular);
    }
}

namespace {
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

Eigen::Matrix3d cross_matrix(const Vec3& r) {
    Eigen::Matrix3d out;
    out << 0, -r[2], r[1], r[2], 0, -r[0], -r[1], r[0], 0;
    return out;
}
Eigen::Vector3d vector(const Vec3& v) { return {v[0], v[1], v[2]}; }

// A load about a body's centre, about the origin.
Vector6 about_origin(const Vec3& centre, std::span<const double> load) {
    const Eigen::Vector3d force(load[0], load[1], load[2]), torque(load[3], load[4], load[5]);
    Vector6 out;
    out << force, torque + vector(centre).cross(force);
    return out;
}

// Momentum of the velocity (a, w) of the origin, by columns.
Matrix6 mass_of(const MomentumSums& liquid) {
    Matrix6 out = Matrix6::Zero();
    const double* at = liquid.of + MomentumSums::moment;
    const auto moment = cross_matrix({at[0], at[1], at[2]});
    out.block<3, 3>(0, 0) = liquid.of[MomentumSums::mass] * Eigen::Matrix3d::Identity();
    out.block<3, 3>(0, 3) = -moment;
    out.block<3, 3>(3, 0) = moment;
    out.block<3, 3>(3, 3) = Eigen::Map<const Eigen::Matrix3d>(liquid.of + MomentumSums::turn);
    return out;
}

Matrix6 mass_of(const rigid::RigidBodies& bodies, std::size_t b) {
    const double mass = bodies.setup().bodies[b].mass;
    const auto arm = cross_matrix(bodies.pose(b).centre);
    Matrix6 out;
    out.block<3, 3>(0, 0) = mass * Eigen::Matrix3d::Identity();
    out.block<3, 3>(0, 3) = -mass * arm;
    out.block<3, 3>(3, 0) = mass * arm;
    const auto inertia = bodies.inertia(b);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            out(3 + i, 3 + j) = inertia[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    }
    out.block<3, 3>(3, 3) -= mass * arm * arm;
    return out;
}

// Motions that there are: of a 2D scene x, y and the turn about z; along periodic axes no turn.
Eigen::Matrix<double, 6, Eigen::Dynamic> motions(const MacGrid& grid) {
    std::vector<int> kept{0, 1};
    const bool periodic = grid.cells.period[0] > 0 || grid.cells.period[1] > 0 || grid.cells.period[2] > 0;
    if (grid.dimensions == 3) kept.push_back(2);
    for (int k = grid.dimensions == 3 ? 3 : 5; k < 6 && !periodic; ++k) kept.push_back(k);
    Eigen::Matrix<double, 6, Eigen::Dynamic> out = Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(kept.size()));
    for (std::size_t k = 0; k < kept.size(); ++k) out(kept[k], static_cast<Eigen::Index>(k)) = 1;
    return out;
}
} // namespace

void MomentumBalance::end(const Comm& comm, const Scene& scene, const MomentumKick& kick, rigid::RigidBodies& bodies,
    std::span<double> loads) {
    if (!acts_) return;
    loose_.end(comm, scene, kick);
    const auto kept = motions(scene.grid);
    std::vector<double> body_loads(6 * bodies.size(), 0.0);
    bool any = false;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const auto& group = groups_[g];
        if (!group.balanced) continue;
        const auto after = sums(comm, scene, static_cast<int>(g));
        const auto load = [&](std::size_t b) { return loads.subspan(6 * b, 6); };
        const Eigen::Vector3d moment(after.of + MomentumSums::moment);
        Vector6 missing;
        missing << kick.time * after.of[MomentumSums::mass] * vector(kick.gravity),
            kick.time * moment.cross(vector(kick.gravity));
        for (int k = 0; k < 6; ++k) missing[k] -= after.of[k] - group.before.of[k];
        for (const auto b : group.bodies) missing -= kick.time * about_origin(bodies.pose(b).centre, load(b));
        if (!group.free) {
            // Momentum that the liquid did not get was not given, as long as one body alone can have given it.
            if (group.bodies.size() != 1 || bodies.dynamic(group.bodies[0])) continue;
            const Vector6 change = kept * (kept.transpose() * missing) / kick.time;
            const auto& centre = bodies.pose(group.bodies[0]).centre;
            const Eigen::Vector3d force = change.head<3>(), torque = change.tail<3>() - vector(centre).cross(force);
            for (int k = 0; k < 3; ++k) load(group.bodies[0])[static_cast<std::size_t>(k)] += force[k];
            if (kept.cols() == 6 || scene.grid.dimensions == 2) {
                for (int k = scene.grid.dimensions == 2 ? 2 : 0; k < 3; ++k)
                    load(group.bodies[0])[static_cast<std::size_t>(3 + k)] += torque[k];
            }
            continue;
        }
        Matrix6 mass = mass_of(after);
        for (const auto b : group.bodies) mass += mass_of(bodies, b);
        const Eigen::MatrixXd reduced = kept.transpose() * mass * kept;
        const Vector6 motion = kept * reduced.completeOrthogonalDecomposition().solve(kept.transpose() * missing);
        move(scene, static_cast<int>(g), {{motion[0], motion[1], motion[2]}, {motion[3], motion[4], motion[5]}});
        for (const auto b : group.bodies) {
            const auto& centre = bodies.pose(b).centre;
            const Vector6 given = mass_of(bodies, b) * motion / kick.time;
            const Eigen::Vector3d force = given.head<3>(), torque = given.tail<3>() - vector(centre).cross(force);
            for (int k = 0; k < 3; ++k) {
                body_loads[6 * b + static_cast<std::size_t>(k)] = force[k];
                body_loads[6 * b + 3 + static_cast<std::size_t>(k)] = torque[k];
                load(b)[static_cast<std::size_t>(k)] += force[k];
                load(b)[static_cast<std::size_t>(3 + k)] += torque[k];
            }
        }
        any = true;
    }
    if (any) bodies.push(body_loads, kick.time);
    keep_angular_momenta(scene, 0);
}

} // namespace treacle::grid
