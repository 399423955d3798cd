#include "viscous_sample.hpp"

namespace treacle::sph::viscous_matrix_test {
namespace {

constexpr ViscosityForm all_forms[] = {ViscosityForm::corrected, ViscosityForm::adjoint, ViscosityForm::pairwise,
    ViscosityForm::laplacian, ViscosityForm::as_published};

// A square without a border, out of order.
Sample periodic_square(ViscosityForm form) {
    const int n = 12;
    SphOptions options;
    options.viscosity.form = form;
    const double size = n * spacing;
    Sample sample{
        make_setup(make_domain(2, {0, 0, 0}, {size, size, spacing}, {scene::BoundaryKind::wall, {true, true, false}}),
            options),
        {}, {}};
    sample.setup.forces.viscosity = viscosity;
    add_block(sample, {{spacing / 2, spacing / 2, 0}, {n, n, 1}, spacing, 0.2});
    return sample;
}

struct Assembled {
    ViscousTest test;
    ViscousOperator of;
    ViscousMatrix matrix;
    int x;

    explicit Assembled(const Sample& sample)
        : test(sample), of(test.parts.liquid),
          matrix(test.parts.comm, test.parts.liquid, sample.setup.options.viscosity),
          x(test.parts.liquid.store.add<Array3>("x", "", FieldRole::work)) {
        const auto all = test.all();
        EXPECT_GT(of.prepare(all, step_of(1, {3, 4, 0.3})), 0);
        matrix.assemble(all, of);
    }
};

// The products of all five forms, with the largest difference over the largest number.
double largest_difference(const Sample& sample) {
    Assembled one(sample);
    auto& parts = one.test.parts;
    const auto& store = parts.liquid.store;
    fill_by_id(parts.liquid, one.x, 5);
    const Array3 product("product", static_cast<std::size_t>(store.total()));
    one.of.multiply(one.test.all(), one.x, ViscousOperator::Walls::resting, product);
    const auto x = on_host(store.get<Array3>(one.x)), free = on_host(product);
    std::vector<double> from(3 * std::size_t(store.owned())), to(from.size());
    for (std::size_t k = 0; k < from.size(); ++k) from[k] = x(k / 3, k % 3);
    one.matrix.matrix()->multiply(from, to);
    double apart = 0, most = 0;
    for (std::size_t k = 0; k < to.size(); ++k) {
        apart = std::max(apart, std::abs(to[k] - free(k / 3, k % 3)));
        most = std::max(most, std::abs(to[k]));
    }
    return parts.comm.max(apart) / parts.comm.max(most);
}

// Largest |C - C^T| over the largest |C|.
double asymmetry(const Sample& sample) {
    Assembled one(sample);
    const auto& comm = one.test.parts.comm;
    const auto& blocks = one.matrix.matrix()->blocks();
    EXPECT_NO_THROW(solve::check_pattern(blocks));
    std::vector<std::int64_t> entries;
    std::vector<double> values;
    const auto enter = [&](solve::Index row, std::int64_t column, double value) {
        entries.push_back(std::int64_t(blocks.first_row + row) * blocks.global_rows + column);
        values.push_back(value);
    };
    for (solve::Index row = 0; row < blocks.rows; ++row) {
        for (auto k = blocks.diagonal_offsets[row]; k < blocks.diagonal_offsets[row + 1]; ++k) {
            enter(row, blocks.first_row + blocks.diagonal_columns[k], blocks.diagonal_values[k]);
        }
        for (auto k = blocks.off_offsets[row]; k < blocks.off_offsets[row + 1]; ++k) {
            enter(row, blocks.halo->columns()[std::size_t(blocks.off_columns[k])], blocks.off_values[k]);
        }
    }
    entries = comm.all_gather(std::span<const std::int64_t>(entries));
    values = comm.all_gather(std::span<const double>(values));
    const Eigen::Index n = blocks.global_rows;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t k = 0; k < values.size(); ++k) matrix(entries[k] / n, entries[k] % n) = values[k];
    return (matrix - matrix.transpose()).cwiseAbs().maxCoeff() / matrix.cwiseAbs().maxCoeff();
}
} // namespace

TEST(ViscousMatrix, IsWhatProductsWithoutAMatrixAre) {
    for (const auto form : all_forms) {
        // Round-off of sums over a thousand triples of particles.
        EXPECT_LT(largest_difference(two_liquids_on_a_wall(form)), 1e-13);
        EXPECT_LT(largest_difference(periodic_square(form)), 1e-13);
    }
}

TEST(ViscousMatrix, SymmetricFormsAreTheirTransposes) {
    double most = 0;
    for (const auto form : every_form) most = std::max(most, asymmetry(two_liquids_on_a_wall(form)));
    RecordProperty("asymmetry", std::to_string(most * 1e15) + "e-15");
    EXPECT_LE(most, 1e-15);
}

TEST(ViscousMatrix, ThePrintedFormIsNotSymmetric) {
    const double printed = asymmetry(two_liquids_on_a_wall(ViscosityForm::as_published));
    RecordProperty("printed", std::to_string(printed));
    EXPECT_GT(printed, 0.01);
}

namespace {
// Velocities after a solve by id, and its report.
std::map<std::int64_t, State> solved(const ViscosityOptions& options, double number, solve::SolveReport& report) {
    const BlobSetup blob{3, 4, 0.3};
    auto sample = turning_blob(blob);
    sample.setup.options.viscosity = options;
    test::Random random(3);
    for (auto& point : sample.liquid) {
        for (double& u : point.u) u = 2 * random.unit() - 1;
    }
    ViscousCase one(sample);
    report = one.solve(step_of(number, blob)).solve;
    return all_states(one.parts.comm, one.parts.liquid);
}

double largest_difference(const std::map<std::int64_t, State>& one, const std::map<std::int64_t, State>& other) {
    double most = 0;
    for (const auto& [id, state] : one) {
        for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::abs(state.u[k] - other.at(id).u[k]));
    }
    return most;
}
} // namespace

TEST(ViscousMatrix, GivesTheSameVelocitiesWithEveryPreconditioner) {
    ViscosityOptions options;
    options.form = ViscosityForm::adjoint;
    options.residual = 1e-10;
    solve::SolveReport report;
    const auto free = solved(options, 1, report);
    ASSERT_TRUE(report.converged()) << report.reason;
    options.assembled = true;
    for (const auto preconditioner : {ViscosityPreconditioner::jacobi, ViscosityPreconditioner::multilevel,
             ViscosityPreconditioner::gamg, ViscosityPreconditioner::boomeramg}) {
        options.preconditioner = preconditioner;
        const auto found = solved(options, 1, report);
        ASSERT_TRUE(report.converged()) << report.reason;
        // The residual times the largest condition of a system whose smallest eigenvalue is 1.
        EXPECT_LT(largest_difference(free, found), 1e-8);
    }
}

TEST(ViscousMatrix, BicgstabSolvesThePrintedFormAndConjugateGradientsSayThatTheyCannot) {
    ViscosityOptions options;
    options.form = ViscosityForm::as_published;
    options.assembled = true;
    options.preconditioner = ViscosityPreconditioner::jacobi;
    options.residual = 1e-6;
    options.max_iterations = 500;
    solve::SolveReport report;
    options.solver = ViscositySolver::bicgstab;
    solved(options, 0.1, report);
    EXPECT_TRUE(report.converged()) << report.reason;
    EXPECT_LE(report.relative_residual, 1e-6);
    options.solver = ViscositySolver::conjugate_gradients;
    solved(options, 100, report);
    EXPECT_FALSE(report.converged());
    EXPECT_FALSE(report.reason.empty());
}

} // namespace treacle::sph::viscous_matrix_test
