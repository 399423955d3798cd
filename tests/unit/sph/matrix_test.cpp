#include "parts.hpp"

namespace treacle::sph::matrix_test {
namespace {

constexpr double dt = 1e-3; // [s]

struct Case {
    const char* name;
    int dimensions;
    std::array<bool, 3> periodic;
    SolidTerm term;
    KernelKind kernel;
};
const Case cases[] = {
    {"open", 3, {false, false, false}, SolidTerm::exact, KernelKind::cubic_spline},
    {"periodic", 3, {true, true, true}, SolidTerm::amplified, KernelKind::wendland_c2},
    {"periodic along y", 3, {false, true, false}, SolidTerm::decomposed, KernelKind::mueller},
    {"plane", 2, {true, false, false}, SolidTerm::unified, KernelKind::cubic_spline},
};

// A jittered block across the whole domain with a body and a floor in it, in random motion.
Sample make_sample(const Case& c) {
    SphOptions options;
    options.pressure.solid_term = c.term;
    options.kernel = c.kernel;
    const int nz = c.dimensions == 3 ? 7 : 1;
    const Vec3 size{12 * spacing, 8 * spacing, nz * spacing};
    Sample sample{
        make_setup(make_domain(c.dimensions, {0, 0, 0}, size, {scene::BoundaryKind::open, c.periodic}), options), {},
        {}};
    add_block(sample, {{spacing / 2, spacing / 2, spacing / 2}, {12, 8, nz}, spacing, 0.25});
    std::erase_if(sample.liquid, [](const auto& point) {
        return point.x[0] > 5.9 * spacing && point.x[0] < 8.1 * spacing && point.x[1] < 2.1 * spacing;
    });
    const double z = c.dimensions == 3 ? 2 * spacing : 0;
    add_shell(sample, {6.5 * spacing, 0.8 * spacing, z}, {2, 2, c.dimensions == 3 ? 3 : 1}, 1);
    test::Random random(9);
    for (auto& point : sample.liquid) {
        for (int k = 0; k < c.dimensions; ++k) point.u[std::size_t(k)] = 8 * random.unit() - 4;
        point.p = 500 * random.unit();
    }
    return sample;
}

class MatrixCase : public testing::TestWithParam<Case> {
protected:
    Sample sample = make_sample(GetParam());
    std::unique_ptr<Parts> assembled(const Comm& comm) const {
        auto parts = std::make_unique<Parts>(comm, sample);
        parts->predict_roles(LastPressures::known, dt);
        parts->anchor();
        parts->assemble();
        return parts;
    }
};

} // namespace

TEST_P(MatrixCase, IsSymmetricBitForBitAndTheSameOnAnyNumberOfRanks) {
    const auto world = assembled(Comm::world()), self = assembled(Comm::self());
    const auto many = gather_system(*world), one = gather_system(*self);
    ASSERT_GT(many.ids.size(), 30u) << "many particles are unknowns";
    ASSERT_LT(many.ids.size(), sample.liquid.size()) << "some are not";
    EXPECT_EQ((many.matrix - many.matrix.transpose()).cwiseAbs().maxCoeff(), 0);
    ASSERT_EQ(many.ids, one.ids);
    EXPECT_EQ((many.matrix - one.matrix).cwiseAbs().maxCoeff(), 0);
    EXPECT_EQ((many.right_hand_side - one.right_hand_side).cwiseAbs().maxCoeff(), 0);
}

TEST_P(MatrixCase, RowSumsAreTheWallTermAndTheCouplingsToDirichletParticles) {
    const auto parts = assembled(Comm::world());
    const auto system = gather_system(*parts);
    const auto& comm = parts->comm;
    const auto state = all_states(comm, parts->liquid);
    const auto rho = by_id(comm, parts->liquid, parts->liquid.density());
    const auto role = by_id(comm, parts->liquid, parts->liquid.role());
    const auto wall = by_id(comm, parts->liquid, parts->liquid.wall_term());
    const auto& c = parts->setup.constants;
    const auto& box = parts->setup.domain;
    with_kernel(GetParam().kernel, c.dimensions, c.support, [&](const auto& kernel) {
        for (std::size_t r = 0; r < system.ids.size(); ++r) {
            const auto i = system.ids[r];
            double expected = wall.at(i);
            for (const auto& [j, other] : state) {
                if (role.at(j) != double(Role::dirichlet)) continue;
                double r2 = 0;
                for (int k = 0; k < c.dimensions; ++k) {
                    const auto u = std::size_t(k);
                    double dx = state.at(i).x[u] - other.x[u];
                    if (box.period[k] > 0) dx -= std::round(dx / box.period[k]) * box.period[k];
                    r2 += dx * dx;
                }
                if (r2 >= c.support * c.support) continue;
                const double volumes = c.mass / rho.at(i) + c.mass / rho.at(j);
                expected -= volumes * r2 * kernel.gradient(std::sqrt(r2)) / (r2 + 0.01 * c.support * c.support);
            }
            const auto row = system.matrix.row(Eigen::Index(r));
            // Round-off of a sum of 80 entries as large as the diagonal.
            ASSERT_NEAR(row.sum(), expected, 1e-14 * 80 * row(Eigen::Index(r)));
            ASSERT_GT(row(Eigen::Index(r)), 0);
            ASSERT_EQ((row.array() > 0).count(), 1) << "the diagonal alone is positive";
        }
    });
}

TEST_P(MatrixCase, GuessAndStoredPressuresBelongToTheirParticles) {
    const auto parts = assembled(Comm::world());
    const auto before = by_id(parts->comm, parts->liquid, parts->liquid.pressure());
    const auto role = by_id(parts->comm, parts->liquid, parts->liquid.role());
    parts->system.store_pressure(parts->liquid); // the guess itself is the solution
    for (const auto& [id, p] : by_id(parts->comm, parts->liquid, parts->liquid.pressure())) {
        if (role.at(id) != double(Role::separated)) {
            ASSERT_EQ(p, role.at(id) == double(Role::poisson) ? before.at(id) : 0.0);
        }
    }
    // Negative pressures are cut off.
    test::edit(parts->system.solution(), [&](auto& x) {
        for (int r = 0; r < parts->system.rows(); ++r) x(r) = r % 2 ? 3.0 : -3.0;
    });
    parts->system.store_pressure(parts->liquid);
    for (const auto& [id, p] : by_id(parts->comm, parts->liquid, parts->liquid.pressure())) {
        if (role.at(id) != double(Role::separated)) {
            ASSERT_TRUE(p == 0 || p == 3);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Pressure, MatrixCase, testing::ValuesIn(cases), [](const auto& info) {
    std::string name = info.param.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
});

} // namespace treacle::sph::matrix_test
