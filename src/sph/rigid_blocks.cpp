#include "sph/rigid_blocks.hpp"

#include "sph/pair_softening.hpp"
#include "sph/rigid_motion.hpp"
#include "sph/symmetric.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace treacle::sph {

namespace {
constexpr int cells_across = 2; // of a block
// A particle alone in its block has no arm, and the block's rotations no inertia: they get this share of the largest
// diagonal entry, which changes nothing else.
constexpr double floor_of_diagonal = 1e-8;

// Unknowns of a motion: t_x, t_y, t_z, w_x, w_y, w_z; in the plane t_x, t_y, w_z.
KOKKOS_INLINE_FUNCTION int motion_of(int unknown, int unknowns) {
    return unknowns == 3 && unknown == 2 ? 5 : unknown;
}

// n.u of the motions of a block, u = t + w' x a.
std::array<double, 6> along(const Vec3& n, const double a[3]) {
    return {n[0], n[1], n[2], a[1] * n[2] - a[2] * n[1], a[2] * n[0] - a[0] * n[2], a[0] * n[1] - a[1] * n[0]};
}
} // namespace

namespace {
// On a particle, of each unit motion of a block; room for eight, which are added to at once.
using Forces = std::array<std::array<double, 8>, 3>;

// Of its own block when each of its displacements costs a force.
Forces stiff_forces(const Symmetric& stiffness, const double arm[3]) {
    Forces out{};
    for (std::size_t l = 0; l < 6; ++l) {
        const auto moved = rigid_motion(static_cast<int>(l), {arm[0], arm[1], arm[2]});
        double force[3];
        stiffness.times(moved.data(), force);
        for (std::size_t k = 0; k < 3; ++k) out[k][l] = force[k];
    }
    return out;
}

// What the neighbours of one particle in each of the other blocks put on it.
class Meetings {
public:
    struct Meeting {
        int block;
        Forces forces;
    };
    void clear() { meetings_.clear(); }
    Forces& with(int block) {
        if (!meetings_.empty() && meetings_[last_].block == block) return meetings_[last_].forces;
        for (last_ = 0; last_ < meetings_.size(); ++last_) {
            if (meetings_[last_].block == block) return meetings_[last_].forces;
        }
        meetings_.push_back({block, {}});
        return meetings_.back().forces;
    }
    const std::vector<Meeting>& all() const { return meetings_; }

private:
    std::vector<Meeting> meetings_;
    std::size_t last_ = 0;
};
} // namespace

// The blocks that those of this rank meet, filled in place: what is summed is what the matrix is made of.
struct RigidBlocks::Rows {
    solve::BlockRows blocks;

    double* at(int local, int block) {
        const auto first = blocks.columns.begin() + blocks.offsets[static_cast<std::size_t>(local)];
        const auto last = blocks.columns.begin() + blocks.offsets[static_cast<std::size_t>(local) + 1];
        const auto entry = std::lower_bound(first, last, block) - blocks.columns.begin();
        return &blocks.values[static_cast<std::size_t>(entry) * static_cast<std::size_t>(blocks.size * blocks.size)];
    }
    // Adds sign times J^T of a point at this arm, whose velocity is J of the motions, times the forces on it.
    void add(int local, int block, double sign, const Forces& forces, const double arm[3]) {
        const int m = blocks.size;
        double* values = at(local, block);
        for (int l = 0; l < m; ++l) {
            const auto column = static_cast<std::size_t>(motion_of(l, m));
            const auto moments = along({forces[0][column], forces[1][column], forces[2][column]}, arm);
            for (int k = 0; k < m; ++k) values[m * k + l] += sign * moments[static_cast<std::size_t>(motion_of(k, m))];
        }
    }
};

namespace {
solve::KrylovOptions coarse_options(solve::Preconditioner preconditioner) {
    solve::KrylovOptions options;
    options.preconditioner = preconditioner;
    options.sweeps = 2;
    return options;
}
// Largest nu dt over the square of a block's width for which sweeps do.
constexpr double mild = 1;
} // namespace

RigidBlocks::RigidBlocks(const Comm& comm, LiquidParticles& liquid, const CellGrid& grid)
    : comm_(comm), grid_(grid), width_(cells_across / grid.inverse_width[0]), unknowns_(grid.dimensions == 3 ? 6 : 3),
      block_field_(liquid.store.add<Array<int>>("rigid_block", "", FieldRole::work)),
      arm_field_(liquid.acceleration_field()), rows_(std::make_unique<Rows>()),
      multigrid_(comm, "viscosity_coarse", coarse_options(solve::Preconditioner::gamg)),
      sweeps_(comm, "viscosity_mild", coarse_options(solve::Preconditioner::ssor)) {}

RigidBlocks::~RigidBlocks() = default;

// Blocks are cut at the borders of ranks; those without particles get no number.
void RigidBlocks::number(const ViscousParts& parts) {
    const auto& store = parts.liquid.store;
    const int n = store.owned();
    const auto x = on_host(store.position());
    const auto block = Kokkos::create_mirror_view(store.get<Array<int>>(block_field_));
    const auto arm = Kokkos::create_mirror_view(store.get<Array3>(arm_field_));
    const CellBox box = occupied_cells(store, grid_);
    int size[3];
    for (int k = 0; k < 3; ++k) size[k] = n > 0 ? (box.hi[k] - box.lo[k] + cells_across - 1) / cells_across : 0;
    std::vector<int> numbers(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1] * size[2]), -1);
    centres_.clear();
    std::vector<int> particles;
    for (int i = 0; i < n; ++i) {
        int c[3];
        grid_.locate(x(i, 0), x(i, 1), x(i, 2), c);
        for (int k = 0; k < 3; ++k) c[k] = (c[k] - box.lo[k]) / cells_across;
        int& number = numbers[static_cast<std::size_t>(c[0] + size[0] * (c[1] + size[1] * c[2]))];
        if (number < 0) {
            number = static_cast<int>(centres_.size());
            centres_.push_back({0, 0, 0});
            particles.push_back(0);
        }
        block(i) = number;
        ++particles[static_cast<std::size_t>(number)];
        for (std::size_t k = 0; k < 3; ++k) centres_[static_cast<std::size_t>(number)][k] += x(i, k);
    }
    count_ = static_cast<int>(centres_.size());
    first_ = static_cast<int>(comm_.exclusive_sum(std::int64_t(count_)));
    for (std::size_t b = 0; b < centres_.size(); ++b) {
        for (double& centre : centres_[b]) centre /= particles[b];
    }
    for (int i = 0; i < n; ++i) {
        const auto& centre = centres_[static_cast<std::size_t>(block(i))];
        for (int k = 0; k < 3; ++k) arm(i, k) = (x(i, k) - centre[static_cast<std::size_t>(k)]) / width_;
        block(i) += first_;
    }
    Kokkos::deep_copy(store.get<Array<int>>(block_field_), block);
    Kokkos::deep_copy(store.get<Array3>(arm_field_), arm);
    parts.halo.gather(store, {block_field_, arm_field_});
}

namespace {
// Particles that an inlet holds do not move with their block.
struct Held {
    bool any;
    Array<int>::HostMirror inlet;
    explicit Held(const LiquidParticles& liquid)
        : any(liquid.has_inlets()), inlet(on_host(any ? liquid.inlet() : Array<int>("treacle::no_inlets", 0))) {}
    bool operator()(int i) const { return any && inlet(i) > 0; }
};
} // namespace

// Which blocks meet, their values still 0.
void RigidBlocks::connect(const ViscousParts& parts) {
    const auto& store = parts.liquid.store;
    const auto block = on_host(store.get<Array<int>>(block_field_));
    const auto offset = on_host(parts.neighbours.liquid.offset);
    const auto index = on_host(parts.neighbours.liquid.index);
    const Held held(parts.liquid);
    std::vector<std::vector<int>> meets(static_cast<std::size_t>(count_));
    for (int b = 0; b < count_; ++b) meets[static_cast<std::size_t>(b)].push_back(first_ + b);
    for (int i = 0; i < store.owned(); ++i) {
        if (held(i)) continue;
        auto& row = meets[static_cast<std::size_t>(block(i) - first_)];
        int last = block(i); // neighbours of one block come one after the other
        for (std::int64_t k = offset(i); k < offset(i + 1); ++k) {
            const int j = index(k), other = block(j);
            if (other == last || held(j)) continue;
            last = other;
            const auto place = std::lower_bound(row.begin(), row.end(), other);
            if (place == row.end() || *place != other) row.insert(place, other);
        }
    }
    auto& out = rows_->blocks;
    out = {};
    out.size = unknowns_;
    out.first = first_;
    std::size_t entries = 0;
    for (const auto& row : meets) entries += row.size();
    out.columns.reserve(entries);
    for (const auto& row : meets) {
        out.columns.insert(out.columns.end(), row.begin(), row.end());
        out.offsets.push_back(static_cast<solve::Index>(out.columns.size()));
    }
    out.values.assign(entries * static_cast<std::size_t>(unknowns_ * unknowns_), 0.0);
}

namespace {
// Of each owned particle, what the solids that grip hold it with, over its share.
std::vector<double> wall_stiffness(const ViscousParts& parts, const ViscousWalls& walls) {
    const auto& constants = parts.constants;
    std::vector<double> out(static_cast<std::size_t>(parts.liquid.store.owned()), 0.0);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        for (std::size_t i = 0; i < out.size(); ++i) {
            walls.pairs.each(static_cast<int>(i), [&](int s, double dx, double dy, double dz, double r2) {
                if (!walls.grips(s)) return;
                const double w = -walls.grip * walls.volume(s) * kernel.gradient(std::sqrt(r2));
                out[i] += 2 * w * walls.touch(s, dx, dy, dz).reach;
            });
        }
    });
    return out;
}
} // namespace

// On the host, as the coarse levels of the pressure system are.
void RigidBlocks::assemble(const ViscousParts& parts, const ViscousOperator& of) {
    const auto& store = parts.liquid.store;
    const auto block = on_host(store.get<Array<int>>(block_field_));
    const auto arm = on_host(store.get<Array3>(arm_field_));
    const auto share = on_host(of.share(parts.liquid)), drag = on_host(of.slip().drag());
    const auto weights = on_host(of.weights());
    const auto by_walls = wall_stiffness(parts, of.walls(parts, ViscousOperator::Walls::resting));
    const auto& constants = parts.constants;
    const double soft = pair_softening(constants.support);
    const auto relative = relative_density(constants, parts.liquid);
    const Held held(parts.liquid);
    const auto offset = on_host(parts.neighbours.liquid.offset);
    const auto index = on_host(parts.neighbours.liquid.index);
    const auto x = on_host(store.position());
    const double line = constants.dimensions + 2;
    Meetings meetings;
    for (int i = 0; i < store.owned(); ++i) {
        const int own_block = block(i), local = own_block - first_;
        const double own_arm[3] = {arm(i, 0), arm(i, 1), arm(i, 2)};
        Symmetric stiffness;
        double all = relative(i) + (of.slip().any() ? drag(i) : 0); // the same along each axis
        meetings.clear();
        for (std::int64_t k = offset(i); k < offset(i + 1) && !held(i); ++k) {
            const int j = index(k);
            const bool moves = !held(j);
            if (block(j) == own_block && moves) continue; // a rigid motion strains no pair
            const Vec3 n{x(i, 0) - x(j, 0), x(i, 1) - x(j, 1), x(i, 2) - x(j, 2)};
            const double c = line * (share(i) + share(j)) * weights(k) / (n[0] * n[0] + n[1] * n[1] + n[2] * n[2] + soft);
            stiffness.add_square(c, n[0], n[1], n[2]);
            if (!moves) continue;
            const double other_arm[3] = {arm(j, 0), arm(j, 1), arm(j, 2)};
            const auto right = along(n, other_arm);
            auto& forces = meetings.with(block(j));
            for (std::size_t m = 0; m < 3; ++m) {
                for (std::size_t l = 0; l < 6; ++l) forces[m][l] += c * n[m] * right[l];
            }
        }
        if (!held(i)) all += share(i) * by_walls[static_cast<std::size_t>(i)];
        stiffness.xx += all, stiffness.yy += all, stiffness.zz += all;
        rows_->add(local, own_block, 1, stiff_forces(stiffness, own_arm), own_arm);
        for (const auto& meeting : meetings.all()) rows_->add(local, meeting.block, -1, meeting.forces, own_arm);
    }
}

// The blocks as a matrix of numbers.
void RigidBlocks::build() {
    const int m = unknowns_;
    for (int b = 0; b < count_; ++b) {
        double* own = rows_->at(b, first_ + b);
        double most = 0;
        for (int k = 0; k < m; ++k) most = std::max(most, own[(m + 1) * k]);
        for (int k = 0; k < m; ++k) own[(m + 1) * k] += floor_of_diagonal * most;
    }
    matrix_.build(comm_, rows_->blocks);
    rows_->blocks = {}; // before the multigrid takes as much
}

void RigidBlocks::set_up(const ViscousParts& parts, const ViscousOperator& of) {
    if (solver_ != nullptr) solver_->release(); // the last step's multigrid and matrix, before the next ones take as much
    matrix_.clear();
    number(parts);
    connect(parts);
    assemble(parts, of);
    build();
    matrix_.matrix()->set_blocks(unknowns_, rigid_motions());
    solver_ = of.largest_share() <= mild * width_ * width_ ? &sweeps_ : &multigrid_;
    solver_->set_up(*matrix_.matrix());
    const auto rows = static_cast<std::size_t>(unknowns_ * count_);
    reserve(coarse_, rows);
    residual_.resize(rows);
    correction_.resize(rows);
}

// Of all blocks together, as their unknowns have them.
std::vector<std::vector<double>> RigidBlocks::rigid_motions() const {
    const int m = unknowns_;
    std::vector<std::vector<double>> out(static_cast<std::size_t>(m), std::vector<double>(static_cast<std::size_t>(m * count_), 0.0));
    for (int k = 0; k < m; ++k) {
        const int motion = motion_of(k, m);
        auto& values = out[static_cast<std::size_t>(k)];
        for (int b = 0; b < count_; ++b) {
            std::array<double, 6> of{};
            const auto u = rigid_motion(motion, centres_[static_cast<std::size_t>(b)]);
            std::copy(u.begin(), u.end(), of.begin());
            if (motion >= 3) of[static_cast<std::size_t>(motion)] = width_;
            for (int l = 0; l < m; ++l) values[static_cast<std::size_t>(m * b + l)] = of[static_cast<std::size_t>(motion_of(l, m))];
        }
    }
    return out;
}

namespace {
void restrict_to(const Array<int>& block, const Array3& arm, const Array3& r, int first, int n, int m,
                 const Array<double>& coarse) {
    Kokkos::parallel_for("treacle::restrict_to_blocks", n, KOKKOS_LAMBDA(int i) {
        const double ax = arm(i, 0), ay = arm(i, 1), az = arm(i, 2);
        const double f[6] = {r(i, 0), r(i, 1), r(i, 2), ay * r(i, 2) - az * r(i, 1), az * r(i, 0) - ax * r(i, 2),
                             ax * r(i, 1) - ay * r(i, 0)};
        for (int k = 0; k < m; ++k) Kokkos::atomic_add(&coarse(m * (block(i) - first) + k), f[motion_of(k, m)]);
    });
}

void prolong(const Array<int>& block, const Array3& arm, const Array<double>& coarse, int first, int n, int m,
             const Array3& z) {
    Kokkos::parallel_for("treacle::prolong_blocks", n, KOKKOS_LAMBDA(int i) {
        double t[6] = {0, 0, 0, 0, 0, 0};
        for (int k = 0; k < m; ++k) t[motion_of(k, m)] = coarse(m * (block(i) - first) + k);
        z(i, 0) += t[0] + t[4] * arm(i, 2) - t[5] * arm(i, 1);
        z(i, 1) += t[1] + t[5] * arm(i, 0) - t[3] * arm(i, 2);
        z(i, 2) += t[2] + t[3] * arm(i, 1) - t[4] * arm(i, 0);
    });
}
} // namespace

// The coarse vectors go through host memory, where PETSc solves.
void RigidBlocks::correct(const LiquidParticles& liquid, const Array3& r, const Array3& z) {
    const auto& store = liquid.store;
    const auto block = store.get<Array<int>>(block_field_);
    const auto arm = store.get<Array3>(arm_field_);
    const auto rows = residual_.size();
    const auto range = Kokkos::make_pair(std::size_t(0), rows);
    using Host = Kokkos::View<double*, Kokkos::HostSpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>>;
    const auto coarse = Kokkos::subview(coarse_, range);
    Kokkos::deep_copy(coarse, 0.0);
    restrict_to(block, arm, r, first_, store.owned(), unknowns_, coarse_);
    Kokkos::deep_copy(Host(residual_.data(), rows), coarse);
    solver_->precondition(residual_, correction_);
    Kokkos::deep_copy(coarse, Host(correction_.data(), rows));
    prolong(block, arm, coarse_, first_, store.owned(), unknowns_, z);
}

std::size_t RigidBlocks::bytes() const {
    return 8 * (coarse_.span() + residual_.capacity() + correction_.capacity()) + matrix_.bytes();
}

} // namespace treacle::sph
