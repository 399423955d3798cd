#include "solve/krylov/field_split_preconditioner.hpp"

#include <algorithm>

namespace treacle::solve {

FieldSplitPreconditioner::FieldSplitPreconditioner(const Comm& comm, std::string prefix, Preconditioner preconditioner)
    : comm_(comm), prefix_(std::move(prefix)) {
    options_.preconditioner = preconditioner;
}

// Rows and columns of one component, numbered by themselves.
BlockRows FieldSplitPreconditioner::take_rows(
    const Matrix& matrix, std::span<const signed char> components, int component, Part& part) {
    const auto& a = matrix.blocks();
    part.rows.clear();
    numbers_.assign(components.size(), -1.0);
    for (std::size_t i = 0; i < components.size(); ++i) {
        if (components[i] == component) part.rows.push_back(static_cast<Index>(i));
    }
    BlockRows out;
    out.first = static_cast<Index>(comm_.exclusive_sum(static_cast<std::int64_t>(part.rows.size())));
    for (std::size_t k = 0; k < part.rows.size(); ++k) {
        numbers_[static_cast<std::size_t>(part.rows[k])] = double(out.first) + double(k);
    }
    std::span<const double> around;
    if (a.halo) around = a.halo->gather(numbers_);
    std::vector<std::pair<Index, double>> row;
    for (const Index i : part.rows) {
        row.clear();
        const auto add = [&](double number, double value) {
            if (number >= 0) row.emplace_back(static_cast<Index>(number), value);
        };
        for (Index k = a.diagonal_offsets[i]; k < a.diagonal_offsets[i + 1]; ++k) {
            add(numbers_[static_cast<std::size_t>(a.diagonal_columns[k])], a.diagonal_values[k]);
        }
        for (Index k = a.off_offsets[i]; k < a.off_offsets[i + 1]; ++k) {
            add(around[static_cast<std::size_t>(a.off_columns[k])], a.off_values[k]);
        }
        std::sort(row.begin(), row.end());
        for (const auto& [column, value] : row) {
            out.columns.push_back(column);
            out.values.push_back(value);
        }
        out.offsets.push_back(static_cast<Index>(out.columns.size()));
    }
    return out;
}

void FieldSplitPreconditioner::set_up(const Matrix& matrix, std::span<const signed char> components, int count) {
    parts_.clear();
    for (int c = 0; c < count; ++c) {
        auto& part = parts_.emplace_back();
        part.matrix.build(comm_, take_rows(matrix, components, c, part));
        part.solver = std::make_unique<KrylovSolver>(comm_, prefix_, options_);
        part.solver->set_up(*part.matrix.matrix());
        part.r.resize(part.rows.size());
        part.z.resize(part.rows.size());
    }
}

void FieldSplitPreconditioner::apply(std::span<const double> r, std::span<double> z) {
    std::fill(z.begin(), z.end(), 0.0);
    for (auto& part : parts_) {
        if (part.matrix.matrix()->global_rows() == 0) continue;
        for (std::size_t k = 0; k < part.rows.size(); ++k) part.r[k] = r[static_cast<std::size_t>(part.rows[k])];
        part.solver->precondition(part.r, part.z);
        for (std::size_t k = 0; k < part.rows.size(); ++k) z[static_cast<std::size_t>(part.rows[k])] = part.z[k];
    }
}

std::size_t FieldSplitPreconditioner::bytes() const {
    std::size_t total = 8 * numbers_.capacity();
    for (const auto& part : parts_) {
        total +=
            part.matrix.bytes() + sizeof(Index) * part.rows.capacity() + 8 * (part.r.capacity() + part.z.capacity());
    }
    return total;
}

} // namespace treacle::solve
