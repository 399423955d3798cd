#include "change.hpp"
#include "sph/implicit_viscosity.hpp"

namespace treacle::sph {
namespace {

constexpr double viscosity = 50; // [Pa s]

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
        : parts(Comm::world(), sample), solver(parts.liquid, std::vector<double>(2, 0.0)),
          bodies({}, {}, 0, sample.setup.bodies, sample.setup.domain) {}
    ImplicitViscosity::Result solve(double dt) {
        return solver.solve(parts.setup.options, parts.setup.constants, parts.setup.forces, parts.comm, parts.liquid,
                            parts.solid, parts.neighbours, parts.halo, bodies, dt);
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
    EXPECT_NEAR(kept_spin(disc, step_of(100, disc)), 0.00291, 0.05 * 0.00291);
}

TEST(ImplicitViscosity, EveryFormIsSymmetricAndPositiveAndKeepsMomentum) {
    for (const auto form : {ViscosityForm::corrected, ViscosityForm::adjoint, ViscosityForm::pairwise,
                            ViscosityForm::laplacian}) {
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

} // namespace treacle::sph
