#include "parts.hpp"

namespace treacle::sph::definite_test {
namespace {

const SolidTerm terms[] = {
    SolidTerm::none, SolidTerm::decomposed, SolidTerm::unified, SolidTerm::amplified, SolidTerm::exact};
constexpr double dt = 1e-3; // [s]
// In two steps every particle would reach the centre of the flow: all are predicted to be compressed.
constexpr double rate = 4 / dt;

Sample free_space(SolidTerm term = SolidTerm::exact) {
    SphOptions options;
    options.pressure.solid_term = term;
    const double half_width = 40 * spacing;
    return {make_setup(
                make_domain(3, {-half_width, -half_width, -half_width}, {half_width, half_width, half_width}), options),
        {}, {}};
}

Eigen::VectorXd eigenvalues(Parts& parts) {
    const auto system = gather_system(parts);
    EXPECT_EQ((system.matrix - system.matrix.transpose()).cwiseAbs().maxCoeff(), 0);
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(system.matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

// The least eigenvalue of a graph anchored at one of n particles is about 1 / n of the largest; round-off of
// a singular one is 1e-16 of it.
void expect_positive_definite(Parts& parts, const char* what) {
    const auto values = eigenvalues(parts);
    ASSERT_GT(values.size(), 0) << what;
    EXPECT_GT(values(0), 1e-7 * values(values.size() - 1)) << what;
}

} // namespace

TEST(PressureMatrix, OfAJitteredBlockWithOneDirichletParticleIsPositiveDefinite) {
    auto sample = free_space();
    add_block(sample, {{0, 0, 0}, {9, 9, 9}, spacing, 0.3});
    ASSERT_EQ(sample.liquid.size(), 729u);
    Parts parts(Comm::self(), sample);
    parts.predict_roles(LastPressures::known, dt);
    parts.set_by_id(
        parts.liquid.role(), [](std::int64_t id) { return id == id_of(17) ? Role::dirichlet : Role::poisson; });
    parts.assemble();
    EXPECT_EQ(parts.system.rows(), 728);
    expect_positive_definite(parts, "one Dirichlet particle");
}

TEST(PressureMatrix, WithoutAnchorsHasOneNullVectorPerComponent) {
    auto sample = free_space();
    add_block(sample, {{0, 0, 0}, {4, 4, 4}, spacing, 0.2});
    add_block(sample, {{10 * spacing, 0, 0}, {3, 3, 3}, spacing, 0.2});
    add_block(sample, {{0, 10 * spacing, 0}, {2, 1, 1}});
    Parts parts(Comm::self(), sample);
    parts.predict_roles(LastPressures::known, dt);
    parts.set_by_id(parts.liquid.role(), [](std::int64_t) { return Role::poisson; });
    parts.assemble();
    const auto values = eigenvalues(parts);
    const double most = values(values.size() - 1);
    EXPECT_LT(std::abs(values(2)), 1e-13 * most); // round-off of a sum of 80 entries
    EXPECT_GT(values(3), 1e-3 * most);
    EXPECT_EQ(parts.anchor(), 3);
    parts.assemble();
    expect_positive_definite(parts, "pinned");
}

TEST(PressureMatrix, OfCompressedBlobsInFreeFlightIsPositiveDefinite) {
    for (const auto term : terms) {
        auto sample = free_space(term);
        add_block(sample, {{0, 0, 0}, {6, 6, 6}, 0.9 * spacing, 0.2});
        converge(sample, {2.5 * spacing, 2.5 * spacing, 2.5 * spacing}, rate);
        const auto first = sample.liquid.size();
        Sample second = free_space();
        add_block(second, {{20 * spacing, 0, 0}, {5, 5, 5}, 0.9 * spacing, 0.2});
        converge(second, {22 * spacing, 2 * spacing, 2 * spacing}, rate);
        sample.liquid.insert(sample.liquid.end(), second.liquid.begin(), second.liquid.end());
        Parts parts(Comm::self(), sample);
        const auto roles = parts.predict_roles(LastPressures::known, dt);
        ASSERT_EQ(roles.poisson, std::int64_t(sample.liquid.size())) << "all sources are positive";
        ASSERT_GT(first, 0u);
        EXPECT_EQ(parts.anchor(), 2);
        parts.assemble();
        expect_positive_definite(parts, "blobs");
    }
}

TEST(PressureMatrix, OfLiquidAroundAFloatingBodyIsPositiveDefiniteWithEverySolidTerm) {
    for (const auto term : terms) {
        for (const double gap : {1.0, 1.3}) { // pressed on, and off the body where Eq. 2.10 changes its sign
            auto sample = free_space(term);
            Sample lattice = sample;
            add_block(lattice, {{0, 0, 0}, {9, 9, 9}, spacing, 0.1});
            const double centre = 4 * spacing, clear = (1 + gap) * spacing * 0.99;
            for (const auto& point : lattice.liquid) {
                double far = 0;
                for (const double x : point.x) far = std::max(far, std::abs(x - centre));
                if (far > clear) sample.liquid.push_back(point);
            }
            add_shell(sample, {3 * spacing, 3 * spacing, 3 * spacing}, {3, 3, 3}, 1);
            converge(sample, {centre, centre, centre}, rate);
            Parts parts(Comm::self(), sample);
            const auto roles = parts.predict_roles(LastPressures::known, dt);
            ASSERT_EQ(roles.poisson, std::int64_t(sample.liquid.size())) << "all sources are positive";
            const auto pinned = parts.anchor();
            if (term == SolidTerm::none) {
                EXPECT_EQ(pinned, 1) << "nothing else holds the pressure";
            }
            if (term == SolidTerm::unified) {
                EXPECT_EQ(pinned, 0) << "the wall term anchors";
            }
            parts.assemble();
            expect_positive_definite(parts, "liquid around a body");
        }
    }
}

TEST(PressureMatrix, OfIsolatedPairsIsPositiveDefinite) {
    for (const auto term : terms) {
        auto sample = free_space(term);
        for (int pair = 0; pair < 12; ++pair) {
            const double gap = (0.3 + 0.18 * pair) * spacing; // up to just inside the support of 2.5 d
            const double at = (pair - 6) * 5 * spacing;
            sample.liquid.push_back({{at, 0, 0}});
            sample.liquid.push_back({{at, gap, 0}, {0, -1e5 * rate * spacing, 0}});
        }
        // A solid particle beside one of the pairs.
        sample.solid.push_back({{-5 * spacing, -1.1 * spacing, 0}, 1});
        Parts parts(Comm::self(), sample);
        const auto roles = parts.predict_roles(LastPressures::known, dt);
        ASSERT_EQ(roles.poisson, 24);
        EXPECT_EQ(parts.anchor(), term == SolidTerm::none ? 12 : 11);
        parts.assemble();
        const auto system = gather_system(parts);
        // Diagonals may differ by their distances; each block is positive by itself.
        const auto values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(system.matrix).eigenvalues();
        EXPECT_GT(values(0), 0);
        EXPECT_EQ(parts.system.rows(), term == SolidTerm::none ? 12 : 13);
    }
}

TEST(PressureMatrix, ATankWithoutAFreeSurfaceIsPositiveDefinite) {
    for (const auto term : terms) {
        auto sample = free_space(term);
        add_block(sample, {{spacing, spacing, spacing}, {5, 5, 5}, spacing, 0.1});
        add_shell(sample, {0, 0, 0}, {7, 7, 7}, 0);
        for (auto& point : sample.liquid) point.p = 1e9; // by its last pressures all of it is under pressure
        Parts parts(Comm::self(), sample);
        ASSERT_EQ(parts.predict_roles(LastPressures::known, dt).poisson, 125);
        const auto pinned = parts.anchor();
        if (term == SolidTerm::none) {
            EXPECT_EQ(pinned, 1);
        }
        parts.assemble();
        expect_positive_definite(parts, "closed tank");
    }
}

} // namespace treacle::sph::definite_test
