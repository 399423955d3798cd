#include "change.hpp"

#include <stdexcept>

namespace treacle::sph::mixture_test {
namespace {

constexpr double dt = 1e-3;         // [s]
constexpr double ratio = 10;        // of the densities
constexpr double tolerance = 1e-12; // round-off of some thousand pair forces of the sum of their sizes

const std::vector<LiquidMaterial> materials{{rest_density, 0.5}, {rest_density / ratio, 0.02}, {3 * rest_density, 2}};

double density_of(int liquid) { return materials[std::size_t(liquid)].density / rest_density; }

// A jittered block across ranks, of three liquids side by side, in random motion under random pressures; a floor and
// a body of solid particles in it.
Sample layers(const std::vector<LiquidMaterial>& liquids, const SphOptions& options = {}, double jitter = 0.25) {
    const Vec3 size{12 * spacing, 8 * spacing, 7 * spacing};
    Sample sample{
        make_setup(make_domain(3, {0, 0, 0}, size, {scene::BoundaryKind::open, {false, false, false}}), options), {},
        {}};
    add_block(sample, {{spacing / 2, spacing / 2, spacing / 2}, {12, 8, 7}, spacing, jitter});
    std::erase_if(sample.liquid, [](const auto& point) {
        return point.x[0] > 5.9 * spacing && point.x[0] < 8.1 * spacing && point.x[1] < 2.1 * spacing;
    });
    add_shell(sample, {6.5 * spacing, 0.8 * spacing, 2 * spacing}, {2, 2, 3}, 1);
    for (int j = 0; j < 8; ++j) {
        for (int i = 0; i < 12; ++i)
            sample.solid.push_back({{(i + .5) * spacing, (j + .5) * spacing, -0.6 * spacing}, 0});
    }
    test::Random random(9);
    for (auto& point : sample.liquid) {
        for (double& u : point.u) u = 8 * random.unit() - 4;
        point.p = 500 * random.unit();
        point.liquid = static_cast<int>(point.x[2] / (2.4 * spacing)) % static_cast<int>(liquids.size());
    }
    sample.setup.constants.immiscible = make_immiscible_liquids(liquids);
    sample.setup.forces.friction = {1, 0.5};
    return sample;
}

std::unique_ptr<Parts> assembled(const Comm& comm, const Sample& sample) {
    auto parts = std::make_unique<Parts>(comm, sample);
    parts->predict_roles(LastPressures::known, dt);
    parts->anchor();
    parts->assemble();
    return parts;
}

void expect_no_change(const Change& sum, const BodyLoads& loads, double step) {
    ASSERT_GT(sum.size, 0);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(sum.momentum[k] + step * (loads[k] + loads[6 + k]), 0, tolerance * sum.size);
        EXPECT_NEAR(sum.angular[k] + step * (loads[3 + k] + loads[9 + k]), 0, tolerance * sum.size);
    }
}

} // namespace

TEST(ImmiscibleLiquids, NeedsLiquids) { EXPECT_THROW(make_immiscible_liquids({}), std::invalid_argument); }

TEST(ImmiscibleLiquids, PairsFeelTheHarmonicMeanOfTheViscositiesAndNoneBesideAnInviscidLiquid) {
    EXPECT_NEAR(largest_kinematic_viscosity(std::vector<LiquidMaterial>{{1000, 1}, {100, 0}}), 1e-3, 1e-18);
    // Of the light one beside the heavy one, 2 * 1 * 3 / 4 Pa s over 100 kg/m3.
    EXPECT_NEAR(largest_kinematic_viscosity(std::vector<LiquidMaterial>{{1000, 3}, {100, 1}}), 0.015, 1e-15);
}

TEST(ImmiscibleLiquids, HasAMatrixThatIsSymmetricBitForBitAndTheSameOnAnyNumberOfRanks) {
    for (const auto term : {SolidTerm::decomposed, SolidTerm::unified, SolidTerm::exact}) {
        SphOptions options;
        options.pressure.solid_term = term;
        const auto sample = layers(materials, options);
        const auto many = gather_system(*assembled(Comm::world(), sample));
        const auto one = gather_system(*assembled(Comm::self(), sample));
        ASSERT_GT(many.ids.size(), 30u);
        EXPECT_EQ((many.matrix - many.matrix.transpose()).cwiseAbs().maxCoeff(), 0);
        ASSERT_EQ(many.ids, one.ids);
        EXPECT_EQ((many.matrix - one.matrix).cwiseAbs().maxCoeff(), 0);
        EXPECT_EQ((many.right_hand_side - one.right_hand_side).cwiseAbs().maxCoeff(), 0);
        const auto values =
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(one.matrix, Eigen::EigenvaluesOnly).eigenvalues();
        EXPECT_GT(values(0), 1e-7 * values(values.size() - 1)); // round-off of a singular one is 1e-16
    }
}

TEST(ImmiscibleLiquids, CouplesPressuresByTheMeanDensityOfAPair) {
    const auto sample = layers(materials);
    auto single = sample;
    single.setup.constants.immiscible = {};
    const auto rows_of = [](Parts& parts) { // all of them, whatever their roles
        parts.predict_roles(LastPressures::known, dt);
        parts.set_by_id(parts.liquid.role(), [](std::int64_t) { return Role::poisson; });
        parts.halo.gather(parts.liquid.store, {parts.liquid.role_field()});
        parts.assemble();
        return gather_system(parts);
    };
    Parts parts(Comm::world(), sample), reference(Comm::world(), single);
    const auto several = rows_of(parts), one = rows_of(reference);
    const auto liquid = by_id(parts.comm, parts.liquid, parts.liquid.liquid());
    ASSERT_EQ(several.ids, one.ids);
    for (Eigen::Index i = 0; i < several.matrix.rows(); ++i) {
        for (Eigen::Index j = 0; j < i; ++j) {
            const double s = density_of(static_cast<int>(liquid.at(several.ids[std::size_t(i)]))),
                         t = density_of(static_cast<int>(liquid.at(several.ids[std::size_t(j)])));
            ASSERT_NEAR(several.matrix(i, j), one.matrix(i, j) * 2 / (s + t), 1e-14 * std::abs(one.matrix(i, j)) * 10);
        }
    }
}

TEST(ImmiscibleLiquids, PressuresExchangeEqualForcesAndTorquesBetweenLiquidsAndSolids) {
    const auto sample = layers(materials);
    Parts parts(Comm::world(), sample);
    const auto before = all_states(parts.comm, parts.liquid);
    const auto loads = parts.push(dt);
    expect_no_change(change(parts, before, density_of), loads, dt);
}

TEST(ImmiscibleLiquids, ViscousForcesCancelAndTakeEnergy) {
    auto sample = layers(materials);
    sample.setup.forces.viscosity = rest_density * largest_kinematic_viscosity(materials);
    sample.setup.forces.artificial = 0.02;
    Parts parts(Comm::world(), sample);
    const auto before = all_states(parts.comm, parts.liquid);
    const double energy =
        measure_totals(parts.comm, parts.liquid, parts.setup.constants, {0, 0, 0}, parts.liquid.velocity())
            .kinetic_energy;
    const double step = 0.1 * viscous_step_limit(parts.setup.constants, sample.setup.forces.viscosity);
    auto loads = apply_forces(parts.step(), parts.setup.forces, step, parts.setup.bodies);
    parts.comm.sum(std::span(loads));
    expect_no_change(change(parts, before, density_of), loads, step);
    EXPECT_LT(measure_totals(parts.comm, parts.liquid, parts.setup.constants, {0, 0, 0}, parts.liquid.velocity())
                  .kinetic_energy,
        energy);
}

TEST(ImmiscibleLiquids, XsphMovesNoMomentum) {
    auto sample = layers(materials);
    sample.setup.options.viscosity.xsph = 0.3;
    Parts parts(Comm::world(), sample);
    compute_xsph(parts.setup.options, parts.setup.constants, parts.liquid, parts.solid, parts.neighbours);
    const auto c = test::on_host(parts.liquid.acceleration());
    const auto liquid = test::on_host(parts.liquid.liquid());
    double sum[4] = {0, 0, 0, 0};
    for (int i = 0; i < parts.liquid.store.owned(); ++i) {
        for (int k = 0; k < 3; ++k) {
            sum[k] += density_of(liquid(i)) * c(i, k);
            sum[3] += density_of(liquid(i)) * std::abs(c(i, k));
        }
    }
    parts.comm.sum(std::span<double>(sum));
    ASSERT_GT(sum[3], 1);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum[k], 0, tolerance * sum[3]);
}

TEST(ImmiscibleLiquids, OfEqualLiquidsIsOneLiquid) {
    auto sample = layers({{rest_density, 0.5}, {rest_density, 0.5}});
    sample.setup.forces.viscosity = 0.5;
    auto single = sample;
    single.setup.constants.immiscible = {};
    Parts several(Comm::world(), sample), one(Comm::world(), single);
    for (auto* parts : {&several, &one}) {
        apply_forces(parts->step(), parts->setup.forces, dt, parts->setup.bodies);
        parts->push(dt);
        parts->halo.gather(parts->liquid.store, {parts->liquid.velocity_field()});
        parts->predict_roles(LastPressures::known, dt);
        parts->anchor();
        parts->assemble();
    }
    const auto a = all_states(several.comm, several.liquid), b = all_states(one.comm, one.liquid);
    for (const auto& [id, state] : a) {
        for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(state.u[k], b.at(id).u[k], 1e-13 * 8);
    }
    const auto x = gather_system(several), y = gather_system(one);
    ASSERT_EQ(x.ids, y.ids);
    EXPECT_LT((x.matrix - y.matrix).cwiseAbs().maxCoeff(), 1e-14 * y.matrix.cwiseAbs().maxCoeff());
}

TEST(ImmiscibleLiquids, DensitiesKnowNothingOfTheWeightOfNeighbours) {
    auto sample = layers(materials);
    auto single = sample;
    single.setup.constants.immiscible = {};
    const Parts several(Comm::world(), sample), one(Comm::world(), single);
    const auto rho = by_id(several.comm, several.liquid, several.liquid.density());
    const auto reference = by_id(one.comm, one.liquid, one.liquid.density());
    const auto liquid = by_id(several.comm, several.liquid, several.liquid.liquid());
    for (const auto& [id, value] : rho) {
        ASSERT_DOUBLE_EQ(value, density_of(static_cast<int>(liquid.at(id))) * reference.at(id));
    }
}

TEST(ImmiscibleLiquids, KeepsItsMomentumThroughSteps) {
    SphOptions options;
    options.pressure.solver = PressureSolver::isph;
    options.pressure.stop = StoppingRule::residual;
    options.pressure.residual = 1e-8;
    auto sample = layers(materials, options, 0.05);
    sample.solid.clear();
    for (auto& point : sample.liquid) {
        for (std::size_t k = 0; k < 3; ++k) point.u[k] = 0.1 * point.u[k] - 2 * (point.x[k] - 4 * spacing);
    }
    sample.setup.domain =
        make_domain_box(make_domain(3, {-1, -1, -1}, {2, 2, 2}, {scene::BoundaryKind::open, {}}), spacing);
    sample.setup.grid = make_cell_grid(
        make_domain(3, {-1, -1, -1}, {2, 2, 2}, {scene::BoundaryKind::open, {}}), sample.setup.constants.support);
    sample.setup.forces.artificial = 0.02;
    sample.setup.forces.viscosity = rest_density * largest_kinematic_viscosity(materials);
    IsphStep step(Comm::world(), sample.setup);
    put(step.comm(), sample, step.liquid(), step.solid());
    step.start();
    const auto totals = [&] { return step.totals(); };
    const auto before = totals();
    std::int64_t pressed = 0;
    for (int k = 0; k < 10; ++k) pressed += step.advance(5e-4).roles.poisson;
    EXPECT_GT(pressed, 500) << "pressures act";
    const auto after = totals();
    const double size = after.mass * after.max_speed; // round-off of ten steps
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(after.momentum[k], before.momentum[k], tolerance * size);
        EXPECT_NEAR(after.angular_momentum[k], before.angular_momentum[k], tolerance * size);
    }
}

} // namespace treacle::sph::mixture_test
