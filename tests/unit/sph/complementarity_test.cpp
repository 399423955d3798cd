#include "parts.hpp"

namespace treacle::sph::complementarity_test {
namespace {

constexpr double dt = 1e-3; // [s]

SphOptions exact(double residual, PressurePreconditioner preconditioner = PressurePreconditioner::multilevel) {
    SphOptions options;
    options.pressure.solver = PressureSolver::isph;
    options.pressure.dirichlet = DirichletRule::complementarity;
    options.pressure.preconditioner = preconditioner;
    options.pressure.stop = StoppingRule::residual;
    options.pressure.residual = residual;
    return options;
}

// A block out of order whose particles move and press at random, with a floor.
Sample block(const SphOptions& options, const std::array<int, 3>& count, std::uint64_t seed) {
    const int dimensions = count[2] > 1 ? 3 : 2;
    const Vec3 size{count[0] * spacing, 2 * count[1] * spacing, count[2] * spacing};
    Sample sample{
        make_setup(make_domain(dimensions, {0, 0, 0}, size, {scene::BoundaryKind::open, {}}), options), {}, {}};
    add_block(sample, {{spacing / 2, spacing / 2, dimensions == 3 ? spacing / 2 : 0}, count, spacing, 0.2, seed});
    for (int i = 0; i < count[0]; ++i) {
        for (int k = 0; k < count[2]; ++k) {
            sample.solid.push_back(
                {{(i + 0.5) * spacing, -0.6 * spacing, dimensions == 3 ? (k + 0.5) * spacing : 0}, 0});
        }
    }
    test::Random random(seed + 100);
    for (auto& point : sample.liquid) {
        for (int k = 0; k < dimensions; ++k) point.u[std::size_t(k)] = 4 * random.unit() - 2;
        point.p = 500 * random.unit();
    }
    return sample;
}

// What a step left: pressures, the gradient of the quadratic form, the sources; by id.
struct Solved {
    std::unique_ptr<IsphStep> step;
    StepReport report;
    std::map<std::int64_t, State> states;
};
Solved step_once(const Comm& comm, const Sample& sample) {
    Solved out{started(comm, sample), {}, {}};
    out.step->start(IsphStep::SolidVolumes::keep); // so that the pressures count as known
    out.report = out.step->advance(dt);
    out.states = all_states(comm, out.step->liquid());
    return out;
}

struct Problem {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd source, pressure;
};
// That of the last step of one rank.
Problem problem_of(const IsphStep& step) {
    const auto& system = step.system();
    Problem out;
    const int n = system.rows();
    out.matrix = Eigen::MatrixXd::Zero(n, n);
    const auto offset = test::on_host(system.own().offset), column = test::on_host(system.own().column);
    const auto value = test::on_host(system.own().value), b = test::on_host(system.right_hand_side());
    const auto x = test::on_host(system.solution());
    out.source.resize(n);
    out.pressure.resize(n);
    for (int r = 0; r < n; ++r) {
        for (int k = offset(r); k < offset(r + 1); ++k) out.matrix(r, column(k)) += value(k);
        out.source(r) = b(r);
        out.pressure(r) = x(r);
    }
    return out;
}

// The solution by testing every set of unknowns.
Eigen::VectorXd search(const Problem& problem) {
    const auto n = problem.source.size();
    const double scale = problem.source.cwiseAbs().maxCoeff();
    for (unsigned set = 0; set < 1u << n; ++set) {
        std::vector<Eigen::Index> rows;
        for (Eigen::Index i = 0; i < n; ++i) {
            if ((set >> i & 1u) != 0) rows.push_back(i);
        }
        Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
        if (!rows.empty()) {
            const Eigen::MatrixXd part = problem.matrix(rows, rows);
            const Eigen::VectorXd right = problem.source(rows), found = part.ldlt().solve(right);
            for (std::size_t k = 0; k < rows.size(); ++k) x(rows[k]) = found(Eigen::Index(k));
        }
        const Eigen::VectorXd gradient = problem.matrix * x - problem.source;
        if (x.minCoeff() >= 0 && gradient.minCoeff() >= -1e-9 * scale) return x;
    }
    ADD_FAILURE() << "no set solves the problem";
    return {};
}

class EachCut : public testing::TestWithParam<PressurePreconditioner> {};
INSTANTIATE_TEST_SUITE_P(all, EachCut,
    testing::Values(PressurePreconditioner::jacobi, PressurePreconditioner::incomplete_cholesky,
        PressurePreconditioner::multilevel),
    [](const auto& info) {
        return std::string(info.param == PressurePreconditioner::jacobi       ? "jacobi"
                           : info.param == PressurePreconditioner::multilevel ? "multilevel"
                                                                              : "cholesky");
    });
} // namespace

TEST_P(EachCut, FindsWhatTryingEverySetFinds) {
    int pressed = 0, all = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const auto solved = step_once(Comm::self(), block(exact(1e-12, GetParam()), {4, 3, 1}, seed));
        const auto problem = problem_of(*solved.step);
        ASSERT_EQ(problem.source.size(), 12); // every particle has a row
        ASSERT_EQ(solved.report.pinned, 0);
        const auto wanted = search(problem);
        EXPECT_LT((problem.pressure - wanted).cwiseAbs().maxCoeff(), 1e-9 * wanted.cwiseAbs().maxCoeff());
        for (const double p : wanted) pressed += static_cast<int>(p > 0);
        all += 12;
        EXPECT_EQ(solved.report.roles.poisson, (wanted.array() > 0).count());
    }
    EXPECT_GT(pressed, all / 5);
    EXPECT_LT(pressed, 4 * all / 5);
}

TEST_P(EachCut, PressuresAreTheSameOnAnyNumberOfRanksAndComplementary) {
    const auto sample = block(exact(1e-11, GetParam()), {12, 8, 6}, 3);
    const auto many = step_once(Comm::world(), sample), one = step_once(Comm::self(), sample);
    double most = 0, scale = 0;
    for (const auto& [id, state] : one.states) {
        EXPECT_GE(state.p, 0);
        most = std::max(most, std::abs(state.p - many.states.at(id).p));
        scale = std::max(scale, state.p);
    }
    EXPECT_LT(most, 1e-8 * scale); // the residual times a condition number of some hundreds
    EXPECT_EQ(many.report.roles.poisson, one.report.roles.poisson);
    EXPECT_EQ(many.report.misclassified, one.report.misclassified);
    EXPECT_GT(one.report.misclassified, 0); // the random pressures that it starts from predict badly
    const auto problem = problem_of(*one.step);
    const Eigen::VectorXd gradient = problem.matrix * problem.pressure - problem.source;
    const double force = problem.source.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < gradient.size(); ++i) {
        EXPECT_GE(gradient(i), -1e-9 * force);
        if (problem.pressure(i) > 0) {
            EXPECT_LT(gradient(i), 1e-9 * force);
        }
    }
}

// A compressed ball in free flight beside liquid that flies apart: the one has no solution unless held, the other is 0.
TEST(Complementarity, ABlobThatNothingAnchorsIsHeldAtOneParticle) {
    const auto comm = Comm::world();
    auto options = exact(1e-10);
    Sample sample{make_setup(make_domain(3, {0, 0, 0}, {32 * spacing, 14 * spacing, 14 * spacing},
                                 {scene::BoundaryKind::open, {}}),
                      options),
        {}, {}};
    add_block(sample, {{6 * spacing, 6 * spacing, 6 * spacing}, {4, 4, 4}, 0.85 * spacing, 0.05});
    const std::size_t first = sample.liquid.size();
    add_block(sample, {{22 * spacing, 5 * spacing, 5 * spacing}, {4, 4, 4}, spacing, 0.05});
    converge(sample, {7.3 * spacing, 7.3 * spacing, 7.3 * spacing}, 30);
    for (std::size_t k = first; k < sample.liquid.size(); ++k) {
        auto& point = sample.liquid[k];
        for (std::size_t c = 0; c < 3; ++c) point.u[c] = 30 * (point.x[c] - (c == 0 ? 23.5 : 6.5) * spacing);
        point.p = 1000; // predicts pressures where there are none
    }
    const auto solved = step_once(comm, sample);
    EXPECT_EQ(solved.report.pinned, 1);
    EXPECT_EQ(solved.report.roles.poisson, 63);
    double most = 0;
    for (std::size_t k = 0; k < sample.liquid.size(); ++k) {
        const double p = solved.states.at(id_of(k)).p;
        if (k >= first) {
            EXPECT_EQ(p, 0);
        }
        most = std::max(most, p);
    }
    // Compressed by less than twice in a step: rho0 (d / dt)^2 is what stops any motion at once.
    EXPECT_LT(most, 20 * rest_density * spacing * spacing / (dt * dt));
    EXPECT_GT(most, 0);
}

namespace {
// 40 x 40 particles out of order in a corner of the plane, with walls; pressures of the depth.
Sample plane(DirichletRule rule) {
    auto options = exact(1e-8);
    options.pressure.dirichlet = rule;
    const int n = 40;
    const auto domain = make_domain(2, {0, 0, 0}, {2 * n * spacing, 1.5 * n * spacing, spacing});
    Sample sample{make_setup(domain, options), {}, {}};
    auto& setup = sample.setup;
    setup.forces.gravity = {0, -9.81, 0};
    setup.reference_speed = std::sqrt(9.81 * n * spacing);
    setup.forces.artificial = 0.2 * setup.constants.support * setup.reference_speed;
    add_block(sample, {{spacing / 2, spacing / 2, 0}, {n, n, 1}, spacing, 0.1});
    const double gap =
        equilibrium_wall_distance({options.kernel, 2, setup.constants.support, spacing, spacing}, options.density);
    const double out = gap - spacing / 2;
    for (int i = -2; i < 2 * n + 2; ++i) sample.solid.push_back({{(i + 0.5) * spacing, -out, 0}, 0});
    for (int k = 0; k < 3 * n / 2; ++k) {
        sample.solid.push_back({{-out, (k + 0.5) * spacing, 0}, 0});
        sample.solid.push_back({{2 * n * spacing + out, (k + 0.5) * spacing, 0}, 1});
    }
    for (auto& point : sample.liquid) point.p = rest_density * 9.81 * (n * spacing - point.x[1]);
    return sample;
}
} // namespace

TEST(Complementarity, ThePredictedRuleIsNearItAndTheSourceRuleIsNot) {
    const auto comm = Comm::world();
    const auto sample = plane(DirichletRule::complementarity);
    IsphStep step(comm, sample.setup);
    put(comm, sample, step.liquid(), step.solid());
    step.start();
    step.start(IsphStep::SolidVolumes::keep);
    std::int64_t predicted = 0, by_source = 0, all = 0;
    double fastest = 0;
    for (int k = 0; k < 40; ++k) {
        const auto report = step.advance(3e-3);
        EXPECT_TRUE(report.lost.empty());
        predicted += report.misclassified;
        all += report.roles.poisson + report.roles.dirichlet;
        const auto& liquid = step.liquid();
        const auto role = test::on_host(liquid.role());
        const auto source = test::on_host(liquid.source()), wall = test::on_host(liquid.wall_term());
        std::int64_t wrong = 0;
        for (int i = 0; i < liquid.store.owned(); ++i) {
            if (wall(i) == 0) wrong += static_cast<std::int64_t>((source(i) > 0) != (role(i) == Role::poisson));
        }
        by_source += comm.sum(wrong);
    }
    for (const auto& [id, state] : all_states(comm, step.liquid())) {
        fastest = std::max(fastest, std::hypot(state.u[0], state.u[1]));
        EXPECT_GE(state.p, 0);
    }
    RecordProperty("predicted [%]", std::to_string(100 * double(predicted) / double(all)));
    RecordProperty("source [%]", std::to_string(100 * double(by_source) / double(all)));
    EXPECT_LE(double(predicted), 0.06 * double(all));
    EXPECT_GT(double(by_source), 3 * double(predicted));
    // It ran for 0.12 s, in which gravity alone gives 1.2 m/s; disorder at the start adds some.
    EXPECT_LT(fastest, 4);
}

} // namespace treacle::sph::complementarity_test
