#include "sample.hpp"
#include "solver_environment.hpp"

namespace treacle::sph::inflow_test {
namespace {

[[maybe_unused]] const auto* const environment = testing::AddGlobalTestEnvironment(new SolverEnvironment);

constexpr double dt = 0.01;   // [s]
constexpr double speed = 2.5; // [m/s]: 0.4 spacings a step

flow::InletSetup square_inlet(const Vec3& centre, const Vec3& direction, int across, int dimensions) {
    flow::InletSetup inlet;
    inlet.centre = centre;
    inlet.direction = direction;
    const Vec3 first{direction[2], direction[0], direction[1]}, second{direction[1], direction[2], direction[0]};
    for (int j = 0; j < (dimensions == 3 ? across : 1); ++j) {
        for (int i = 0; i < across; ++i) {
            const double a = (i - 0.5 * (across - 1)) * spacing,
                         b = dimensions == 3 ? (j - 0.5 * (across - 1)) * spacing : 0;
            Vec3 point;
            for (std::size_t k = 0; k < 3; ++k) point[k] = a * first[k] + b * second[k];
            inlet.points.push_back(point);
        }
    }
    inlet.speed = speed;
    return inlet;
}

// An empty space of 24 spacings with a jet from its middle along +x.
Sample jet() {
    const double size = 24 * spacing;
    SphOptions options;
    options.pressure.stop = StoppingRule::residual;
    options.pressure.residual = 1e-12;
    Sample sample{
        make_setup(make_domain(3, {0, 0, 0}, {size, size, size}, {.kind = scene::BoundaryKind::open}), options), {},
        {}};
    sample.setup.inflow.inlets = {square_inlet({8 * spacing, size / 2, size / 2}, {1, 0, 0}, 4, 3)};
    sample.setup.inflow.first_id = 1000;
    return sample;
}

std::int64_t particles(const IsphStep& step) {
    return step.comm().sum(static_cast<std::int64_t>(step.liquid().store.owned()));
}
} // namespace

TEST(Inflow, LayersFollowFromTheTimeAlone) {
    auto setup = jet().setup;
    auto inlet = setup.inflow.inlets.front();
    inlet.start = 1;
    const int prescribed = buffer_layers(setup.constants);
    const auto passed = [&](double layers) {
        return inlet.start + layers * spacing / speed;
    }; // half of them and a half
    EXPECT_EQ(layers_until(inlet, layers_of(setup.constants), 0.99), 0);
    EXPECT_EQ(layers_until(inlet, layers_of(setup.constants), 1), prescribed);
    EXPECT_EQ(layers_until(inlet, layers_of(setup.constants), passed(0.49)), prescribed);
    EXPECT_EQ(layers_until(inlet, layers_of(setup.constants), passed(0.51)), prescribed + 1);
    inlet.end = passed(40);
    EXPECT_EQ(layers_until(inlet, layers_of(setup.constants), passed(39)),
        40); // those that have yet to pass it are there already
    EXPECT_EQ(layers_until(inlet, layers_of(setup.constants), passed(1e6)), 40);
}

TEST(Inflow, AJetWithoutForcesStaysTheLatticeAtItsSpeed) {
    const auto sample = jet();
    const auto comm = Comm::world();
    const auto step = started(comm, sample);
    double time = 0;
    for (int k = 0; k < 20; ++k) {
        const double part = dt * (k % 3 == 0 ? 0.5 : 1); // steps that differ
        const auto report = step->advance(part);
        time += part;
        EXPECT_LT(report.max_compression, 1e-12);
    }
    const auto& setup = sample.setup;
    const auto layers =
        layers_until(setup.inflow.inlets[0], layers_of(setup.constants), time - dt); // made when the last step began
    EXPECT_EQ(step->emitted(), 16 * layers);
    EXPECT_EQ(particles(*step), 16 * layers);
    for (const auto& [id, state] : all_states(comm, step->liquid())) {
        const auto layer = (id - 1000) / 16;
        EXPECT_NEAR(state.x[0], 8 * spacing + speed * time - (double(layer) + 0.5) * spacing, 1e-12);
        EXPECT_NEAR(state.u[0], speed, 1e-12);
        EXPECT_NEAR(state.u[1], 0, 1e-12);
        EXPECT_NEAR(state.u[2], 0, 1e-12);
    }
    const auto inlet = by_id(comm, step->liquid(), step->liquid().inlet());
    for (const auto& [id, state] : all_states(comm, step->liquid())) {
        EXPECT_EQ(inlet.at(id), state.x[0] < 8 * spacing ? 1 : 0);
    }
}

TEST(Inflow, ItsVolumeInTheLongRunIsTheFlowRate) {
    auto sample = jet();
    const auto& c = sample.setup.constants;
    const auto& inlet = sample.setup.inflow.inlets[0];
    const double rate = inlet.speed * double(inlet.points.size()) * c.rest_volume / c.spacing;
    const double time = 1234.567;
    const double passed = double(layers_until(inlet, layers_of(c), time) - buffer_layers(c)) *
                          double(inlet.points.size()) * c.rest_volume;
    // Half a layer at each end.
    EXPECT_NEAR(passed, rate * time, double(inlet.points.size()) * c.rest_volume);
}

// A stiff rope hangs from its inlet: where its weight would make it fall at g t, it keeps the inlet's speed
// but for what it strains by, rho g L^2 / (4 mu) in the plane.
TEST(Inflow, HeldParticlesCarryAStiffRope) {
    for (const auto preconditioner : {ViscosityPreconditioner::jacobi, ViscosityPreconditioner::multilevel}) {
        const double size = 24 * spacing, viscosity = 1e5, falling = 0.3; // which is no number of single precision
        SphOptions options;
        options.viscosity.integration = ViscosityIntegration::implicit;
        options.viscosity.residual = 1e-10;
        options.viscosity.preconditioner = preconditioner;
        Sample sample{
            make_setup(make_domain(2, {0, 0, 0}, {size, size, 0}, {.kind = scene::BoundaryKind::open}), options), {},
            {}};
        sample.setup.inflow.inlets = {square_inlet({size / 2, 18 * spacing, 0}, {0, -1, 0}, 6, 2)};
        sample.setup.inflow.inlets[0].speed = falling;
        sample.setup.forces.gravity = {0, -9.81, 0};
        sample.setup.forces.viscosity = viscosity;
        const auto comm = Comm::world();
        const auto step = started(comm, sample);
        const int steps = 100;
        for (int k = 0; k < steps; ++k) {
            const auto report = step->advance(dt);
            EXPECT_TRUE(report.viscosity.converged());
        }
        const auto inlet = by_id(comm, step->liquid(), step->liquid().inlet());
        const double length = falling * steps * dt, strained = rest_density * 9.81 * length * length / (4 * viscosity);
        int prescribed = 0, hanging = 0;
        for (const auto& [id, state] : all_states(comm, step->liquid())) {
            if (inlet.at(id) > 0) {
                EXPECT_EQ(state.u[1], -falling);
                EXPECT_EQ(state.u[0], 0);
                ++prescribed;
            } else {
                EXPECT_NEAR(state.u[1], -falling, 4 * strained + 1e-6); // 4: fewer neighbours at the sides
                ++hanging;
            }
        }
        EXPECT_GT(prescribed, 0);
        EXPECT_GT(hanging, 20);
        EXPECT_LT(4 * strained, 0.05); // or the test would measure no difference to 9.81 m/s2 in 0.6 s
    }
}

TEST(Inflow, TwoJetsThatMeetAreTheSameOnAnyNumberOfRanks) {
    auto sample = jet();
    auto& inlets = sample.setup.inflow.inlets;
    inlets[0].end = 0.1;
    inlets.push_back(square_inlet({12 * spacing, 16 * spacing, 12 * spacing}, {0, -1, 0}, 3, 3));
    inlets[1].start = 0.025;
    sample.setup.options.viscosity.integration = ViscosityIntegration::implicit;
    sample.setup.options.viscosity.residual = 1e-12;
    sample.setup.forces.viscosity = 20;
    sample.setup.forces.gravity = {0, 0, -9.81};
    const auto run = [&](const Comm& comm) {
        const auto step = started(comm, sample);
        for (int k = 0; k < 25; ++k) step->advance(dt);
        return all_states(comm, step->liquid());
    };
    const auto many = run(Comm::world()), one = run(Comm::self());
    ASSERT_EQ(many.size(), one.size());
    // The solvers leave 1e-12; collisions amplify it, by less than 1e5 in 25 steps.
    for (const auto& [id, state] : one) {
        ASSERT_EQ(many.count(id), 1u);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(many.at(id).x[k], state.x[k], 1e-7 * spacing);
    }
}

TEST(Outflow, OutletsTakeOutAndCountWhatIsInThem) {
    auto sample = jet();
    sample.setup.inflow.inlets.clear();
    sample.setup.inflow.outlets = {{.box = true, .min = {0, 0, 0}, .max = {4 * spacing, 4 * spacing, 4 * spacing}},
        {.box = false, .point = {20 * spacing, 0, 0}, .normal = {-1, 0, 0}}};
    for (int i = 0; i < 6; ++i) sample.liquid.push_back({{(4 * i + 1) * spacing, spacing, spacing}});
    sample.liquid[4].u = {4 * spacing / dt, 0, 0}; // into the half space; the sixth one is there already
    const auto comm = Comm::world();
    const auto step = started(comm, sample);
    const auto report = step->advance(dt);
    EXPECT_EQ(report.lost_by_cause, (std::array<std::int64_t, loss_causes>{3}));
    EXPECT_EQ(comm.sum(std::int64_t(report.lost.size())), 0);
    const auto left = all_states(comm, step->liquid());
    EXPECT_EQ(left.size(), 3u);
    for (const std::size_t gone : {0, 4, 5}) EXPECT_EQ(left.count(id_of(gone)), 0u);
}

} // namespace treacle::sph::inflow_test
