#include "change.hpp"
#include "viscous_sample.hpp"

namespace treacle::sph::viscosity_test {
namespace {

// Angular momentum after a step of dt over that before.
double kept_spin(const BlobSetup& blob, double dt) {
    ViscousCase one(turning_blob(blob));
    const auto spin = [&] {
        double sum = 0;
        const double middle = (blob.radius + 2) * spacing;
        for (const auto& [id, now] : all_states(one.parts.comm, one.parts.liquid)) {
            sum += (now.x[0] - middle) * now.u[1] - (now.x[1] - middle) * now.u[0];
        }
        return sum;
    };
    const double before = spin();
    const auto result = one.solve(dt);
    EXPECT_TRUE(result.solve.converged()) << result.solve.reason;
    return spin() / before;
}
} // namespace

TEST(ImplicitViscosity, CorrectedFormKeepsRigidRotationOfDiscAndBall) {
    double lost = 0;
    for (const int dimensions : {2, 3}) {
        for (const double jitter : {0.0, 0.2}) {
            const BlobSetup blob{dimensions, dimensions == 2 ? 12.0 : 5.0, jitter, ViscosityForm::corrected};
            for (const double number : {0.1, 1.0, 100.0}) {
                lost = std::max(lost, std::abs(kept_spin(blob, step_of(number, blob)) - 1));
            }
        }
    }
    RecordProperty("rotation_lost", std::to_string(lost * 1e16) + "e-16");
    EXPECT_LT(lost, 1e-10);
}

namespace {
// Row by row, those of `pairs` within the support, in their order.
void expect_near_pairs(const NeighbourList& near, const Pairs& pairs, int rows, double support) {
    std::vector<int> expected;
    for (int i = 0; i < rows; ++i) {
        expected.clear();
        pairs.each(i, [&](int j, double, double, double, double r2) {
            if (std::sqrt(r2) < support) expected.push_back(j);
        });
        const std::vector<int> kept(near.index.data() + near.offset(i), near.index.data() + near.offset(i + 1));
        ASSERT_EQ(kept, expected) << "row " << i;
    }
}
} // namespace

TEST(NearPairs, AreThoseWithinTheSupportOfTheViscousSums) {
    for (const auto form : {ViscosityForm::corrected, ViscosityForm::adjoint}) {
        ViscousCase one(two_liquids_on_a_wall(form));
        const auto scene = one.scene();
        NearPairs near;
        const auto narrow = near.among(scene);
        const double support = viscous_support(scene.options, spacing);
        EXPECT_EQ(narrow.constants.support, support);
        EXPECT_EQ(support, form == ViscosityForm::corrected ? 2.2 * spacing : scene.constants.support);
        const auto& liquid = scene.liquid.store;
        const auto& all = scene.neighbours;
        expect_near_pairs(narrow.neighbours.liquid, pairs(all.liquid, liquid, liquid), liquid.owned(), support);
        expect_near_pairs(
            narrow.neighbours.solid, pairs(all.solid, liquid, scene.solid.store), liquid.owned(), support);
        EXPECT_EQ(narrow.neighbours.liquid.size < all.liquid.size, form == ViscosityForm::corrected);
    }
}

namespace {
// The error is of first order: a surface is known to a share of a spacing.
void expect_heat_equation(double disc_radius, double ball_radius, double tolerance) {
    const BlobSetup disc{2, disc_radius, 0, ViscosityForm::laplacian},
        ball{3, ball_radius, 0, ViscosityForm::laplacian};
    const auto check = [&](const char* name, const BlobSetup& blob, double number, double exact) {
        const double kept = kept_spin(blob, step_of(number, blob));
        testing::Test::RecordProperty(name, std::to_string(kept));
        EXPECT_NEAR(kept, exact, tolerance * exact) << name;
    };
    check("disc_01", disc, 0.1, 0.740);
    check("disc_1", disc, 1, 0.225);
    check("disc_100", disc, 100, 0.00291);
    check("ball_01", ball, 0.1, 0.69226);
    check("ball_1", ball, 1, 0.18575);
}
} // namespace

TEST(ImplicitViscosity, LaplacianFormStopsADiscAndABallAsTheHeatEquationDoes) { expect_heat_equation(24, 10, 0.1); }

// Half a minute: for tools/claims.
TEST(ImplicitViscosity, DISABLED_LaplacianFormStopsFineDiscsAndBallsAsTheHeatEquationDoes) {
    expect_heat_equation(64, 24, 0.05);
}

namespace {
// Of u_x = sin k y in a square without a border: what an implicit step leaves of it, as a share of nu k^2.
double shear_rate(double jitter) {
    const int n = 32;
    const double size = n * spacing, k = 2 * math::pi / size;
    SphOptions options;
    options.viscosity.residual = 1e-10;
    Sample sample{
        make_setup(make_domain(2, {0, 0, 0}, {size, size, spacing}, {scene::BoundaryKind::wall, {true, true, false}}),
            options),
        {}, {}};
    sample.setup.forces.viscosity = viscosity;
    add_block(sample, {{spacing / 2, spacing / 2, 0}, {n, n, 1}, spacing, jitter});
    for (auto& point : sample.liquid) point.u = {std::sin(k * point.x[1]), 0, 0};
    ViscousCase one(sample);
    const double wanted = 1; // nu k^2 dt
    EXPECT_TRUE(one.solve(wanted * rest_density / (viscosity * k * k)).solve.converged());
    double before = 0, after = 0;
    for (const auto& [id, now] : all_states(one.parts.comm, one.parts.liquid)) {
        before += std::sin(k * now.x[1]) * std::sin(k * now.x[1]);
        after += std::sin(k * now.x[1]) * now.u[0];
    }
    return (before / after - 1) / wanted;
}
} // namespace

TEST(ImplicitViscosity, ShearWaveDecaysAtNuKSquared) {
    const double lattice = shear_rate(0), disordered = shear_rate(0.1);
    RecordProperty("lattice", std::to_string(lattice));
    RecordProperty("disordered", std::to_string(disordered));
    EXPECT_NEAR(lattice, 1, 0.02); // second order: (k h)^2 is 0.24
    // Disordered particles yield to the stress between them: seen 0.976, 0.956, 0.886 at 0.05, 0.1, 0.2.
    EXPECT_NEAR(disordered, 1, 0.05);
}

TEST(ImplicitViscosity, EveryFormIsSymmetricAndPositiveWithWallsAndTwoLiquids) {
    for (const auto form : every_form) {
        ViscousTest one(two_liquids_on_a_wall(form));
        auto& parts = one.parts;
        const auto x = parts.liquid.store.add<Array3>("x", "", FieldRole::work);
        const auto y = parts.liquid.store.add<Array3>("y", "", FieldRole::work);
        ViscousOperator matrix(parts.liquid);
        const auto all = one.all();
        ASSERT_GT(matrix.prepare(all, step_of(1, {3, 4, 0.3, form})), 0);
        fill_by_id(parts.liquid, x, 5);
        fill_by_id(parts.liquid, y, 11);
        const auto rows = parts.liquid.store.total();
        const Array3 cx("cx", rows), cy("cy", rows);
        matrix.multiply(all, x, ViscousOperator::Walls::resting, cx);
        matrix.multiply(all, y, ViscousOperator::Walls::resting, cy);
        const auto product = [&](const Array3& a, const Array3& b) {
            const auto u = on_host(a), v = on_host(b);
            double sum = 0;
            for (int i = 0; i < parts.liquid.store.owned(); ++i) {
                for (int k = 0; k < 3; ++k) sum += u(i, k) * v(i, k);
            }
            return parts.comm.sum(sum);
        };
        const auto& store = parts.liquid.store;
        const double xy = product(store.get<Array3>(y), cx), yx = product(store.get<Array3>(x), cy);
        const double size = std::sqrt(product(cx, cx) * product(store.get<Array3>(y), store.get<Array3>(y)));
        EXPECT_NEAR(xy, yx, 1e-14 * size);
        EXPECT_GT(
            product(store.get<Array3>(x), cx), product(store.get<Array3>(x), store.get<Array3>(x)) * 0.3 * (1 - 1e-9));
    }
}

TEST(ImplicitViscosity, ProductsInSinglePrecisionAreThoseInDoubleNearly) {
    double most = 0;
    for (const auto form : every_form) {
        if (!ViscousOperator::has_tiles(form)) continue;
        ViscousTest one(two_liquids_on_a_wall(form));
        auto& parts = one.parts;
        const auto x = parts.liquid.store.add<Array3>("x", "", FieldRole::work);
        ViscousOperator matrix(parts.liquid);
        const auto all = one.all();
        ASSERT_GT(matrix.prepare(all, step_of(1, {3, 4, 0.3, form})), 0);
        fill_by_id(parts.liquid, x, 5);
        Kokkos::deep_copy(one.motion, 0.3);
        const auto rows = parts.liquid.store.total();
        const Array3 right("right", rows), near("near", rows);
        for (const auto walls : {ViscousOperator::Walls::resting, ViscousOperator::Walls::moving}) {
            matrix.multiply(all, x, walls, right);
            const auto wanted = matrix.loads(all);
            matrix.multiply_single_precision(all, x, walls, near);
            double largest = 0, apart = 0;
            for (int i = 0; i < parts.liquid.store.owned(); ++i) {
                for (int k = 0; k < 3; ++k) {
                    largest = std::max(largest, std::abs(on_host(right)(i, k)));
                    apart = std::max(apart, std::abs(on_host(near)(i, k) - on_host(right)(i, k)));
                }
            }
            most = std::max(most, parts.comm.max(apart) / parts.comm.max(largest));
            if (walls == ViscousOperator::Walls::resting) continue;
            const auto loads = matrix.loads(all);
            for (std::size_t k = 0; k < loads.size(); ++k)
                EXPECT_NEAR(loads[k], wanted[k], 1e-5 * std::abs(wanted[k]) + 1e-6);
        }
    }
    RecordProperty("apart", std::to_string(most * 1e9) + "e-9");
    EXPECT_GT(most, 0); // or it was not in single precision
    EXPECT_LT(most, 1e-5);
}

namespace {
// Velocities after a step, with the products of a precision.
std::map<std::int64_t, State> solved(ViscosityPrecision precision, double residual, int& iterations) {
    const BlobSetup blob{3, 6, 0.2, ViscosityForm::corrected};
    auto sample = turning_blob(blob);
    for (auto& point : sample.liquid) point.u = {std::sin(9 * point.x[1]), point.x[0] * point.x[2], 0};
    sample.setup.options.viscosity.precision = precision;
    sample.setup.options.viscosity.residual = residual;
    ViscousCase one(sample);
    const auto result = one.solve(step_of(1, blob));
    EXPECT_TRUE(result.solve.converged()) << result.solve.reason;
    EXPECT_LE(result.solve.relative_residual, residual);
    iterations = result.solve.iterations;
    return all_states(one.parts.comm, one.parts.liquid);
}
} // namespace

TEST(ImplicitViscosity, MixedPrecisionReachesAnyResidual) {
    for (const double residual : {1e-6, 1e-12}) {
        int few = 0, many = 0;
        const auto right = solved(ViscosityPrecision::full, residual, few);
        const auto mixed = solved(ViscosityPrecision::mixed, residual, many);
        RecordProperty("iterations_" + std::to_string(std::lround(-std::log10(residual))),
            std::to_string(few) + " and " + std::to_string(many));
        double apart = 0;
        for (const auto& [id, now] : mixed) {
            for (std::size_t k = 0; k < 3; ++k) apart = std::max(apart, std::abs(now.u[k] - right.at(id).u[k]));
        }
        EXPECT_LT(apart, 100 * residual);
        EXPECT_LE(many, 2 * few);
    }
}

TEST(ImplicitViscosity, LeavesABlobThatMovesAsOneAsItIs) {
    const BlobSetup blob{3, 5, 0.2, ViscosityForm::corrected};
    auto sample = turning_blob(blob);
    const std::array<double, 3> u{0.1, -1 / 3.0, 0.7}; // no numbers of single precision
    for (auto& point : sample.liquid) point.u = {u[0], u[1], u[2]};
    sample.setup.options.viscosity.residual = 1e-6;
    ViscousCase one(sample);
    EXPECT_EQ(one.solve(step_of(10, blob)).solve.iterations, 0);
    for (const auto& [id, now] : all_states(one.parts.comm, one.parts.liquid)) {
        for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(now.u[k], u[k]);
    }
}

TEST(ImplicitViscosity, EveryFormKeepsMomentum) {
    for (const auto form : every_form) {
        const BlobSetup blob{3, 4, 0.3, form};
        auto sample = turning_blob(blob);
        test::Random random(3);
        for (auto& point : sample.liquid) {
            for (double& u : point.u) u = 2 * random.unit() - 1;
        }
        sample.setup.options.viscosity.residual = 1e-13; // what is left of it is momentum
        ViscousCase one(sample);
        const auto before = all_states(one.parts.comm, one.parts.liquid);
        ASSERT_TRUE(one.solve(step_of(0.1, blob)).solve.converged());
        const auto sum = change(one.parts, before);
        ASSERT_GT(sum.size, 1e-3);
        for (const double p : sum.momentum) EXPECT_NEAR(p, 0, 1e-12 * sum.size);
        if (form == ViscosityForm::corrected || form == ViscosityForm::pairwise) {
            for (const double l : sum.angular) EXPECT_NEAR(l, 0, 1e-12 * sum.size);
        }
    }
}

namespace {
// To 1e-6, of octants of a ball that move apart, with nu dt / d^2 = 1e4.
int iterations(double radius, ViscosityPreconditioner preconditioner) {
    auto sample = turning_blob({3, radius, 0.2, ViscosityForm::corrected});
    sample.setup.options.viscosity.preconditioner = preconditioner;
    sample.setup.options.viscosity.residual = 1e-6;
    const double middle = (radius + 2) * spacing;
    for (auto& point : sample.liquid) {
        for (std::size_t k = 0; k < 3; ++k) point.u[k] = point.x[(k + 1) % 3] > middle ? 1 : -1;
    }
    ViscousCase one(sample);
    const auto report = one.solve(1e4 * spacing * spacing * rest_density / viscosity).solve;
    EXPECT_TRUE(report.converged()) << report.reason;
    return report.iterations;
}
} // namespace

TEST(ImplicitViscosity, MultilevelSparesIterationsAndKeepsThemFromGrowing) {
    const int small = iterations(4, ViscosityPreconditioner::multilevel);
    const int large = iterations(10, ViscosityPreconditioner::multilevel);
    EXPECT_LE(large, 1.5 * small);
    const int alone = iterations(10, ViscosityPreconditioner::jacobi);
    RecordProperty("iterations", std::to_string(small) + " " + std::to_string(large) + " " + std::to_string(alone));
    EXPECT_LT(large, 0.8 * alone);
}

} // namespace treacle::sph::viscosity_test
