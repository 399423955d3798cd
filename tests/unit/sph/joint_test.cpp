#include "parts.hpp"

namespace treacle::sph::joint_test {
namespace {

constexpr double dt = 1e-3; // [s]

// Solid particles as unknowns: liquid in a box without a lid, half of it in random motion, and a body in it.
Sample make_sample(const std::array<bool, 3>& periodic, int dimensions = 3) {
    SphOptions options;
    options.pressure.solid_term = SolidTerm::unknowns;
    const int nz = dimensions == 3 ? 8 : 1;
    const Vec3 size{12 * spacing, 9 * spacing, nz * spacing};
    Sample sample{
        make_setup(make_domain(dimensions, {0, 0, 0}, size, {scene::BoundaryKind::open, periodic}), options), {}, {}};
    add_block(sample, {{spacing / 2, 1.5 * spacing, spacing / 2}, {12, 6, nz}, spacing, 0.2});
    std::erase_if(sample.liquid, [](const auto& point) {
        return point.x[0] > 5.9 * spacing && point.x[0] < 8.1 * spacing && point.x[1] > 2.6 * spacing &&
               point.x[1] < 5.4 * spacing;
    });
    for (int k = 0; k < nz; ++k) {
        for (int i = 0; i < 12; ++i) {
            sample.solid.push_back(
                {{(i + 0.5) * spacing, 0.5 * spacing, dimensions == 3 ? (k + 0.5) * spacing : 0}, 0});
        }
    }
    add_shell(
        sample, {6.5 * spacing, 3.2 * spacing, dimensions == 3 ? 2 * spacing : 0}, {2, 2, dimensions == 3 ? 3 : 1}, 1);
    test::Random random(9);
    for (auto& point : sample.liquid) {
        for (int k = 0; k < dimensions; ++k) point.u[std::size_t(k)] = 8 * random.unit() - 4;
        point.p = 500 * random.unit();
    }
    return sample;
}

// The steps of a pressure solve, up to the joint matrix.
struct Joint : Parts {
    SolidRows around;
    std::int64_t unknown_solids = 0, pinned = 0;

    Joint(const Comm& group, const Sample& sample) : Parts(group, sample) {
        const double support = setup.constants.support;
        around.liquid.build(solid.store, liquid.store, setup.grid, liquid_cells, support);
        around.solid.build(solid.store, solid.store, setup.grid, solid_cells, support);
    }
    void solve_up_to_matrix(LastPressures pressures = LastPressures::known) {
        predict_roles(pressures, dt);
        unknown_solids =
            comm.sum(around.predict(setup.options, setup.constants, liquid, solid, neighbours, solid_halo));
        pinned = anchor();
        system.assemble_with_solids(
            setup.options, setup.constants, comm, {liquid, solid, neighbours, around, halo, solid_halo});
    }
    // Rows by the ids of liquid particles; those of solids lie far behind.
    DenseSystem gathered() {
        return gather_rows(*this, {{&liquid.store, liquid.row(), 0}, {&solid.store, solid.row(), solid_ids}});
    }
    static constexpr std::int64_t solid_ids = 1 << 24;
};

void expect_positive_definite(const DenseSystem& system) {
    const auto values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(system.matrix).eigenvalues();
    // Round-off of the eigenvalues is 1e-13 of the largest; a component without an anchor has 0.
    EXPECT_GT(values(0), 1e-9 * values(values.size() - 1));
}

class JointMatrix : public testing::TestWithParam<std::array<bool, 3>> {};

TEST_P(JointMatrix, IsSymmetricBitForBitDefiniteAndTheSameOnAnyNumberOfRanks) {
    for (const int dimensions : {2, 3}) {
        const auto sample = make_sample(GetParam(), dimensions);
        Joint world(Comm::world(), sample), self(Comm::self(), sample);
        world.solve_up_to_matrix();
        self.solve_up_to_matrix();
        const auto many = world.gathered(), one = self.gathered();
        EXPECT_GT(self.unknown_solids, 10);
        EXPECT_GT(std::int64_t(many.ids.size()), self.unknown_solids + 30);
        EXPECT_EQ((many.matrix - many.matrix.transpose()).cwiseAbs().maxCoeff(), 0);
        ASSERT_EQ(many.ids, one.ids);
        EXPECT_EQ((many.matrix - one.matrix).cwiseAbs().maxCoeff(), 0);
        EXPECT_EQ((many.right_hand_side - one.right_hand_side).cwiseAbs().maxCoeff(), 0);
        expect_positive_definite(one);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Solids, JointMatrix, testing::Values(std::array{false, false, false}, std::array{true, false, true}));

TEST(JointRows, SumToTheCouplingsToParticlesAtZeroPressure) {
    Joint parts(Comm::world(), make_sample({false, false, false}));
    parts.solve_up_to_matrix();
    const auto system = parts.gathered();
    for (Eigen::Index r = 0; r < system.matrix.rows(); ++r) {
        const auto row = system.matrix.row(r);
        // Round-off of a sum of 80 entries as large as the diagonal.
        ASSERT_GE(row.sum(), -1e-14 * 80 * row(r));
        ASSERT_EQ((row.array() > 0).count(), 1) << "the diagonal alone is positive";
    }
}

TEST(JointRows, AClosedTankUnderPressureIsAnchoredByOneParticle) {
    SphOptions options;
    options.pressure.solid_term = SolidTerm::unknowns;
    const double far = 10 * spacing;
    Sample sample{
        make_setup(make_domain(3, {-far, -far, -far}, {far, far, far}, {scene::BoundaryKind::open, {}}), options), {},
        {}};
    add_block(sample, {{spacing, spacing, spacing}, {5, 5, 5}, spacing, 0.1});
    add_shell(sample, {0, 0, 0}, {7, 7, 7}, 0);
    for (auto& point : sample.liquid) point.p = 1e9; // by its last pressures all of it is under pressure
    Joint parts(Comm::world(), sample);
    parts.solve_up_to_matrix();
    EXPECT_EQ(parts.pinned, 1);
    EXPECT_EQ(parts.unknown_solids, 7 * 7 * 7 - 5 * 5 * 5) << "no wall is dry";
    expect_positive_definite(parts.gathered());
}

TEST(JointRows, ADropOnADryFloorHangsOnTheFloorsDryParticles) {
    SphOptions options;
    options.pressure.solid_term = SolidTerm::unknowns;
    const double far = 10 * spacing;
    Sample sample{
        make_setup(make_domain(3, {-far, -far, -far}, {far, far, far}, {scene::BoundaryKind::open, {}}), options), {},
        {}};
    add_block(sample, {{0, 0, 0}, {4, 4, 4}, spacing, 0.1});
    converge(sample, {1.5 * spacing, 1.5 * spacing, 1.5 * spacing}, 1e3);
    for (int k = -8; k < 9; ++k) {
        for (int i = -8; i < 9; ++i) sample.solid.push_back({{i * spacing, -1.2 * spacing, k * spacing}, 0});
    }
    Joint parts(Comm::world(), sample);
    parts.solve_up_to_matrix();
    EXPECT_EQ(parts.pinned, 0);
    expect_positive_definite(parts.gathered());
}

} // namespace
} // namespace treacle::sph::joint_test
