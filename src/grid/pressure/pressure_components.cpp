#include "grid/pressure/pressure_components.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace treacle::grid {

namespace {
// Fractions of all that a constant pressure pushes and turns with which a body must be pushed or turned on the whole to move.
// Pushes of a body with liquid all around add up to nothing, turns of one that the liquid slides along only nearly.
constexpr double least_push = 1e-6, least_turn = 0.03;
// Share of what it would be without joints that the work of such a push must be: below it is round-off.
constexpr double least_work = 1e-9;

// Labels rise to those of parts that end at a surface, and fall to the least row otherwise.
double join_labels(double a, double b) {
    const bool open = std::floor(a) != a || std::floor(b) != b;
    return std::min(std::floor(a), std::floor(b)) + (open ? 0.5 : 0.0);
}

double sum_sizes(std::span<const double> values) {
    double sum = 0;
    for (const double value : values) sum += std::fabs(value);
    return sum;
}

// True when bodies give way to a constant pressure that pushes and turns them by `net`, with `gross` the sums of sizes, both
// [6 a body].
bool moves(const rigid::ConstrainedInverseMass& mobility, std::span<const double> net, std::span<const double> gross) {
    std::vector<double> push(net.size(), 0.0);
    for (std::size_t at = 0; at < net.size(); at += 3) {
        const double least = (at % 6 == 0 ? least_push : least_turn) * sum_sizes(gross.subspan(at, 3));
        if (!(sum_sizes(net.subspan(at, 3)) > least)) continue;
        for (std::size_t k = at; k < at + 3; ++k) push[k] = net[k];
    }
    const auto moved = mobility.respond(push), alone = mobility.alone(push);
    const double work = std::inner_product(push.begin(), push.end(), moved.begin(), 0.0);
    return work > least_work * std::inner_product(push.begin(), push.end(), alone.begin(), 0.0);
}
} // namespace

void PressureComponents::label(
    const Comm& comm, const solve::CsrBlocks& matrix, std::span<const double> dirichlet_diagonal) {
    const auto rows = static_cast<std::size_t>(matrix.rows);
    sets_.reset(rows);
    for (int i = 0; i < matrix.rows; ++i) {
        for (int k = matrix.diagonal_offsets[i]; k < matrix.diagonal_offsets[i + 1]; ++k) {
            sets_.join(static_cast<std::size_t>(i), static_cast<std::size_t>(matrix.diagonal_columns[k]));
        }
    }
    label_.assign(rows, 0.0);
    for (std::size_t i = 0; i < rows; ++i) {
        const auto root = sets_.find(i);
        if (root == i) label_[i] = double(matrix.first_row) + double(i);
        if (dirichlet_diagonal[i] > 0) label_[root] = join_labels(label_[root], label_[root] + 0.5);
    }
    const auto closed = [&](std::size_t i) { return label_[i] == std::floor(label_[i]); };
    bool any = false;
    for (std::size_t i = 0; i < rows; ++i) any = any || (sets_.find(i) == i && closed(i));
    if (comm.size() == 1 || !comm.any(any)) return;
    std::vector<double> spread(rows);
    for (bool changed = true; changed;) {
        for (std::size_t i = 0; i < rows; ++i) spread[i] = label_[sets_.find(i)];
        const auto others = matrix.halo->gather(spread);
        changed = false;
        for (std::size_t i = 0; i < rows; ++i) {
            auto& mine = label_[sets_.find(i)];
            for (int k = matrix.off_offsets[i]; k < matrix.off_offsets[i + 1]; ++k) {
                const double joint = join_labels(mine, others[static_cast<std::size_t>(matrix.off_columns[k])]);
                changed = changed || joint != mine;
                mine = joint;
            }
        }
        changed = comm.any(changed);
    }
}

// The enclosed components of all ranks, in the order of their labels.
void PressureComponents::number(const Comm& comm, std::int64_t first_row) {
    labels_.clear();
    const auto is_closed = [](double label) { return label == std::floor(label); };
    for (std::size_t i = 0; i < sets_.size(); ++i) {
        const bool root = sets_.find(i) == i;
        if (root && is_closed(label_[i]) && label_[i] == double(first_row) + double(i)) {
            labels_.push_back(static_cast<std::int64_t>(label_[i]));
        }
    }
    labels_ = comm.all_gather(std::span<const std::int64_t>(labels_));
    std::sort(labels_.begin(), labels_.end());
    all_parts_.assign(labels_.empty() ? 0 : sets_.size(), -1);
    sizes_.assign(labels_.size(), 0.0);
    for (std::size_t i = 0; i < all_parts_.size(); ++i) {
        const double of = label_[sets_.find(i)];
        if (!is_closed(of)) continue;
        const auto at = std::lower_bound(labels_.begin(), labels_.end(), static_cast<std::int64_t>(of));
        all_parts_[i] = static_cast<int>(at - labels_.begin());
        sizes_[static_cast<std::size_t>(all_parts_[i])] += 1;
    }
    comm.sum(std::span(sizes_));
}

std::vector<char> PressureComponents::find_lifted(
    const Comm& comm, const PressureCoupling& coupling, const rigid::RigidBodies& bodies) const {
    std::vector<char> out(labels_.size(), 0);
    if (!bodies.any_dynamic()) return out;
    const std::size_t width = 6 * bodies.size();
    std::vector<double> net(labels_.size() * width, 0.0), gross(net.size(), 0.0);
    for (const auto& entry : coupling.entries()) {
        const int part = all_parts_[static_cast<std::size_t>(entry.row)];
        if (part < 0) continue;
        const std::size_t at = static_cast<std::size_t>(part) * width + 6 * static_cast<std::size_t>(entry.body);
        for (std::size_t k = 0; k < 6; ++k) {
            net[at + k] += entry.u[k];
            gross[at + k] += std::fabs(entry.u[k]);
        }
    }
    comm.sum(std::span(net));
    comm.sum(std::span(gross));
    const auto mobility = bodies.mobility();
    for (std::size_t part = 0; part < labels_.size(); ++part) {
        out[part] =
            moves(mobility, std::span(net).subspan(part * width, width), std::span(gross).subspan(part * width, width));
    }
    return out;
}

void PressureComponents::anchor(const Comm& comm, const solve::CsrBlocks& matrix,
    std::span<const double> dirichlet_diagonal, const PressureCoupling& coupling, const rigid::RigidBodies& bodies) {
    unpinned_.clear();
    label(comm, matrix, dirichlet_diagonal);
    number(comm, matrix.first_row);
    part_ = all_parts_;
    if (labels_.empty()) return;
    const auto gives_way = find_lifted(comm, coupling, bodies);
    for (std::size_t p = 0; p < labels_.size(); ++p) {
        const auto row = static_cast<int>(labels_[p] - matrix.first_row);
        if (row < 0 || row >= matrix.rows) continue;
        for (int k = matrix.diagonal_offsets[row]; k < matrix.diagonal_offsets[row + 1]; ++k) {
            if (matrix.diagonal_columns[k] != row) continue;
            const double weight = matrix.diagonal_values[k];
            matrix.diagonal_values[k] += weight;
            if (gives_way[p]) unpinned_.push_back({row, weight});
        }
    }
    for (auto& part : part_) {
        if (part >= 0 && gives_way[static_cast<std::size_t>(part)]) part = -1;
    }
}

double PressureComponents::balance(const Comm& comm, std::span<double> b) const {
    if (labels_.empty()) return 0;
    std::vector<double> sums(2 * labels_.size(), 0.0);
    for (std::size_t i = 0; i < b.size(); ++i) {
        if (part_[i] < 0) continue;
        sums[2 * static_cast<std::size_t>(part_[i])] += b[i];
        sums[2 * static_cast<std::size_t>(part_[i]) + 1] += std::fabs(b[i]);
    }
    comm.sum(std::span(sums));
    double taken = 0;
    for (std::size_t p = 0; p < labels_.size(); ++p) {
        if (sums[2 * p + 1] > 0) taken = std::max(taken, std::fabs(sums[2 * p]) / sums[2 * p + 1]);
    }
    for (std::size_t i = 0; i < b.size(); ++i) {
        if (part_[i] >= 0)
            b[i] -= sums[2 * static_cast<std::size_t>(part_[i])] / sizes_[static_cast<std::size_t>(part_[i])];
    }
    return taken;
}

} // namespace treacle::grid
