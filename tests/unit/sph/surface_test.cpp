#include "parts.hpp"

namespace treacle::sph::surface_test {
namespace {

constexpr double dt = 1e-3; // [s]
constexpr int edge = 9;

// A block of lattice liquid on a floor, with disorder as a share of the spacing.
Sample make_block(const SphOptions& options, double jitter, int dimensions = 3) {
    const double far = 20 * spacing;
    Sample sample{
        make_setup(
            make_domain(dimensions, {-far, -far, -far}, {far, far, far}, {scene::BoundaryKind::open, {}}), options),
        {}, {}};
    const int nz = dimensions == 3 ? edge : 1;
    add_block(sample, {{0, 0, 0}, {edge, edge, nz}, spacing, jitter});
    const auto& c = sample.setup.constants;
    const double gap =
        equilibrium_wall_distance({options.kernel, dimensions, c.support, spacing, spacing}, options.density);
    for (int k = dimensions == 3 ? -4 : 0; k < (dimensions == 3 ? edge + 4 : 1); ++k) {
        for (int i = -4; i < edge + 4; ++i) sample.solid.push_back({{i * spacing, -gap, k * spacing}, 0});
    }
    return sample;
}

SphOptions with_rule(DirichletRule rule) {
    SphOptions options;
    options.pressure.dirichlet = rule;
    return options;
}

// Whether a place of the block's list has a side without neighbours: the floor covers the lowest layer.
bool on_rim(std::size_t index, int dimensions) {
    const auto x = static_cast<int>(index % edge), y = static_cast<int>(index / edge % edge),
               z = static_cast<int>(index / edge / edge);
    return x == 0 || x == edge - 1 || y == edge - 1 || (dimensions == 3 && (z == 0 || z == edge - 1));
}

std::map<std::int64_t, std::size_t> indices_by_id(const Sample& sample) {
    std::map<std::int64_t, std::size_t> out;
    for (std::size_t k = 0; k < sample.liquid.size(); ++k) out[id_of(k)] = k;
    return out;
}
} // namespace

TEST(FreeSurface, ByGeometryIsTheOutermostLayerWhereNoSolidCoversIt) {
    for (const int dimensions : {2, 3}) {
        for (const double jitter : {0.0, 0.1}) {
            const auto sample = make_block(with_rule(DirichletRule::surface), jitter, dimensions);
            Parts parts(Comm::world(), sample);
            parts.predict_roles(LastPressures::known, dt);
            const auto index = indices_by_id(sample);
            for (const auto& [id, role] : by_id(parts.comm, parts.liquid, parts.liquid.role())) {
                // Low on a side, the floor that goes on there is cover too.
                if (on_rim(index.at(id), dimensions) && index.at(id) / edge % edge < 2) continue;
                ASSERT_EQ(role == double(Role::dirichlet), on_rim(index.at(id), dimensions))
                    << index.at(id) << " in " << dimensions << " dimensions";
            }
        }
    }
}

TEST(FreeSurface, ByDensityIsTheOutermostLayers) {
    for (const auto rule : {DirichletRule::density, DirichletRule::predicted_density}) {
        const auto sample = make_block(with_rule(rule), 0);
        Parts parts(Comm::world(), sample);
        parts.predict_roles(LastPressures::known, dt);
        const auto index = indices_by_id(sample);
        const auto rho = by_id(parts.comm, parts.liquid, parts.liquid.density());
        for (const auto& [id, role] : by_id(parts.comm, parts.liquid, parts.liquid.role())) {
            // Nothing moves, so that the predicted density is the density.
            ASSERT_EQ(role == double(Role::dirichlet), rho.at(id) < 0.97 * rest_density);
            if (on_rim(index.at(id), 3)) {
                ASSERT_EQ(role, double(Role::dirichlet));
            }
        }
    }
}

TEST(FreeSurface, GhostsMakeUpForWhatTheLatticeLacksAndLeaveNoneDirichlet) {
    auto options = with_rule(DirichletRule::ghosts);
    options.pressure.solid_term = SolidTerm::none;
    const auto sample = make_block(options, 0);
    Parts parts(Comm::world(), sample);
    const auto roles = parts.predict_roles(LastPressures::known, dt);
    EXPECT_EQ(roles.dirichlet, 0);
    EXPECT_EQ(parts.anchor(), 0) << "ghosts anchor";
    const auto index = indices_by_id(sample);
    const auto ghosts = by_id(parts.comm, parts.liquid, parts.liquid.wall_term());
    const auto& c = sample.setup.constants;
    const double half = compute_wall_sums({KernelKind::cubic_spline, 3, c.support, spacing, spacing}, spacing).missing;
    const double full = sample.setup.constants.laplacian_diagonal;
    for (const auto& [id, k] : index) {
        const auto x = int(k % edge), y = int(k / edge % edge), z = int(k / edge / edge);
        const bool middle = std::min({x, z, edge - 1 - x, edge - 1 - z}) >= 4;
        if (middle && y == 4) {
            ASSERT_NEAR(ghosts.at(id), 0, 1e-12 * full);
        }
        if (middle && y == 0) {
            ASSERT_NEAR(ghosts.at(id), 0, 0.01 * full) << "the floor covers";
        }
        if (middle && y == edge - 1) {
            ASSERT_NEAR(ghosts.at(id), half, 1e-12 * full) << "the half space above are ghosts at p = 0";
        }
    }
    parts.assemble();
    const auto system = gather_system(parts);
    EXPECT_EQ((system.matrix - system.matrix.transpose()).cwiseAbs().maxCoeff(), 0);
    const auto values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(system.matrix).eigenvalues();
    EXPECT_GT(values(0), 1e-4 * values(values.size() - 1)); // the lowest mode of 9 layers has 5e-3
}

TEST(FreeSurface, ClampedSourcesAreNeverNegativeAndChangeNoRole) {
    for (const auto rule : {DirichletRule::predicted, DirichletRule::density, DirichletRule::surface}) {
        std::map<std::int64_t, double> roles[2];
        for (const auto clamping : {Clamping::pressures, Clamping::sources}) {
            auto options = with_rule(rule);
            options.pressure.clamping = clamping;
            options.pressure.solid_term = SolidTerm::unified;
            auto sample = make_block(options, 0.1);
            test::Random random(9);
            for (auto& point : sample.liquid) {
                for (auto& u : point.u) u = 2 * random.unit() - 1;
                point.p = 500 * random.unit();
            }
            Parts parts(Comm::world(), sample);
            parts.predict_roles(LastPressures::known, dt);
            roles[int(clamping)] = by_id(parts.comm, parts.liquid, parts.liquid.role());
            double least = 0;
            for (const auto& [id, b] : by_id(parts.comm, parts.liquid, parts.liquid.source()))
                least = std::min(least, b);
            EXPECT_EQ(least < 0, clamping == Clamping::pressures);
        }
        EXPECT_EQ(roles[0], roles[1]);
    }
}

} // namespace treacle::sph::surface_test
