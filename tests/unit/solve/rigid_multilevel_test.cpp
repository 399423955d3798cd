#include "fixture.hpp"
#include "solve/krylov/krylov.hpp"
#include "solve/multigrid/rigid_multilevel.hpp"

#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace treacle::solve::rigid_multilevel_test {
namespace {

// Springs between the corners of n^3 cubes, stiff along the edges and the diagonals of faces, with little mass: three rows
// a corner, one for each component. Free: a rigid motion strains nothing.
struct Springs {
    int n;
    double stiffness;

    std::array<int, 3> corner(Index i) const { return {int(i % n), int(i / n % n), int(i / (n * n))}; }
    std::vector<TestSystem::Entry> row(Index row) const {
        const auto here = corner(row / 3);
        const auto a = static_cast<std::size_t>(row % 3);
        std::array<double, 3> own{};
        own[a] = 1;
        std::vector<TestSystem::Entry> out;
        for (int k = 0; k < 27; ++k) {
            const std::array<int, 3> d{k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
            const int length = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            if (length == 0) { // its place among the columns
                for (std::size_t b = 0; b < 3; ++b) out.emplace_back(row - row % 3 + Index(b), 0.0);
                continue;
            }
            bool inside = length < 3;
            Index other = 0;
            for (std::size_t axis = 3; axis-- > 0;) {
                const int x = here[axis] + d[axis];
                inside = inside && x >= 0 && x < n;
                other = other * n + x;
            }
            if (!inside) continue;
            for (std::size_t b = 0; b < 3; ++b) {
                const double entry = stiffness * d[a] * d[b] / length;
                own[b] += entry;
                out.emplace_back(3 * other + Index(b), -entry);
            }
        }
        for (auto& [column, value] : out) {
            if (column / 3 == row / 3) value = own[static_cast<std::size_t>(column % 3)];
        }
        return out;
    }
};

struct Sample {
    Comm comm;
    Springs springs;
    TestSystem system;
    RigidMultilevel multilevel;
    std::vector<int> cells;
    std::vector<double> positions;
    std::vector<signed char> axes;
    std::vector<unsigned char> aside;

    Sample(const Comm& group, int n, double stiffness, RigidMultilevelOptions options, int owners = 1 << 20)
        : comm(group), springs{n, stiffness},
          system(
              group, 3 * n * n * n, [s = springs](Index row) { return s.row(row); }, owners),
          multilevel(group, options) {
        for (Index i = system.first; i < system.first + system.rows; ++i) {
            for (const int x : springs.corner(i / 3)) {
                cells.push_back(x);
                positions.push_back(0.1 * x);
            }
            axes.push_back(static_cast<signed char>(i % 3));
        }
    }
    VelocityRows rows() const { return {3, 0.1, cells, positions, axes, aside}; }
    int iterations() {
        Matrix a(comm, system.blocks());
        KrylovOptions options;
        options.user.apply = [this](std::span<const double> r, std::span<double> z) { multilevel.apply(r, z); };
        options.user.set_up = [this](Matrix& matrix) { multilevel.set_up(matrix, rows()); };
        KrylovSolver solver(comm, "test", options);
        const auto b = system.product(noise);
        std::vector<double> x(b.size(), 0.0);
        const auto report = solver.solve(a, b, x, ConvergenceTest::residual(1e-8));
        EXPECT_TRUE(report.converged()) << report.reason;
        return report.iterations;
    }
};

RigidMultilevelOptions several_levels() {
    RigidMultilevelOptions options;
    options.box = 2;
    options.max_coarse_size = 30;
    options.min_rows_per_rank = 60;
    return options;
}

class RigidMultilevelTest : public ::testing::Test {
protected:
    const Comm comm = (runtime(), Comm::world());
};

TEST_F(RigidMultilevelTest, is_symmetric_and_positive) {
    for (const int owners : {1, 2, 1 << 20}) {
        Sample sample(comm, 9, 1e3, several_levels(), owners);
        Matrix a(comm, sample.system.blocks());
        sample.multilevel.set_up(a, sample.rows());
        EXPECT_GE(sample.multilevel.sizes().size(), 3u);
        expect_symmetric_and_positive(comm, sample.system, [&](auto r, auto z) { sample.multilevel.apply(r, z); });
    }
}

TEST_F(RigidMultilevelTest, iterations_hardly_depend_on_stiffness_or_size) {
    for (const int n : {8, 16}) {
        for (const double stiffness : {1.0, 1e3, 1e6}) {
            Sample sample(comm, n, stiffness, {}); // 18 to 20 on one rank, up to 29 where ranks cut layers of corners
            EXPECT_LE(sample.iterations(), 30) << n << " " << stiffness;
        }
    }
}

TEST_F(RigidMultilevelTest, takes_rows_aside_and_aggregates_of_few_rows) {
    Sample sample(comm, 8, 1e4, several_levels());
    for (std::size_t i = 0; i < sample.axes.size(); ++i) {
        // One component left alone in its box, and a whole layer of rows that only the sweeps change.
        sample.aside.push_back(sample.cells[3 * i] == 3 || (sample.cells[3 * i + 1] == 7 && sample.axes[i] != 1));
    }
    EXPECT_LE(sample.iterations(), 80); // 55 to 65
}

TEST_F(RigidMultilevelTest, keeps_its_memory_from_one_matrix_to_the_next) {
    Sample sample(comm, 10, 10, several_levels());
    Matrix a(comm, sample.system.blocks());
    sample.multilevel.set_up(a, sample.rows());
    const auto bytes = sample.multilevel.bytes();
    a.values_changed();
    sample.multilevel.set_up(a, sample.rows());
    EXPECT_LE(sample.multilevel.bytes(), bytes + bytes / 50); // arrays of a swap may come to rest in another place
}

} // namespace
} // namespace treacle::solve::rigid_multilevel_test
