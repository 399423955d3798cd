#include "grid/momentum/loose_liquid.hpp"

#include "mpi/exchange.hpp"
#include "rigid/algebra.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cstring>
#include <map>

namespace treacle::grid {

namespace {
constexpr int count = MomentumSums::count;
// Least moment of inertia about an axis that a piece is turned about, of its mass and the square of a cell's width.
constexpr double least_inertia = 1.0 / 12;

struct Member {
    double label;
    int cell; // of the particles' list
};

std::vector<Member> members(const MomentumScene& scene, std::span<const double> label) {
    std::vector<Member> out;
    const CellBox owned = scene.halo.owned(), window = scene.halo.window(), list = scene.cells.window;
    for (int n = 0; n < owned.size(); ++n) {
        int c[3];
        owned.cell(n, c);
        const double of = label[static_cast<std::size_t>(window.index(c[0], c[1], c[2]))];
        if (of != LooseLiquid::none) out.push_back({of, list.index(c[0], c[1], c[2])});
    }
    std::ranges::stable_sort(out, {}, &Member::label);
    return out;
}
} // namespace

void LooseLiquid::begin(const MomentumScene& scene, std::span<const double> label) {
    const auto all = members(scene, label);
    labels_.clear();
    std::vector<int> first;
    for (std::size_t n = 0; n < all.size(); ++n) {
        if (n > 0 && all[n].label == labels_.back()) continue;
        labels_.push_back(all[n].label);
        first.push_back(static_cast<int>(n));
    }
    cells_ = static_cast<int>(all.size());
    first.push_back(cells_);
    reserve(cell_, all.size());
    reserve(first_, first.size());
    reserve(of_cell_, all.size() * count);
    reserve(before_, labels_.size() * count);
    reserve(after_, labels_.size() * count);
    reserve(motion_, labels_.size() * 6);
    const auto cell = Kokkos::create_mirror_view(cell_), start = Kokkos::create_mirror_view(first_);
    for (std::size_t n = 0; n < all.size(); ++n) cell(n) = all[n].cell;
    std::ranges::copy(first, start.data());
    Kokkos::deep_copy(cell_, cell);
    Kokkos::deep_copy(first_, start);
    sum(scene, before_);
}

// By cells, then by pieces, each in its order: the same bit for bit whatever the threads.
void LooseLiquid::sum(const MomentumScene& scene, const Array<double>& out) const {
    const MomentumParticles particles(scene);
    const CellList cells = scene.cells;
    const auto of_cell = of_cell_;
    const auto cell = cell_, first = first_;
    Kokkos::parallel_for(
        "treacle::loose_cells", cells_, KOKKOS_LAMBDA(int n) {
            double* sum = &of_cell(count * n);
            for (int k = 0; k < count; ++k) sum[k] = 0;
            for (int i = cells.begin(cell(n)); i < cells.end(cell(n)); ++i) particles.add(i, sum);
        });
    Kokkos::parallel_for(
        "treacle::loose_pieces", static_cast<int>(labels_.size()) * count, KOKKOS_LAMBDA(int n) {
            const int piece = n / count, k = n % count;
            double sum = 0;
            for (int i = first(piece); i < first(piece + 1); ++i) sum += of_cell(count * i + k);
            out(n) = sum;
        });
}

void LooseLiquid::move(const MomentumScene& scene) const {
    const MomentumParticles particles(scene);
    const CellList cells = scene.cells;
    const auto motions = motion_;
    const auto cell = cell_, first = first_;
    Kokkos::parallel_for(
        "treacle::move_loose", static_cast<int>(labels_.size()), KOKKOS_LAMBDA(int piece) {
            RigidMotion motion;
            for (int k = 0; k < 3; ++k) {
                motion.velocity[k] = motions(6 * piece + k);
                motion.spin[k] = motions(6 * piece + 3 + k);
            }
            for (int n = first(piece); n < first(piece + 1); ++n) {
                for (int i = cells.begin(cell(n)); i < cells.end(cell(n)); ++i) particles.move(i, motion);
            }
        });
}

namespace {
// A piece's deficit of momentum and angular momentum, and the sums of its mass.
struct Deficit {
    double label;
    MomentumSums sums;
};
struct Given {
    double label;
    double motion[6];
};

Eigen::Vector3d three(const double* of) { return {of[0], of[1], of[2]}; }

// Spins that are free: none beside a period, about z alone in 2D.
Eigen::Matrix3d free_spins(const MacGrid& grid) {
    const auto& period = grid.cells.period;
    const bool periodic = period[0] > 0 || period[1] > 0 || period[2] > 0;
    const double x = grid.dimensions == 3 && !periodic ? 1 : 0, z = periodic ? 0 : 1;
    return Eigen::Vector3d(x, x, z).asDiagonal();
}

// The rigid motion that has the momentum of a deficit. A drop as small as a cell is not turned.
Given motion_of(const Deficit& deficit, const MacGrid& grid) {
    const double* sums = deficit.sums.of;
    const double mass = sums[MomentumSums::mass];
    Given out{deficit.label, {}};
    if (!(mass > 0)) return out;
    const Eigen::Vector3d momentum = three(sums), centre = three(sums + MomentumSums::moment) / mass;
    const Eigen::Matrix3d free = free_spins(grid);
    const Eigen::Vector3d angular = free * (three(sums + MomentumSums::angular) - centre.cross(momentum));
    Eigen::Matrix3d inertia = Eigen::Map<const Eigen::Matrix3d>(sums + MomentumSums::turn);
    inertia -= mass * (centre.squaredNorm() * Eigen::Matrix3d::Identity() - centre * centre.transpose());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(free * inertia * free);
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
        if (axes.eigenvalues()[k] < least_inertia * mass * grid.dx * grid.dx) continue;
        const Eigen::Vector3d axis = axes.eigenvectors().col(k);
        spin += axis.dot(angular) / axes.eigenvalues()[k] * axis;
    }
    const Eigen::Vector3d velocity = momentum / mass - spin.cross(centre);
    for (int k = 0; k < 3; ++k) {
        out.motion[k] = k < grid.dimensions ? velocity[k] : 0;
        out.motion[3 + k] = spin[k];
    }
    return out;
}

template <class Record>
void append(std::vector<char>& bytes, const Record& record) {
    const auto at = bytes.size();
    bytes.resize(at + sizeof(Record));
    std::memcpy(bytes.data() + at, &record, sizeof(Record));
}
template <class Record, class Visit>
void each_record(const Message& message, const Visit& visit) {
    for (std::size_t at = 0; at + sizeof(Record) <= message.bytes.size(); at += sizeof(Record)) {
        Record record;
        std::memcpy(&record, message.bytes.data() + at, sizeof(Record));
        visit(record);
    }
}
std::vector<Message> messages(const std::map<int, std::vector<char>>& to) {
    std::vector<Message> out;
    for (const auto& [rank, bytes] : to) out.push_back({rank, bytes});
    return out;
}

// Collective: sums deficits of equal labels on the rank that the label names, and returns the motions that these have.
std::map<double, Given> sum_and_solve(const Comm& comm, const std::vector<Deficit>& own, const MacGrid& grid) {
    std::map<int, std::vector<char>> to;
    for (const auto& one : own) append(to[LooseLiquid::rank_of(one.label)], one);
    const auto arrived = exchange_sparse(comm, messages(to));
    std::map<double, Deficit> whole;
    for (const auto& message : arrived) {
        each_record<Deficit>(message, [&](const Deficit& part) {
            auto& sum = whole.try_emplace(part.label, Deficit{part.label, {}}).first->second;
            for (int k = 0; k < count; ++k) sum.sums.of[k] += part.sums.of[k];
        });
    }
    std::map<double, Given> given;
    for (const auto& [label, deficit] : whole) given[label] = motion_of(deficit, grid);
    std::map<int, std::vector<char>> back;
    for (const auto& message : arrived)
        each_record<Deficit>(message, [&](const Deficit& part) { append(back[message.rank], given[part.label]); });
    std::map<double, Given> out;
    for (const auto& message : exchange_sparse(comm, messages(back)))
        each_record<Given>(message, [&](const Given& one) { out[one.label] = one; });
    return out;
}
} // namespace

void LooseLiquid::end(const Comm& comm, const MomentumScene& scene, const MomentumKick& kick) {
    if (!comm.any(cells_ > 0)) return;
    sum(scene, after_);
    const auto before = on_host(before_), after = on_host(after_);
    std::vector<Deficit> deficits;
    const Eigen::Vector3d pull = kick.time * Eigen::Vector3d(kick.gravity[0], kick.gravity[1], kick.gravity[2]);
    for (std::size_t piece = 0; piece < labels_.size(); ++piece) {
        Deficit one{labels_[piece], {}};
        const double *from = &before(count * piece), *now = &after(count * piece);
        std::copy_n(now, count, one.sums.of);
        const Eigen::Vector3d weight = now[MomentumSums::mass] * pull,
                              turn = three(now + MomentumSums::moment).cross(pull);
        for (int k = 0; k < 3; ++k) {
            one.sums.of[k] = weight[k] + from[k] - now[k];
            one.sums.of[3 + k] = turn[k] + from[MomentumSums::kept + k] - now[3 + k];
        }
        deficits.push_back(one);
    }
    const auto given = sum_and_solve(comm, deficits, scene.grid);
    const auto motion = Kokkos::create_mirror_view(motion_);
    for (std::size_t piece = 0; piece < labels_.size(); ++piece)
        std::copy_n(given.at(labels_[piece]).motion, 6, &motion(6 * piece));
    Kokkos::deep_copy(motion_, motion);
    move(scene);
}

} // namespace treacle::grid
