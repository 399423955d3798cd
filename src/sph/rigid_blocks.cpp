#include "sph/rigid_blocks.hpp"

#include "sph/pair_softening.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace treacle::sph {

namespace {
constexpr int cells_across = 2; // of a block
constexpr std::size_t most_neighbours = 26; // blocks at the border of ranks may have more
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

// The blocks that one block of this rank meets.
struct RigidBlocks::Entry {
    int block; // global number
    std::array<double, 36> values{};

    void add(double c, const std::array<double, 6>& left, const std::array<double, 6>& right) {
        for (std::size_t k = 0; k < 6; ++k) {
            for (std::size_t l = 0; l < 6; ++l) values[6 * k + l] += c * left[k] * right[l];
        }
    }
};

struct RigidBlocks::Rows {
    std::vector<std::vector<Entry>> blocks; // the first entry of each is its own

    Entry& at(int local, int block) {
        auto& row = blocks[static_cast<std::size_t>(local)];
        for (auto& entry : row) {
            if (entry.block == block) return entry;
        }
        return row.emplace_back(Entry{block});
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
      arm_field_(liquid.store.add<Array3>("rigid_arm", "", FieldRole::work)), rows_(std::make_unique<Rows>()),
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
    const bool pours = parts.liquid.has_inlets();
    const auto inlet = on_host(pours ? parts.liquid.inlet() : Array<int>("treacle::no_inlets", 0));
    const auto held = [&](int i) { return pours && inlet(i) > 0; };
    rows_->blocks.assign(static_cast<std::size_t>(count_), {});
    for (int b = 0; b < count_; ++b) {
        auto& row = rows_->blocks[static_cast<std::size_t>(b)];
        row.reserve(most_neighbours + 1);
        row.push_back({first_ + b});
    }
    const auto arm_of = [&](int i) { return std::array<double, 3>{arm(i, 0), arm(i, 1), arm(i, 2)}; };
    const auto add_all = [&](int local, double c, const double a[3]) { // the same along each axis
        auto& own = rows_->blocks[static_cast<std::size_t>(local)].front();
        for (std::size_t k = 0; k < static_cast<std::size_t>(constants.dimensions); ++k) {
            Vec3 n{0, 0, 0};
            n[k] = 1;
            own.add(c, along(n, a), along(n, a));
        }
    };
    const auto liquid = pairs(parts.neighbours.liquid, store, store);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        for (int i = 0; i < store.owned(); ++i) {
            const int local = block(i) - first_;
            const auto own_arm = arm_of(i);
            add_all(local, relative(i) + (slip.any() ? drag(i) : 0), own_arm.data());
            if (held(i)) continue; // it does not move with its block
            liquid.each(i, [&](int j, double dx, double dy, double dz, double r2) {
                if (block(j) == block(i) && !held(j)) return; // a rigid motion strains no pair
                const double w = -constants.rest_volume * kernel.gradient(std::sqrt(r2));
                const double c = (constants.dimensions + 2) * (share(i) + share(j)) * w / (r2 + soft);
                const Vec3 line{dx, dy, dz};
                const auto other_arm = arm_of(j);
                const auto left = along(line, own_arm.data()), right = along(line, other_arm.data());
                rows_->at(local, block(i)).add(c, left, left);
                if (!held(j)) rows_->at(local, block(j)).add(-c, left, right);
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
void RigidBlocks::connect() {
    const int m = unknowns_;
    solve::BlockRows out;
    out.size = m;
    out.first = first_;
    std::size_t entries = 0;
    for (const auto& row : rows_->blocks) entries += row.size();
    out.columns.reserve(entries);
    out.values.reserve(entries * static_cast<std::size_t>(m * m));
    for (int b = 0; b < count_; ++b) {
        auto& row = rows_->blocks[static_cast<std::size_t>(b)];
        double most = 0;
        for (std::size_t k = 0; k < 6; ++k) most = std::max(most, row.front().values[7 * k]);
        for (std::size_t k = 0; k < 6; ++k) row.front().values[7 * k] += floor_of_diagonal * most;
        std::sort(row.begin(), row.end(), [](const Entry& x, const Entry& y) { return x.block < y.block; });
        for (const auto& entry : row) {
            out.columns.push_back(entry.block);
            for (int k = 0; k < m * m; ++k) {
                const int at = 6 * motion_of(k / m, m) + motion_of(k % m, m);
                out.values.push_back(entry.values[static_cast<std::size_t>(at)]);
            }
        }
        out.offsets.push_back(static_cast<solve::Index>(out.columns.size()));
    }
    rows_->blocks = {}; // before the multigrid takes as much
    matrix_.build(comm_, out);
}

void RigidBlocks::set_up(const ViscousParts& parts, const ViscousWalls& walls, const Array<double>& share, const WallSlip& slip) {
    number(parts);
    assemble(parts, walls, share, slip);
    connect();
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
            of[static_cast<std::size_t>(motion)] = motion < 3 ? 1 : width_;
            if (motion >= 3) { // t = e x X
                const auto& x = centres_[static_cast<std::size_t>(b)];
                const std::size_t e = static_cast<std::size_t>(motion - 3), p = (e + 1) % 3, q = (e + 2) % 3;
                of[p] = -x[q];
                of[q] = x[p];
            }
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
