#include "sph/viscosity/multigrid/viscous_multilevel.hpp"

#include "sph/viscosity/multigrid/velocity_element.hpp"
#include "viscous_sample.hpp"

namespace treacle::sph::viscous_multilevel_test {
namespace {

// u.K u of an element by quadrature, two points an axis: velocities [corners][D], widths of the cell.
template <int D>
double energy_by_points(const GradientEnergy& energy, const double width[3], const std::vector<double>& u) {
    const double points[2] = {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)};
    double sum = 0;
    for (int point = 0; point < corners<D>; ++point) {
        double g[D][D] = {};
        for (int a = 0; a < corners<D>; ++a) {
            for (int l = 0; l < D; ++l) {
                double slope = ((a >> l & 1) ? 1 : -1) * width[0] / width[l];
                for (int k = 0; k < D; ++k) {
                    const double at = points[point >> k & 1];
                    if (k != l) slope *= (a >> k & 1) ? at : 1 - at;
                }
                for (int k = 0; k < D; ++k) g[k][l] += slope * u[static_cast<std::size_t>(D * a + k)];
            }
        }
        for (int k = 0; k < D; ++k) {
            for (int l = 0; l < D; ++l)
                sum += (energy.square * g[k][l] * g[k][l] + energy.transposed * g[k][l] * g[l][k]) / corners<D>;
        }
    }
    return sum;
}

template <int D>
void expect_energy(const GradientEnergy& energy) {
    const double width[3] = {1, 1.3, 0.7};
    const auto matrix = Element<D>(energy, width).matrix();
    test::Random random(5);
    for (int trial = 0; trial < 10; ++trial) {
        std::vector<double> u;
        for (int k = 0; k < Element<D>::unknowns; ++k) u.push_back(2 * random.unit() - 1);
        const Eigen::Map<const Eigen::VectorXd> vector(u.data(), Element<D>::unknowns);
        const double expected = energy_by_points<D>(energy, width, u);
        EXPECT_NEAR(vector.dot(matrix * vector), expected, 1e-5 * expected);
    }
    EXPECT_LT((matrix - matrix.transpose()).norm(), 1e-6 * matrix.norm());
    EXPECT_GT(largest_eigenvalue<D>(matrix), 1);
}

// All that a preconditioner is made for.
struct Preconditioned {
    ViscousTest test;
    NearPairs near;
    ViscousScene scene;
    ViscousContext parts;
    ViscousOperator of;
    ViscousMultilevel multilevel;

    Preconditioned(const Sample& sample, double dt)
        : test(sample),
          scene(near.among(viscous_scene(test.parts))), parts{scene, test.points, test.friction, test.motion},
          of(test.parts.liquid), multilevel(sample.setup.grid) {
        of.prepare(parts, dt);
        multilevel.set_up(parts, of);
    }
    // r.z of all ranks for the z of another field.
    double product(int r, int other) {
        const auto& store = test.parts.liquid.store;
        Array3 z("z", static_cast<std::size_t>(store.owned()));
        multilevel.apply(of, store.get<Array3>(other), z);
        const auto a = on_host(store.get<Array3>(r)), b = on_host(z);
        double sum = 0;
        for (int i = 0; i < store.owned(); ++i) {
            for (int k = 0; k < 3; ++k) sum += a(i, k) * b(i, k);
        }
        return test.parts.comm.sum(sum);
    }
};

// A ball or disc; or a lattice out of order between periodic sides, of a length that is no multiple of a cell's.
Sample blob_or_all(int dimensions, bool periodic) {
    const BlobSetup blob{dimensions, dimensions == 2 ? 9.0 : 4.0, 0.2, ViscosityForm::corrected};
    if (!periodic) return turning_blob(blob);
    const bool space = dimensions == 3;
    const double size = (space ? 11 : 21) * spacing;
    Sample sample{make_setup(make_domain(dimensions, {0, 0, 0}, {size, size, space ? size : spacing},
                                 {scene::BoundaryKind::open, {true, true, space}}),
                      turning_blob(blob).setup.options),
        {}, {}};
    sample.setup.forces.viscosity = viscosity;
    const int n = space ? 11 : 21;
    add_block(sample, {{spacing / 2, spacing / 2, spacing / 2}, {n, n, space ? n : 1}, spacing, 0.2});
    return sample;
}
// Numbers in no order, in the plane of plane samples.
void fill_within(const Sample& sample, const LiquidParticles& liquid, int field, int shift) {
    fill_by_id(liquid, field, shift);
    if (sample.setup.constants.dimensions == 3) return;
    test::edit(liquid.store.get<Array3>(field), [&](auto& v) {
        for (int i = 0; i < liquid.store.owned(); ++i) v(i, 2) = 0;
    });
}
} // namespace

TEST(VelocityElement, HasTheEnergyOfItsGradients) {
    for (const auto energy : {GradientEnergy{1, 1}, GradientEnergy{1, 0}}) {
        expect_energy<2>(energy);
        expect_energy<3>(energy);
    }
}

TEST(ViscousMultilevel, IsSymmetricAndDefinite) {
    std::vector<Sample> samples{two_liquids_on_a_wall(ViscosityForm::corrected)};
    for (const int dimensions : {2, 3}) {
        for (const bool periodic : {false, true}) samples.push_back(blob_or_all(dimensions, periodic));
    }
    for (const auto& sample : samples) {
        for (const double stiffness : {0.1, 10.0, 1e5}) {
            Preconditioned one(sample, stiffness * spacing * spacing * rest_density / viscosity);
            auto& liquid = one.test.parts.liquid;
            const int a = liquid.velocity_field(), b = liquid.acceleration_field();
            fill_within(sample, liquid, a, 0);
            fill_within(sample, liquid, b, 400);
            const double aa = one.product(a, a), bb = one.product(b, b), ab = one.product(a, b), ba = one.product(b, a);
            EXPECT_GT(aa, 0);
            EXPECT_GT(bb, 0);
            EXPECT_NEAR(ab, ba, 1e-5 * std::sqrt(aa * bb));
        }
    }
}

TEST(ViscousMultilevel, KeepsIterationsFewBetweenPeriodicSidesAndOnAnyRanks) {
    for (const int dimensions : {2, 3}) {
        for (const bool periodic : {false, true}) {
            auto sample = blob_or_all(dimensions, periodic);
            sample.setup.options.viscosity.residual = 1e-6;
            ViscousCase one(sample);
            fill_within(sample, one.parts.liquid, one.parts.liquid.velocity_field(), 0);
            const auto report = one.solve(1e4 * spacing * spacing * rest_density / viscosity).solve;
            ASSERT_TRUE(report.converged()) << report.reason;
            RecordProperty(
                "iterations_" + std::to_string(dimensions) + (periodic ? "_periodic" : ""), report.iterations);
            EXPECT_LE(report.iterations, 22) << dimensions << (periodic ? " periodic" : "");
        }
    }
}

// What a thick liquid's stresses hold of a thin one around it the cells hold as well: a coarse correction without that
// threw it about, 50 to 1000 iterations.
TEST(ViscousMultilevel, KeepsIterationsFewWhereAThinLiquidMeetsAThickOne) {
    for (const int dimensions : {2, 3}) {
        for (const double thin : {0.0, 1e-6}) {
            auto sample = blob_or_all(dimensions, false);
            sample.setup.options.viscosity.residual = 1e-6;
            sample.setup.constants.immiscible = make_immiscible_liquids(
                std::vector<LiquidMaterial>{{rest_density, thin * viscosity}, {rest_density, viscosity}});
            for (auto& point : sample.liquid)
                point.liquid = point.x[0] > (dimensions == 2 ? 11 : 6) * spacing ? 1 : 0; // the middle
            ViscousCase one(sample);
            fill_within(sample, one.parts.liquid, one.parts.liquid.velocity_field(), 0);
            const auto report = one.solve(1e7 * spacing * spacing * rest_density / viscosity).solve;
            ASSERT_TRUE(report.converged()) << report.reason;
            const auto name = std::to_string(dimensions) + (thin > 0 ? "_thin" : "_inviscid");
            RecordProperty("iterations_" + name, report.iterations);
            EXPECT_LE(report.iterations, 40) << name;
        }
    }
}

} // namespace treacle::sph::viscous_multilevel_test
