#include "fixture.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <iterator>
#include <memory>
#include <set>

namespace treacle::solve {

namespace {

std::unique_ptr<SolveRuntime> the_runtime;

class PetscEnvironment : public testing::Environment {
    void SetUp() override {
        the_runtime =
            std::make_unique<SolveRuntime>("-bad_pc_type nonsense -chosen_pc_type jacobi "
                                           "-misspelt_pc_tipe jacobi -sweeping_pc_type eisenstat "
                                           "-same_ksp_type cg -minimal_ksp_type minres "
                                           "-limited_ksp_max_it 3 -loose_ksp_rtol 1e-2 -odd_ksp_type strange");
    }
    void TearDown() override { the_runtime.reset(); }
};
[[maybe_unused]] const auto* const environment = testing::AddGlobalTestEnvironment(new PetscEnvironment);

} // namespace

const SolveRuntime& runtime() { return *the_runtime; }

TestSystem::TestSystem(const Comm& comm, Index n, Row definition, int owners)
    : global_rows(n), row(std::move(definition)) {
    const std::int64_t parts = std::min(owners, comm.size());
    const std::int64_t part = std::min<std::int64_t>(comm.rank(), parts);
    first = static_cast<Index>(n * part / parts);
    rows = static_cast<Index>(n * std::min(part + 1, parts) / parts) - first;
    for (Index i = first; i < first + rows; ++i) {
        for (const auto& [column, value] : row(i)) {
            const bool local = column >= first && column < first + rows;
            (local ? diagonal_columns : off_columns).push_back(local ? column - first : column);
            (local ? diagonal_values : off_values).push_back(value);
        }
        diagonal_offsets.push_back(static_cast<Index>(diagonal_columns.size()));
        off_offsets.push_back(static_cast<Index>(off_columns.size()));
    }
    const std::set<Index> others(off_columns.begin(), off_columns.end());
    halo.connect(comm, first, std::vector<Index>(others.begin(), others.end()));
    for (Index& column : off_columns) column = static_cast<Index>(std::distance(others.begin(), others.find(column)));
}

CsrBlocks TestSystem::blocks() {
    CsrBlocks blocks;
    blocks.diagonal_offsets = diagonal_offsets.data();
    blocks.diagonal_columns = diagonal_columns.data();
    blocks.diagonal_values = diagonal_values.data();
    blocks.off_offsets = off_offsets.data();
    blocks.off_columns = off_columns.data();
    blocks.off_values = off_values.data();
    blocks.halo = &halo;
    blocks.first_row = first;
    blocks.rows = rows;
    blocks.global_rows = global_rows;
    return blocks;
}

std::vector<double> TestSystem::product(const std::function<double(Index)>& x) const {
    return values([&](Index i) {
        double sum = 0;
        for (const auto& [column, value] : row(i)) sum += value * x(column);
        return sum;
    });
}

std::vector<double> TestSystem::values(const std::function<double(Index)>& x) const {
    std::vector<double> out;
    for (Index i = first; i < first + rows; ++i) out.push_back(x(i));
    return out;
}

TestSystem poisson(const Comm& comm, Index n, Border border, int owners) {
    auto row = [n, border](Index i) {
        const Index cell[3] = {i % n, i / n % n, i / (n * n)};
        const Index stride[3] = {1, n, n * n};
        std::vector<TestSystem::Entry> entries;
        double diagonal = 0;
        for (int axis = 2; axis >= 0; --axis) {
            const bool inside = cell[axis] > 0;
            if (inside) entries.emplace_back(i - stride[axis], -1.0);
            if (inside || border == Border::dirichlet) diagonal += 1;
        }
        const auto middle = entries.size();
        for (int axis = 0; axis < 3; ++axis) {
            const bool inside = cell[axis] < n - 1;
            if (inside) entries.emplace_back(i + stride[axis], -1.0);
            if (inside || border == Border::dirichlet) diagonal += 1;
        }
        entries.insert(entries.begin() + static_cast<std::ptrdiff_t>(middle), {i, diagonal});
        return entries;
    };
    return TestSystem(comm, n * n * n, row, owners);
}

double noise(Index row) {
    const auto mixed = static_cast<std::uint32_t>(row + 1) * 2654435761u;
    return static_cast<double>(mixed ^ (mixed >> 13)) / 2147483648.0 - 1.0;
}

double distance(const Comm& comm, const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(comm.sum(sum));
}

void expect_symmetric_and_positive(const Comm& comm, const TestSystem& system,
    const std::function<void(std::span<const double>, std::span<double>)>& apply) {
    const auto u = system.values(noise);
    const auto v = system.values([](Index i) { return noise(7 * i + 3); });
    std::vector<double> mu(u.size()), mv(u.size());
    apply(u, mu);
    apply(v, mv);
    double sums[4] = {};
    for (std::size_t i = 0; i < u.size(); ++i) {
        sums[0] += u[i] * mv[i];
        sums[1] += v[i] * mu[i];
        sums[2] += u[i] * mu[i];
        sums[3] += v[i] * mv[i];
    }
    comm.sum(sums);
    EXPECT_GT(sums[2], 0);
    EXPECT_GT(sums[3], 0);
    // Round-off of a few thousand terms.
    EXPECT_NEAR(sums[0], sums[1], 1e-12 * std::sqrt(sums[2] * sums[3]));
}

} // namespace treacle::solve
