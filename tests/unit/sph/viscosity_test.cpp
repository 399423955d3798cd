#include "change.hpp"
#include "sph/implicit_viscosity.hpp"

namespace treacle::sph {
namespace {

constexpr double viscosity = 50; // [Pa s]
constexpr ViscosityForm every_form[] = {ViscosityForm::corrected, ViscosityForm::adjoint, ViscosityForm::pairwise,
                                        ViscosityForm::laplacian};

// A disc or ball of the lattice, or one whose particles are out of order, turning about its centre.
struct BlobSetup {
    int dimensions = 2;
    double radius = 8; // [spacings]
    double jitter = 0; // share of the spacing
    ViscosityForm form = ViscosityForm::corrected;
};
Sample turning_blob(const BlobSetup& blob) {
    const bool space = blob.dimensions == 3;
    const double size = 2 * (blob.radius + 2) * spacing, middle = size / 2;
    SphOptions options;
    options.support_ratio = 3;
    options.viscosity.form = blob.form;
    options.viscosity.residual = 1e-12;
    const Vec3 far{size, size, space ? size : spacing};
    Sample sample{make_setup(make_domain(blob.dimensions, {0, 0, 0}, far, {scene::FaceKind::open}), options), {}, {}};
    sample.setup.forces.viscosity = viscosity;
    const int n = static_cast<int>(2 * blob.radius + 4);
    add_block(sample, {{spacing / 2, spacing / 2, spacing / 2}, {n, n, space ? n : 1}, spacing, blob.jitter});
    std::vector<LiquidPoint> inside;
    for (auto point : sample.liquid) {
        const double x = point.x[0] - middle, y = point.x[1] - middle, z = space ? point.x[2] - middle : 0;
        if (x * x + y * y + z * z > blob.radius * blob.radius * spacing * spacing) continue;
        point.u = {-y, x, 0};
        inside.push_back(point);
    }
    sample.liquid = inside;
    return sample;
}

// Parts of a step with the implicit viscosity.
struct ViscousCase {
    Parts parts;
    ImplicitViscosity solver;
    Bodies bodies;

    explicit ViscousCase(const Sample& sample)
        : parts(Comm::world(), sample), solver(parts.comm, parts.liquid, sample.setup.options.viscosity, sample.setup.grid, std::vector<double>(2, 1.0)),
          bodies({}, {}, 0, sample.setup.bodies, sample.setup.domain) {}
    ViscousScene scene() {
        return {parts.setup.options, parts.setup.constants, parts.setup.forces, parts.comm, parts.liquid,
                parts.solid,         parts.neighbours,      parts.halo};
    }
    ImplicitViscosity::Result solve(double dt) {
        return solver.solve(scene(), bodies, dt);
    }
};

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

// nu dt / R^2 of a step.
double step_of(double number, const BlobSetup& blob) {
    const double radius = blob.radius * spacing;
    return number * radius * radius * rest_density / viscosity;
}
} // namespace

TEST(ImplicitViscosity, CorrectedFormKeepsRigidRotationOfDiscAndBall) {
    for (const int dimensions : {2, 3}) {
        for (const double jitter : {0.0, 0.2}) {
            const BlobSetup blob{dimensions, dimensions == 2 ? 12.0 : 5.0, jitter, ViscosityForm::corrected};
            for (const double number : {0.1, 1.0, 100.0}) EXPECT_NEAR(kept_spin(blob, step_of(number, blob)), 1, 1e-10);
        }
    }
}

TEST(ImplicitViscosity, LaplacianFormStopsADiscAsTheHeatEquationDoes) {
    const BlobSetup disc{2, 24, 0, ViscosityForm::laplacian};
    EXPECT_NEAR(kept_spin(disc, step_of(0.1, disc)), 0.740, 0.05 * 0.740);
    EXPECT_NEAR(kept_spin(disc, step_of(1, disc)), 0.225, 0.05 * 0.225);
    EXPECT_NEAR(kept_spin(disc, step_of(100, disc)), 0.00291, 0.06 * 0.00291);
}

// Two liquids of different density and viscosity in a corner of walls, out of order.
TEST(ImplicitViscosity, EveryFormIsSymmetricAndPositiveWithWallsAndTwoLiquids) {
    for (const auto form : every_form) {
        const BlobSetup blob{3, 4, 0.3, form};
        auto sample = turning_blob(blob);
        sample.setup.constants.mixture = make_mixture(std::vector<LiquidMaterial>{{rest_density, viscosity}, {300, 1e4 * viscosity}});
        for (auto& point : sample.liquid) point.liquid = point.x[0] > 6 * spacing ? 1 : 0;
        const int n = 8;
        for (int k = 0; k < n * n; ++k) {
            sample.solid.push_back({{spacing * (2 + k % n), spacing * (2 + k / n), 1.5 * spacing}, 1, {0, 0, 1}});
        }
        sample.setup.constants.wall_depth = 0.7 * spacing;
        Parts parts(Comm::world(), sample);
        const auto x = parts.liquid.store.add<Array3>("x", "", FieldRole::work);
        const auto y = parts.liquid.store.add<Array3>("y", "", FieldRole::work);
        ViscousOperator matrix(parts.liquid);
        const Array<double> friction = upload({1, 1}), motion = upload(std::vector<double>(12, 0.0));
        const LoadPoints points(2);
        const ViscousParts all{{parts.setup.options, parts.setup.constants, parts.setup.forces, parts.comm,
                                parts.liquid,        parts.solid,           parts.neighbours,   parts.halo},
                               points, friction, motion};
        ASSERT_GT(matrix.prepare(all, step_of(1, blob)), 0);
        const auto fill = [&](int field, int shift) {
            const auto id = on_host(parts.liquid.id());
            test::edit(parts.liquid.store.get<Array3>(field), [&](auto& v) {
                for (int i = 0; i < parts.liquid.store.owned(); ++i) {
                    for (int k = 0; k < 3; ++k) v(i, k) = double((id(i) * 31 + k * 17 + shift) % 1009) / 1009 - 0.5;
                }
            });
        };
        fill(x, 5);
        fill(y, 11);
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
        EXPECT_GT(product(store.get<Array3>(x), cx), product(store.get<Array3>(x), store.get<Array3>(x)) * 0.3 * (1 - 1e-9));
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
        ViscousCase one(sample);
        const auto before = all_states(one.parts.comm, one.parts.liquid);
        ASSERT_TRUE(one.solve(step_of(0.1, blob)).solve.converged());
        const auto sum = change(one.parts, before);
        ASSERT_GT(sum.size, 1e-3);
        // The residual's share besides round-off.
        for (const double p : sum.momentum) EXPECT_NEAR(p, 0, 1e-11 * sum.size);
        if (form == ViscosityForm::corrected || form == ViscosityForm::pairwise) {
            for (const double l : sum.angular) EXPECT_NEAR(l, 0, 1e-11 * sum.size);
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

TEST(ImplicitViscosity, RigidBlocksSpareIterationsAndKeepThemFromGrowing) {
    const int small = iterations(4, ViscosityPreconditioner::rigid_blocks);
    const int large = iterations(8, ViscosityPreconditioner::rigid_blocks);
    EXPECT_LE(large, 1.5 * small);
    EXPECT_LT(large, 0.8 * iterations(8, ViscosityPreconditioner::jacobi));
}

} // namespace treacle::sph
