#include "viscous_sample.hpp"

#include "grid/viscosity/viscous_problem.hpp"

namespace treacle::grid::mechanisms_test {
namespace {

// A ball with drops around it, smaller than a cell and stiff against their mass: as ragged as what particles make.
ViscousSample ragged_ball() {
    ViscousSample sample;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> part(-1, 1);
    std::vector<Vec3> drops;
    while (drops.size() < 600) {
        const Vec3 x{part(random), part(random), part(random)};
        const double length = std::hypot(x[0], x[1], x[2]);
        if (length < 0.1 || length > 1) continue;
        drops.push_back({0.5 + 0.41 * x[0] / length, 0.5 + 0.41 * x[1] / length, 0.5 + 0.41 * x[2] / length});
    }
    sample.cells = 26;
    sample.liquid = [=](const Vec3& x) {
        double least = ball({0.5, 0.5, 0.5}, 0.4)(x);
        if (std::fabs(least) > 0.1) return least; // far from all drops
        for (const auto& drop : drops) least = std::min(least, ball(drop, 0.02)(x));
        return least;
    };
    sample.viscosity = [](const Vec3&) { return 1e5; };
    sample.options.min_liquid_fraction = 0.1; // many stresses stand alone then
    return sample;
}

struct Applied {
    std::int64_t count;
    double most, work, unlike, strain; // of z = M r: largest; r M r; |r M s - s M r|; |K z - M/dt z| of the stiffness
};

Applied apply(const Comm& comm) {
    ViscousCase run(comm, ragged_ball());
    run.set_noise();
    run.solve(0.01);
    auto& problem = run.viscosity.problem();
    Mechanisms mechanisms;
    mechanisms.build(comm, problem.viscous_faces(), problem.system(), run.halo.owned());
    const std::size_t n = problem.rows();
    std::vector<double> r(n), s(n), z(n, 0.0), t(n, 0.0), kz(n);
    run.set_noise();
    problem.read(run.velocity, r);
    run.set_velocity([](int a, const Vec3& x) { return std::cos(77 * x[0] - 95 * x[1] + 3 * a) + x[2]; });
    problem.read(run.velocity, s);
    mechanisms.add(r, z);
    mechanisms.add(s, t);
    problem.matrix().multiply(z, kz);
    const auto face_of = on_host(problem.system().face_of());
    Applied out{mechanisms.count(), 0, 0, 0, 0};
    double left = 0, right = 0;
    for (std::size_t k = 0; k < problem.faces(); ++k) {
        const int a = face_of(k) % 3, i = face_of(k) / 3;
        const auto& faces = problem.viscous_faces();
        double stiffness = 0;
        faces.each_stress(a, i, faces.normal, faces.shear, [&](double w) { stiffness += w; });
        out.most = std::max(out.most, std::fabs(z[k]));
        out.work += r[k] * z[k];
        left += s[k] * z[k];
        right += r[k] * t[k];
        out.strain = std::max(out.strain, std::fabs(kz[k] - faces.mass.axis[a](i) * z[k]) / (1e-30 + stiffness));
    }
    out.work = comm.sum(out.work);
    out.unlike = std::fabs(comm.sum(left) - comm.sum(right)) / (std::fabs(comm.sum(left)) + out.work);
    out.most = comm.max(out.most);
    out.strain = comm.max(out.strain) / out.most;
    return out;
}

TEST(GridMechanisms, strain_nothing_and_are_the_same_on_any_ranks) {
    const auto all = apply(Comm::world()), alone = apply(Comm::self());
    EXPECT_GT(alone.count, 20);
    EXPECT_EQ(all.count, alone.count);
    for (const auto& found : {all, alone}) {
        EXPECT_GT(found.work, 0);
        EXPECT_LT(found.unlike, 1e-12);
        EXPECT_LT(found.strain, 1e-13);
    }
    EXPECT_NEAR(all.work / alone.work, 1, 1e-12);
    EXPECT_NEAR(all.most / alone.most, 1, 1e-12);
}

} // namespace
} // namespace treacle::grid::mechanisms_test
