#include "change.hpp"
#include "viscous_sample.hpp"

// Liquids of different viscosity that meet.
namespace treacle::sph::viscous_interface_test {
namespace {

void set_viscosities(Sample& sample, double first, double second) {
    sample.setup.constants.immiscible =
        make_immiscible_liquids(std::vector<LiquidMaterial>{{rest_density, first}, {rest_density, second}});
}

// A disc or ball, one side of which, cut obliquely, has `ratio` times the viscosity; turning.
Sample two_sided_blob(int dimensions, double jitter, double ratio) {
    auto sample = turning_blob({dimensions, dimensions == 2 ? 9.0 : 4.0, jitter, ViscosityForm::corrected});
    const double middle = (dimensions == 2 ? 11 : 6) * spacing;
    set_viscosities(sample, viscosity, ratio * viscosity);
    for (auto& point : sample.liquid) point.liquid = 3 * (point.x[0] - middle) + point.x[1] - middle > 0 ? 1 : 0;
    sample.setup.options.viscosity.residual = 1e-13;
    return sample;
}
constexpr double stiff_step = 100 * spacing * spacing * rest_density / viscosity;

struct Layers {
    double first, second; // viscosities [Pa s]
    int rows;             // of each
    double jitter = 0;
};

// Between periodic sides, the lower one of two layers driven to the right by 1 m/s2, the upper one to the left, for very long. Returns
// the largest error of a row's mean velocity over how fast the thinner one is beside its interfaces.
double error_of_layers(const Layers& layers) {
    const double height = layers.rows * spacing, width = 8 * spacing;
    SphOptions options;
    options.viscosity.residual = 1e-9;
    Sample sample{make_setup(make_domain(2, {0, 0, 0}, {width, 2 * height, spacing},
                                 {scene::BoundaryKind::wall, {true, true, false}}),
                      options),
        {}, {}};
    sample.setup.forces.viscosity = viscosity;
    set_viscosities(sample, layers.first, layers.second);
    add_block(sample, {{spacing / 2, spacing / 2, 0}, {8, 2 * layers.rows, 1}, spacing, layers.jitter});
    const double thin = std::min(layers.first, layers.second), dt = 1e3 * height * height * rest_density / thin;
    for (auto& point : sample.liquid) {
        point.liquid = point.x[1] < height ? 0 : 1;
        point.u = {point.liquid == 0 ? dt : -dt, 0, 0};
    }
    ViscousCase one(sample);
    EXPECT_TRUE(one.solve(dt).solve.converged());
    std::vector<double> off(2 * std::size_t(layers.rows)), exact(off.size());
    double mean = 0; // the exact velocity at the interfaces gives both liquids together no momentum
    for (const double mu : {layers.first, layers.second})
        mean += (mu == layers.first ? 0.5 : -0.5) * rest_density * height * height / (12 * mu);
    for (const auto& [id, now] : all_states(one.parts.comm, one.parts.liquid)) {
        const bool lower = now.x[1] < height;
        const double y = lower ? now.x[1] : now.x[1] - height;
        const double right =
            (lower ? 1 : -1) * rest_density * y * (height - y) / (2 * (lower ? layers.first : layers.second)) - mean;
        off[std::size_t(now.x[1] / spacing)] += (now.u[0] - right) / 8;
    }
    double most = 0;
    for (const double one_row : off) most = std::max(most, std::abs(one_row));
    return most / (rest_density * height * height / (8 * thin));
}
} // namespace

TEST(ViscousInterface, LayersSlideAsTheirViscositiesAsk) {
    for (const auto& [first, second] : {std::pair{1.0, 2.0}, {10.0, 1.0}, {1.0, 100.0}, {1000.0, 1.0}}) {
        const double coarse = error_of_layers({first * viscosity, second * viscosity, 16});
        const double fine = error_of_layers({first * viscosity, second * viscosity, 32});
        RecordProperty("ratio_" + std::to_string(int(std::max(first, second))),
            std::to_string(coarse) + " " + std::to_string(fine));
        // A fifth of a spacing, by how much the velocity changes there; a spacing where stresses are averaged over a support.
        EXPECT_LT(coarse, 0.2 * 4 / 16) << first << " " << second;
        EXPECT_LT(fine, 0.2 * 4 / 32) << first << " " << second;
    }
}

TEST(ViscousInterface, LayersOutOfOrderSlideSo) {
    for (const double ratio : {10.0, 1000.0}) {
        const double found = error_of_layers({ratio * viscosity, viscosity, 32, 0.1});
        RecordProperty("ratio_" + std::to_string(int(ratio)), std::to_string(found));
        EXPECT_LT(found, 0.06); // particles out of order yield by 0.03
    }
}

TEST(ViscousInterface, RotationIsKept) {
    for (const int dimensions : {2, 3}) {
        for (const double ratio : {1e-3, 1e3}) {
            ViscousCase one(two_sided_blob(dimensions, 0.2, ratio));
            const auto before = all_states(one.parts.comm, one.parts.liquid);
            ASSERT_TRUE(one.solve(stiff_step).solve.converged());
            double most = 0, lost = 0;
            for (const auto& [id, now] : all_states(one.parts.comm, one.parts.liquid)) {
                for (std::size_t k = 0; k < 3; ++k) {
                    lost = std::max(lost, std::abs(now.u[k] - before.at(id).u[k]));
                    most = std::max(most, std::abs(now.u[k]));
                }
            }
            EXPECT_LT(lost, 1e-10 * most) << ratio; // round-off times nu dt / d^2, 1e5
        }
    }
}

TEST(ViscousInterface, MomentumIsKept) {
    for (const int dimensions : {2, 3}) {
        auto sample = two_sided_blob(dimensions, 0.2, 100);
        test::Random random(3);
        for (auto& point : sample.liquid) {
            for (std::size_t k = 0; k < std::size_t(dimensions); ++k) point.u[k] = 2 * random.unit() - 1;
        }
        ViscousCase one(sample);
        const auto before = all_states(one.parts.comm, one.parts.liquid);
        ASSERT_TRUE(one.solve(0.01 * stiff_step).solve.converged());
        const auto sum = change(one.parts, before);
        ASSERT_GT(sum.size, 1e-3);
        for (const double p : sum.momentum) EXPECT_NEAR(p, 0, 1e-12 * sum.size);
        for (const double l : sum.angular) EXPECT_NEAR(l, 0, 1e-12 * sum.size);
    }
}

// Particles of either liquid anywhere: no side, no direction.
TEST(ViscousInterface, IterationsStayFewInABlend) {
    for (const double ratio : {100.0, 1e6}) {
        for (const double part : {0.5, 0.1}) {
            auto sample = two_sided_blob(3, 0.2, ratio);
            test::Random random(7);
            for (auto& point : sample.liquid) {
                point.liquid = random.unit() < part ? 1 : 0;
                for (double& u : point.u) u = 2 * random.unit() - 1;
            }
            sample.setup.options.viscosity.residual = 1e-6;
            ViscousCase one(sample);
            const auto report = one.solve(stiff_step).solve;
            ASSERT_TRUE(report.converged()) << report.reason;
            RecordProperty(
                "iterations_" + std::to_string(int(ratio)) + "_" + std::to_string(int(100 * part)), report.iterations);
            EXPECT_LE(report.iterations, 100) << ratio << " " << part; // 62; with h in single particles' gradients 1055
        }
    }
}

} // namespace treacle::sph::viscous_interface_test
