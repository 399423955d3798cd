#include "sph/rigid_blocks.hpp"

#include "sph/pair_softening.hpp"
#include "sph/rigid_motion.hpp"

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

// The blocks that those of this rank meet, filled in place: what is summed is what the matrix is made of.
struct RigidBlocks::Rows {
    solve::BlockRows blocks;

    double* at(int local, int block) {
        const auto first = blocks.columns.begin() + blocks.offsets[static_cast<std::size_t>(local)];
        const auto last = blocks.columns.begin() + blocks.offsets[static_cast<std::size_t>(local) + 1];
        const auto entry = std::lower_bound(first, last, block) - blocks.columns.begin();
        return &blocks.values[static_cast<std::size_t>(entry) * static_cast<std::size_t>(blocks.size * blocks.size)];
    }
    void add(int local, int block, double c, const std::array<double, 6>& left, const std::array<double, 6>& right) {
        const int m = blocks.size;
        double* values = at(local, block);
        for (int k = 0; k < m; ++k) {
            const double share = c * left[static_cast<std::size_t>(motion_of(k, m))];
            for (int l = 0; l < m; ++l) values[m * k + l] += share * right[static_cast<std::size_t>(motion_of(l, m))];
        }
    }
};

namespace {
solve::KrylovOptions coarse_options() {
    solve::KrylovOptions options;
    options.preconditioner = solve::Preconditioner::gamg;
    return options;
}
} // namespace

RigidBlocks::RigidBlocks(const Comm& comm, LiquidParticles& liquid, const CellGrid& grid)
    : comm_(comm), grid_(grid), width_(cells_across / grid.inverse_width[0]), unknowns_(grid.dimensions == 3 ? 6 : 3),
      block_field_(liquid.store.add<Array<int>>("rigid_block", "", FieldRole::work)),
      arm_field_(liquid.acceleration_field()), rows_(std::make_unique<Rows>()),
      solver_(comm, "viscosity_coarse", coarse_options()) {}

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

// On the host, as the coarse levels of the pressure system are.
void RigidBlocks::assemble(const ViscousParts& parts, const ViscousWalls& walls, const Array<double>& device_share,
                           const WallSlip& slip) {
    const auto& store = parts.liquid.store;
    const auto block = on_host(store.get<Array<int>>(block_field_));
    const auto arm = on_host(store.get<Array3>(arm_field_));
    const auto share = on_host(device_share), drag = on_host(slip.drag());
    const auto& constants = parts.constants;
    const double soft = pair_softening(constants.support);
    const auto relative = relative_density(constants, parts.liquid);
    const Held held(parts.liquid);
    const auto arm_of = [&](int i) { return std::array<double, 3>{arm(i, 0), arm(i, 1), arm(i, 2)}; };
    const auto add_all = [&](int local, double c, const double a[3]) { // the same along each axis
        for (std::size_t k = 0; k < static_cast<std::size_t>(constants.dimensions); ++k) {
            Vec3 n{0, 0, 0};
            n[k] = 1;
            rows_->add(local, first_ + local, c, along(n, a), along(n, a));
        }
    };
    const auto liquid = pairs(parts.neighbours.liquid, store, store);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        for (int i = 0; i < store.owned(); ++i) {
            const int local = block(i) - first_;
            const auto own_arm = arm_of(i);
            add_all(local, relative(i) + (slip.any() ? drag(i) : 0), own_arm.data());
            if (held(i)) continue;
            liquid.each(i, [&](int j, double dx, double dy, double dz, double r2) {
                if (block(j) == block(i) && !held(j)) return; // a rigid motion strains no pair
                const double w = -constants.rest_volume * kernel.gradient(std::sqrt(r2));
                const double c = (constants.dimensions + 2) * (share(i) + share(j)) * w / (r2 + soft);
                const Vec3 line{dx, dy, dz};
                const auto other_arm = arm_of(j);
                const auto left = along(line, own_arm.data()), right = along(line, other_arm.data());
                rows_->add(local, block(i), c, left, left);
                if (!held(j)) rows_->add(local, block(j), -c, left, right);
            });
            walls.pairs.each(i, [&](int s, double dx, double dy, double dz, double r2) {
                if (!walls.grips(s)) return;
                const double w = -walls.grip * walls.volume(s) * kernel.gradient(std::sqrt(r2));
                add_all(local, 2 * share(i) * w * walls.touch(s, dx, dy, dz).reach, own_arm.data());
            });
        }
    });
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

void RigidBlocks::set_up(const ViscousParts& parts, const ViscousWalls& walls, const Array<double>& share, const WallSlip& slip) {
    solver_.release(); // the last step's multigrid and matrix, before the next ones take as much
    matrix_.clear();
    number(parts);
    connect(parts);
    assemble(parts, walls, share, slip);
    build();
    matrix_.matrix()->set_blocks(unknowns_, rigid_motions());
    solver_.set_up(*matrix_.matrix());
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
    solver_.precondition(residual_, correction_);
    Kokkos::deep_copy(coarse, Host(correction_.data(), rows));
    prolong(block, arm, coarse_, first_, store.owned(), unknowns_, z);
}

std::size_t RigidBlocks::bytes() const {
    return 8 * (coarse_.span() + residual_.capacity() + correction_.capacity()) + matrix_.bytes();
}

} // namespace treacle::sph
