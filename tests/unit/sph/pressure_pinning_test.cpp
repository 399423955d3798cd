#include "parts.hpp"

#include <set>

namespace treacle::sph::anchoring_test {
namespace {

// Blobs, rods and single particles that reach across the boxes of the ranks, some of them with anchors.
struct Clusters {
    Sample sample;
    std::map<std::int64_t, Role> role;
    std::map<std::int64_t, double> source, wall, diagonal;

    explicit Clusters(bool periodic) {
        const Vec3 size{48 * spacing, 24 * spacing, 24 * spacing};
        sample.setup =
            make_setup(make_domain(3, {0, 0, 0}, size, {scene::BoundaryKind::open, {periodic, false, false}}));
        add(20, {{0.5 * spacing, 2 * spacing, 2 * spacing}, {48, 1, 1}});   // through the whole domain
        add(21, {{0.5 * spacing, 10 * spacing, 2 * spacing}, {10, 2, 1}});  // two halves that meet only
        add(22, {{36.5 * spacing, 10 * spacing, 2 * spacing}, {12, 2, 1}}); // through the periodic side
        add(23, {{4 * spacing, 16 * spacing, 2 * spacing}, {5, 5, 5}, spacing, 0.2});
        add(24, {{16 * spacing, 14 * spacing, 4 * spacing}, {16, 3, 3}, spacing, 0.2});
        add(25, {{36 * spacing, 17 * spacing, 3 * spacing}, {4, 4, 4}});
        add(26, {{12 * spacing, 2 * spacing, 12 * spacing}, {1, 18, 1}});
        add(27, {{20 * spacing, 2 * spacing, 12 * spacing}, {20, 1, 9}});
        add(28, {{40 * spacing, 6 * spacing, 14 * spacing}, {1, 1, 1}});
        // Anchors: a Dirichlet particle at the end of the long rod; wall terms, strong and far too weak.
        role[first_.at(24)] = Role::dirichlet;
        wall[first_.at(25)] = 1;
        wall[first_.at(27)] = 1e-6;
    }

    // The particle of least source, then least id, of each component of Poisson particles without an anchor.
    std::set<std::int64_t> expected() const {
        const auto& box = sample.setup.domain;
        const double h2 = sample.setup.constants.support * sample.setup.constants.support;
        const auto n = sample.liquid.size();
        const auto near = [&](std::size_t a, std::size_t b) {
            double r2 = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                double dx = sample.liquid[a].x[k] - sample.liquid[b].x[k];
                if (box.period[k] > 0) dx -= std::round(dx / box.period[k]) * box.period[k];
                r2 += dx * dx;
            }
            return r2 < h2;
        };
        std::vector<int> component(n, -1);
        std::set<std::int64_t> out;
        for (std::size_t seed = 0; seed < n; ++seed) {
            if (component[seed] >= 0 || role.at(id_of(seed)) != Role::poisson) continue;
            std::vector<std::size_t> open{seed};
            component[seed] = int(seed);
            bool has_datum = false;
            std::pair<double, std::int64_t> best{1e300, 0};
            while (!open.empty()) {
                const auto at = open.back();
                open.pop_back();
                best = std::min(best, {source.at(id_of(at)), id_of(at)});
                has_datum = has_datum || wall.at(id_of(at)) > 1e-3;
                for (std::size_t other = 0; other < n; ++other) {
                    if (other == at || !near(at, other)) continue;
                    if (role.at(id_of(other)) != Role::poisson) {
                        has_datum = true;
                    } else if (component[other] < 0) {
                        component[other] = int(seed);
                        open.push_back(other);
                    }
                }
            }
            if (!has_datum) out.insert(best.second);
        }
        return out;
    }

    std::unique_ptr<Parts> parts(const Comm& comm) const {
        auto out = std::make_unique<Parts>(comm, sample);
        auto& liquid = out->liquid;
        out->set_by_id(liquid.role(), [&](std::int64_t id) { return role.at(id); });
        out->set_by_id(liquid.source(), [&](std::int64_t id) { return source.at(id); });
        out->set_by_id(liquid.wall_term(), [&](std::int64_t id) { return wall.at(id); });
        out->set_by_id(liquid.diagonal(), [&](std::int64_t) { return 1.0; });
        out->halo.gather(liquid.store, {liquid.role_field()});
        return out;
    }

private:
    void add(int seed, const Block& block) {
        first_[seed] = id_of(sample.liquid.size());
        const auto before = sample.liquid.size();
        add_block(sample, block);
        test::Random random{static_cast<std::uint64_t>(seed)};
        for (std::size_t k = before; k < sample.liquid.size(); ++k) {
            role[id_of(k)] = Role::poisson;
            source[id_of(k)] = 1 + random.below(4); // ties are common
            wall[id_of(k)] = 0;
        }
    }
    std::map<int, std::int64_t> first_;
};

std::set<std::int64_t> changed(const Parts& parts, const Clusters& clusters) {
    std::set<std::int64_t> out;
    for (const auto& [id, role] : by_id(parts.comm, parts.liquid, parts.liquid.role())) {
        if (int(role) != clusters.role.at(id)) out.insert(id);
    }
    return out;
}

} // namespace

TEST(PressurePinning, MakesOneParticleOfEveryLooseComponentDirichletTheSameOnAnyRanks) {
    for (const bool periodic : {false, true}) {
        const Clusters clusters(periodic);
        const auto expected = clusters.expected();
        EXPECT_EQ(expected.size(), periodic ? 6u : 7u) << "the halves are one component through the periodic side";
        for (const auto& comm : {Comm::world(), Comm::self()}) {
            const auto parts = clusters.parts(comm);
            EXPECT_EQ(parts->anchor(), std::int64_t(expected.size()));
            EXPECT_EQ(changed(*parts, clusters), expected);
            // Ghosts have it.
            const auto role = test::on_host(parts->liquid.role());
            const auto id = test::on_host(parts->liquid.id());
            int wrong = 0;
            for (int i = parts->liquid.store.owned(); i < parts->liquid.store.total(); ++i) {
                const bool due = expected.count(id(i)) > 0 || clusters.role.at(id(i)) == Role::dirichlet;
                wrong += static_cast<int>((role(i) == Role::dirichlet) != due);
            }
            EXPECT_EQ(wrong, 0);
            EXPECT_EQ(parts->anchor(), 0) << "nothing is loose afterwards";
        }
    }
}

TEST(PressurePinning, LeavesASystemWithoutUnknownsAlone) {
    Clusters clusters(false);
    for (auto& [id, role] : clusters.role) role = Role::dirichlet;
    const auto parts = clusters.parts(Comm::world());
    EXPECT_EQ(parts->anchor(), 0);
    parts->assemble();
    EXPECT_EQ(parts->system.global_rows(), 0);
}

// A block of unknowns beside one particle of pressure 0, `distance` from the nearest of them.
double least_eigenvalue_beside(double distance, std::int64_t pinned) {
    Sample sample;
    sample.setup = make_setup(make_domain(3, {0, 0, 0}, {20 * spacing, 10 * spacing, 10 * spacing}));
    add_block(sample, {{6 * spacing, 4 * spacing, 4 * spacing}, {4, 3, 3}});
    sample.liquid.push_back({{9 * spacing + distance, 5 * spacing, 5 * spacing}});
    const auto outside = id_of(sample.liquid.size() - 1);
    Parts parts(Comm::world(), sample);
    parts.predict_roles(LastPressures::none, 1e-3);
    parts.set_by_id(
        parts.liquid.role(), [&](std::int64_t id) { return id == outside ? Role::dirichlet : Role::poisson; });
    parts.halo.gather(parts.liquid.store, {parts.liquid.role_field()});
    EXPECT_EQ(parts.anchor(), pinned);
    parts.assemble();
    Eigen::MatrixXd a = gather_system(parts).matrix;
    const Eigen::VectorXd scale = a.diagonal().cwiseSqrt().cwiseInverse();
    a = scale.asDiagonal() * a * scale.asDiagonal();
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a).eigenvalues()(0);
}

TEST(PressurePinning, ADirichletNeighbourAtTheRimOfTheSupportIsNoAnchor) {
    // An anchor at a lattice point holds 36 unknowns with a 270th of the diagonal or more: 0.05 / 36 is 0.0014.
    EXPECT_GT(least_eigenvalue_beside(spacing, 0), 1e-3);
    // a_ij falls with the square of the distance to the rim: 1e-6 of the diagonal.
    EXPECT_GT(least_eigenvalue_beside(2.499 * spacing, 1), 1e-3);
}

} // namespace treacle::sph::anchoring_test
