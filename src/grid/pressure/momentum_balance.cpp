#include "grid/pressure/momentum_balance.hpp"

#include "base/disjoint_sets.hpp"
#include "grid/mac/particle_momentum.hpp"
#include "grid/mac/pressure_faces.hpp"
#include "rigid/algebra.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <limits>

namespace treacle::grid {

namespace {
constexpr int count = 19;
constexpr double least_solid = 1e-9; // share of a face's cube

struct SumLoop {
    using value_type = double[];
    using size_type = std::size_t;
    size_type value_count = count;
    MacGrid grid;
    CellBox window;
    Array<int> group;
    int wanted;
    Array3 x, u, c[3];
    Array<int> liquid;
    Array<double> mass;

    KOKKOS_INLINE_FUNCTION void init(value_type sum) const {
        for (int k = 0; k < count; ++k) sum[k] = 0;
    }
    KOKKOS_INLINE_FUNCTION void join(value_type sum, const value_type other) const {
        for (int k = 0; k < count; ++k) sum[k] += other[k];
    }
    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        int cell[3];
        grid.cells.locate(x(i, 0), x(i, 1), x(i, 2), cell);
        if (group(window.index(cell[0], cell[1], cell[2])) != wanted) return;
        const double m = mass(liquid(i));
        const ParticleMotion moves(x, u, c, i);
        for (int k = 0; k < 3; ++k) {
            sum[k] += m * moves.u[k];
            sum[7 + k] += m * moves.x[k];
        }
        moves.add_angular_momentum(grid, m, sum + 3);
        sum[6] += m;
        for (int axis = 0; axis < 3; ++axis) moves.turning(axis).add_angular_momentum(grid, m, sum + 10 + 3 * axis);
    }
};

// True for a body whose motion is prescribed, not a result of its loads.
bool is_constrained(const rigid::RigidBodies& bodies, std::size_t b) {
    const auto& setup = bodies.setup();
    if (!bodies.dynamic(b) || std::ranges::any_of(setup.bodies[b].locked, [](bool is) { return is; })) return true;
    return std::ranges::any_of(
        setup.joints, [b](const auto& joint) { return joint.body == b || joint.other == static_cast<int>(b); });
}

// Place of a label among those found, their number for none of them.
std::size_t index_of(const std::vector<double>& found, double label) {
    return static_cast<std::size_t>(std::ranges::find(found, label) - found.begin());
}
} // namespace

// Connected cells and bodies on this rank, and the least number in each set over all ranks.
struct MomentumBalance::Labels {
    std::size_t cells;
    DisjointSets sets;
    std::vector<double> label; // [members], of the least member of a set

    Labels(std::size_t of_window, std::size_t bodies) : cells(of_window) { sets.reset(cells + bodies); }
    double of(std::size_t i) { return label[sets.find(i)]; }
    double of_body(std::size_t b) { return of(cells + b); }
    // Lowers the label of the set of i to `to`; true when it falls.
    bool lower(std::size_t i, double to) {
        auto& mine = label[sets.find(i)];
        const bool falls = to < mine;
        mine = std::min(mine, to);
        return falls;
    }
};

namespace {
void mark_liquid(const MomentumBalance::Scene& scene, const Array<int>& liquid) {
    const CellBox window = scene.halo.window(), owned = scene.halo.owned();
    const CellList cells = scene.cells;
    const auto distance = scene.distance;
    Kokkos::deep_copy(liquid, 0);
    Kokkos::parallel_for(
        "treacle::momentum_liquid", static_cast<int>(owned.size()), KOKKOS_LAMBDA(int n) {
            int c[3];
            owned.cell(n, c);
            const int here = cells.window.index(c[0], c[1], c[2]), at = window.index(c[0], c[1], c[2]);
            liquid(at) = cells.end(here) > cells.begin(here) || distance(at) < 0 ? 1 : 0;
        });
}
// Joins cells with liquid to those beside them, and to the bodies at the faces that their particles read, those of the cells around;
// marks the cells that have something at rest there.
void join_cells(const MomentumBalance::Scene& scene, const Array<int>::HostMirror& liquid, DisjointSets& sets,
    std::vector<char>& rests) {
    if (scene.halo.owned().empty()) return;
    const CellBox window = scene.halo.window(), around = grown(scene.halo.owned(), 1, scene.grid.dimensions);
    const auto cells = static_cast<std::size_t>(window.size());
    const auto faces = pressure_faces(window, scene.grid.dimensions);
    const auto& stride = faces.stride;
    const int deep = scene.grid.dimensions == 3 ? 1 : 0;
    const auto each_around = [&](std::size_t face, std::ptrdiff_t along, const auto& use) {
        for (int z = -deep; z <= deep; ++z) {
            for (int y = -1; y <= 1; ++y) {
                for (int x = -1; x <= 1; ++x) {
                    const auto above = static_cast<std::size_t>(
                        static_cast<std::ptrdiff_t>(face) + x * stride[0] + y * stride[1] + z * stride[2]);
                    for (const auto cell : {above, above - static_cast<std::size_t>(along)}) {
                        if (liquid(cell) != 0) use(cell);
                    }
                }
            }
        }
    };
    for (int a = 0; a < scene.grid.dimensions; ++a) {
        const auto& of = scene.body_fractions[static_cast<std::size_t>(a)];
        const auto fluid = on_host(scene.fluid.axis[a]), fraction = on_host(of.fraction);
        const auto first = on_host(of.first), body = on_host(of.body);
        for (int n = 0; n < around.size(); ++n) {
            int c[3];
            around.cell(n, c);
            const auto i = static_cast<std::size_t>(window.index(c[0], c[1], c[2]));
            const auto below = i - static_cast<std::size_t>(stride[a]);
            if (liquid(i) != 0 && liquid(below) != 0) sets.join(i, below);
            double solid = 1 - fluid(i);
            if (!(solid > least_solid)) continue;
            for (int e = first(i); e < first(i + 1); ++e) {
                const auto at = static_cast<std::size_t>(e);
                solid -= fraction(at);
                const auto member = cells + static_cast<std::size_t>(body(at));
                if (fraction(at) > 0) each_around(i, stride[a], [&](std::size_t cell) { sets.join(cell, member); });
            }
            if (solid > least_solid) each_around(i, stride[a], [&](std::size_t cell) { rests[cell] = 1; });
        }
    }
}
} // namespace

// Collective: gives each set the least number of its members on all ranks. `liquid`: [window] 1: cells with liquid.
void MomentumBalance::lower_labels(
    const Comm& comm, const Scene& scene, const Array<int>::HostMirror& liquid, Labels& labels) {
    const std::size_t cells = labels.cells, n = labels.sets.size() - cells;
    // Numbers that no two members share but a body's on all ranks.
    const double before = double(comm.exclusive_sum(static_cast<std::int64_t>(cells)));
    const double all = double(comm.sum(static_cast<std::int64_t>(cells)));
    labels.label.assign(cells + n, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < cells + n; ++i)
        labels.lower(i, i < cells ? before + double(i) : all + double(i - cells));
    auto label = Kokkos::create_mirror_view(label_);
    std::vector<double> of_body(n);
    for (bool changed = true; changed;) {
        for (std::size_t i = 0; i < cells; ++i) label(i) = liquid(i) != 0 ? labels.of(i) : -1;
        for (std::size_t b = 0; b < n; ++b) of_body[b] = -labels.of(cells + b);
        Kokkos::deep_copy(label_, label);
        scene.halo.gather({label_});
        const auto others = on_host(label_);
        comm.max(std::span<double>(of_body));
        changed = false;
        for (std::size_t i = 0; i < cells; ++i) {
            if (others(i) >= 0) changed = labels.lower(i, others(i)) || changed;
        }
        for (std::size_t b = 0; b < n; ++b) changed = labels.lower(cells + b, -of_body[b]) || changed;
        changed = comm.any(changed);
    }
}

// Makes a group for each label of a body, in the order of the bodies. Returns these labels.
std::vector<double> MomentumBalance::group_bodies(Labels& labels, const rigid::RigidBodies& bodies) {
    std::vector<double> found;
    groups_.clear();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const double of = labels.of_body(b);
        const auto g = index_of(found, of);
        if (g == found.size()) {
            found.push_back(of);
            groups_.emplace_back();
        }
        if (bodies.moves(b)) groups_[g].bodies.push_back(b);
    }
    return found;
}

// Members are the cells of the window, then the bodies; on the host, where the sets are.
void MomentumBalance::connect(const Comm& comm, const Scene& scene, const rigid::RigidBodies& bodies) {
    const auto cells = static_cast<std::size_t>(scene.halo.window().size());
    reserve(label_, cells);
    reserve(group_, cells);
    mark_liquid(scene, group_);
    scene.halo.gather({group_});
    const auto liquid = on_host(group_);
    Labels labels(cells, bodies.size());
    std::vector<char> rests(cells, 0);
    join_cells(scene, liquid, labels.sets, rests);
    lower_labels(comm, scene, liquid, labels);
    const auto found = group_bodies(labels, bodies);
    std::vector<std::int64_t> touches(2 * groups_.size(), 0); // something at rest; liquid
    auto group = Kokkos::create_mirror_view(group_);
    for (std::size_t i = 0; i < cells; ++i) {
        const bool wet = liquid(i) != 0; // read first: on a host build both are the same numbers
        group(i) = -1;
        if (!wet) continue;
        const auto g = index_of(found, labels.of(i));
        if (g == groups_.size()) continue;
        group(i) = static_cast<int>(g);
        touches[2 * g] += rests[i];
        touches[2 * g + 1] += 1;
    }
    Kokkos::deep_copy(group_, group);
    comm.sum(std::span<std::int64_t>(touches));
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        auto& of = groups_[g];
        const auto surface_velocity_only = [&](std::size_t b) {
            return bodies.setup().bodies[b].surface_velocity_only;
        };
        of.balanced = touches[2 * g] == 0 && touches[2 * g + 1] > 0 && !of.bodies.empty() &&
                      std::ranges::none_of(of.bodies, surface_velocity_only);
        of.free = std::ranges::none_of(of.bodies, [&](std::size_t b) { return is_constrained(bodies, b); });
    }
}

MomentumBalance::Sums MomentumBalance::sums(const Comm& comm, const Scene& scene, int group) const {
    SumLoop loop;
    loop.grid = scene.grid;
    loop.window = scene.halo.window();
    loop.group = group_;
    loop.wanted = group;
    loop.x = scene.particles.position();
    loop.u = scene.particles.velocity();
    for (int a = 0; a < 3; ++a) loop.c[a] = scene.particles.affine(a);
    loop.liquid = scene.particles.liquid();
    loop.mass = scene.particle_mass;
    std::array<double, count> all{};
    Kokkos::parallel_reduce("treacle::momentum_sums", scene.particles.store.owned(), loop,
        Kokkos::View<double*, Kokkos::HostSpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>>(all.data(), count));
    comm.sum(std::span<double>(all));
    if (scene.grid.dimensions == 2) std::ranges::for_each(all, [&](double& sum) { sum /= scene.grid.dx; });
    Sums out;
    std::copy_n(all.begin(), 6, out.momentum.begin());
    out.mass = all[6];
    std::copy_n(all.begin() + 7, 3, out.moment.begin());
    std::copy_n(all.begin() + 10, 9, out.turn.begin());
    return out;
}

void MomentumBalance::move(const Scene& scene, int group, const Vec3& velocity, const Vec3& spin) const {
    const MacGrid grid = scene.grid;
    const CellBox window = scene.halo.window();
    const auto of = group_;
    const auto x = scene.particles.position(), u = scene.particles.velocity();
    const double v[3] = {velocity[0], velocity[1], velocity[2]}, w[3] = {spin[0], spin[1], spin[2]};
    const Array3 c[3] = {scene.particles.affine(0), scene.particles.affine(1), scene.particles.affine(2)};
    Kokkos::parallel_for(
        "treacle::balance_momentum", scene.particles.store.owned(), KOKKOS_LAMBDA(int i) {
            int cell[3];
            grid.cells.locate(x(i, 0), x(i, 1), x(i, 2), cell);
            if (of(window.index(cell[0], cell[1], cell[2])) != group) return;
            for (int a = 0; a < grid.dimensions; ++a) {
                const int b = (a + 1) % 3, d = (a + 2) % 3;
                u(i, a) += v[a] + w[b] * x(i, d) - w[d] * x(i, b);
                c[a](i, d) += w[b];
                c[a](i, b) -= w[d];
            }
        });
}

void MomentumBalance::begin(const Comm& comm, const Scene& scene, const rigid::RigidBodies& bodies) {
    groups_.clear();
    // Liquid at an inlet is pushed by what is behind it.
    bool any = false;
    for (std::size_t b = 0; b < bodies.size(); ++b)
        any = any || (bodies.moves(b) && !bodies.setup().bodies[b].surface_velocity_only);
    if (!any) return;
    connect(comm, scene, bodies);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (groups_[g].balanced) groups_[g].before = sums(comm, scene, static_cast<int>(g));
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
Matrix6 mass_of(const MomentumBalance::Sums& liquid) {
    Matrix6 out = Matrix6::Zero();
    const auto moment = cross_matrix({liquid.moment[0], liquid.moment[1], liquid.moment[2]});
    out.block<3, 3>(0, 0) = liquid.mass * Eigen::Matrix3d::Identity();
    out.block<3, 3>(0, 3) = -moment;
    out.block<3, 3>(3, 0) = moment;
    out.block<3, 3>(3, 3) = Eigen::Map<const Eigen::Matrix3d>(liquid.turn.data());
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

void MomentumBalance::end(
    const Comm& comm, const Scene& scene, const Kick& kick, rigid::RigidBodies& bodies, std::span<double> loads) {
    const auto kept = motions(scene.grid);
    std::vector<double> body_loads(6 * bodies.size(), 0.0);
    bool any = false;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const auto& group = groups_[g];
        if (!group.balanced) continue;
        const auto after = sums(comm, scene, static_cast<int>(g));
        const auto load = [&](std::size_t b) { return loads.subspan(6 * b, 6); };
        const Vec3 moment{after.moment[0], after.moment[1], after.moment[2]};
        Vector6 missing;
        missing << kick.time * after.mass * vector(kick.gravity),
            kick.time * vector(moment).cross(vector(kick.gravity));
        for (int k = 0; k < 6; ++k)
            missing[k] -=
                after.momentum[static_cast<std::size_t>(k)] - group.before.momentum[static_cast<std::size_t>(k)];
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
        const Vec3 velocity{motion[0], motion[1], motion[2]}, spin{motion[3], motion[4], motion[5]};
        move(scene, static_cast<int>(g), velocity, spin);
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
}

} // namespace treacle::grid
