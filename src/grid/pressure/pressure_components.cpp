#include "grid/pressure/pressure_components.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::grid {

namespace {
// Labels rise to those of parts that end at a surface, and fall to the least row otherwise.
double join_labels(double a, double b) {
    const bool open = std::floor(a) != a || std::floor(b) != b;
    return std::min(std::floor(a), std::floor(b)) + (open ? 0.5 : 0.0);
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
    parts_.assign(labels_.empty() ? 0 : sets_.size(), -1);
    sizes_.assign(labels_.size(), 0.0);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const double of = label_[sets_.find(i)];
        if (!is_closed(of)) continue;
        const auto at = std::lower_bound(labels_.begin(), labels_.end(), static_cast<std::int64_t>(of));
        parts_[i] = static_cast<int>(at - labels_.begin());
        sizes_[static_cast<std::size_t>(parts_[i])] += weights_[i];
    }
    comm.sum(std::span(sizes_));
}

void PressureComponents::weigh(const solve::CsrBlocks& matrix) {
    weights_.clear();
    for (int i = 0; i < matrix.rows; ++i) weights_.push_back(matrix.diagonal(i));
}

void PressureComponents::find_relief(
    const Comm& comm, const PressureCoupling& coupling, const rigid::RigidBodies& bodies) {
    const std::size_t width = 6 * bodies.size();
    std::vector<double> net(labels_.size() * width, 0.0), gross(net.size(), 0.0);
    for (const auto& entry : coupling.entries()) {
        const int part = parts_[static_cast<std::size_t>(entry.row)];
        if (part < 0) continue;
        const std::size_t at = static_cast<std::size_t>(part) * width + 6 * static_cast<std::size_t>(entry.body);
        for (std::size_t k = 0; k < 6; ++k) {
            net[at + k] += entry.u[k];
            gross[at + k] += std::fabs(entry.u[k]);
        }
    }
    comm.sum(std::span(net));
    comm.sum(std::span(gross));
    relief_.find(bodies.mobility(), labels_.size(), net, gross);
}

void PressureComponents::anchor(const Comm& comm, const solve::CsrBlocks& matrix,
    std::span<const double> dirichlet_diagonal, const PressureCoupling& coupling, const rigid::RigidBodies& bodies) {
    unpinned_.clear();
    weigh(matrix);
    label(comm, matrix, dirichlet_diagonal);
    number(comm, matrix.first_row);
    if (labels_.empty()) return;
    find_relief(comm, coupling, bodies);
    for (std::size_t p = 0; p < labels_.size(); ++p) {
        const auto row = static_cast<int>(labels_[p] - matrix.first_row);
        if (row < 0 || row >= matrix.rows) continue;
        const double weight = weights_[static_cast<std::size_t>(row)];
        matrix.diagonal(row) += weight;
        if (relief_.relieved(p)) unpinned_.push_back({row, weight});
    }
}

double PressureComponents::balance(const Comm& comm, std::span<double> b) const {
    const std::size_t parts = labels_.size();
    if (parts == 0) return 0;
    std::vector<double> sums(2 * parts, 0.0);
    for (std::size_t i = 0; i < b.size(); ++i) {
        if (parts_[i] < 0) continue;
        sums[static_cast<std::size_t>(parts_[i])] += b[i];
        sums[parts + static_cast<std::size_t>(parts_[i])] += std::fabs(b[i]);
    }
    comm.sum(std::span(sums));
    const auto surplus = relief_.surplus(std::span(sums).first(parts), sizes_);
    double taken = 0;
    for (std::size_t p = 0; p < parts; ++p) {
        if (sums[parts + p] > 0) taken = std::max(taken, sizes_[p] * std::fabs(surplus[p]) / sums[parts + p]);
    }
    for (std::size_t i = 0; i < b.size(); ++i) {
        if (parts_[i] >= 0) b[i] -= weights_[i] * surplus[static_cast<std::size_t>(parts_[i])];
    }
    return taken;
}

} // namespace treacle::grid
