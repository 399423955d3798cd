#include "../sph/solver_environment.hpp"
#include "step_sample.hpp"

#include <gtest/gtest.h>

// What slips does not stick, and drags nothing along; what touches bodies alone keeps the momentum of all together.
namespace treacle::grid::slip_test {
namespace {

[[maybe_unused]] const auto* const solvers = testing::AddGlobalTestEnvironment(new sph::SolverEnvironment);

rigid::BodySetup body_of(scene::BodyKind kind, const scene::Shape& shape, const Vec3& centre) {
    rigid::BodySetup body;
    body.kind = kind;
    body.centre = centre;
    body.region = {scene::SolidRegion(shape)};
    body.bounding_radius = 10;
    return body;
}

scene::Shape drum(const Vec3& centre, double radius) {
    scene::Shape shape;
    shape.kind = scene::ShapeKind::sphere;
    shape.centre = centre;
    shape.radius = radius;
    shape.inverted = true;
    return shape;
}

// A stiff block on a plane at an angle through any place of the cells, 2 x 1 m, cells of 4 cm.
TEST(FreeSlip, LetsABlockSlideDownARamp) {
    struct Case {
        double degrees, shift, viscosity;
    };
    for (const auto& [degrees, shift, viscosity] :
        {Case{30, 0.007, 1000}, Case{30, 0.5, 1e5}, Case{12, 0.03, 1e6}, Case{45, 0, 10}, Case{52, 0.31, 1e5}}) {
        auto sample = sample_of(25, 2);
        const double angle = degrees * math::pi / 180;
        const Vec3 normal{std::sin(angle), std::cos(angle), 0}, point{0.4, 0.5 + 0.04 * shift, 0};
        sample.setup.domain.max = {1.2, 1.2, 0};
        for (auto& face : sample.setup.domain.faces) face.kind = scene::BoundaryKind::open;
        sample.setup.viscosity = viscosity;
        scene::Shape plane;
        plane.kind = scene::ShapeKind::plane;
        plane.centre = point;
        plane.axis = normal;
        sample.setup.rigid.bodies = {body_of(scene::BodyKind::fixed, plane, point)};
        sample.setup.slip = {{scene::Slip::free_slip}, {0}};
        const auto above = [=](const Vec3& x) { return normal[0] * (x[0] - point[0]) + normal[1] * (x[1] - point[1]); };
        const auto along = [=](const Vec3& x) { return normal[1] * (x[0] - point[0]) - normal[0] * (x[1] - point[1]); };
        // A block that lies on the ramp: it does nothing but slide.
        sample.liquid = [=](const Vec3& x) { return std::max({std::fabs(along(x)) - 0.2, above(x) - 0.2, -above(x)}); };
        auto step = started(Comm::world(), sample);
        double time = 0;
        while (time < 0.2) time += step->advance(step->stable_step(3)).dt;
        const auto totals = step->totals();
        const Vec3 u{totals.momentum[0] / totals.mass, totals.momentum[1] / totals.mass, 0};
        EXPECT_NEAR((normal[1] * u[0] - normal[0] * u[1]) / (9.81 * std::sin(angle) * time), 1, 0.04)
            << degrees << " " << shift << " " << viscosity;
    }
}

// A free-slip drum of radius 0.4, full of liquid, around (0.5, 0.5) + (1, 0.6) shift.
StepSample drum_of(double viscosity, scene::BodyKind kind, double angular_velocity, double shift = 0) {
    auto sample = sample_of(40, 2);
    sample.setup.domain.gravity = sample.setup.rigid.gravity = {0, 0, 0};
    sample.setup.viscosity = viscosity;
    const Vec3 centre{0.5 + shift, 0.5 + 0.6 * shift, 0};
    auto body = body_of(kind, drum(centre, 0.4), centre);
    body.angular_velocity = {0, 0, angular_velocity};
    sample.setup.rigid.bodies = {body};
    sample.setup.slip = {{scene::Slip::free_slip}, {0}};
    sample.liquid = [centre](const Vec3& x) { return std::hypot(x[0] - centre[0], x[1] - centre[1]) - 0.4; };
    return sample;
}

// Of the drum's liquid, as of a disc that turns as a whole [rad/s].
double spin_of(const LiquidTotals& totals) {
    return (totals.angular_momentum[2] - 0.5 * totals.momentum[1] + 0.5 * totals.momentum[0]) /
           (0.5 * totals.mass * 0.16);
}

// Crossings of the cells' edges, normals of the wall and the bend of what flows along it are of second order: at first order each of them
// is a flow across the wall of some tenth of its speed, which turns stiff liquid.
TEST(FreeSlip, DrumsTurnAroundLiquidAtRest) {
    for (const double viscosity : {0.0, 100.0, 1e5, 1e6}) {
        for (const double place : {0.0, 0.25, 0.5}) {
            auto step = started(Comm::world(), drum_of(viscosity, scene::BodyKind::kinematic, 12, 0.025 * place));
            for (int k = 0; k < 20; ++k) step->advance(0.01);
            const auto totals = step->totals();
            EXPECT_LT(std::fabs(spin_of(totals)), 0.01 * 12) << viscosity << " Pa s, " << place << " of a cell";
            EXPECT_LT(totals.kinetic_energy, 1e-3 * 0.25 * totals.mass * 0.16 * 144) << viscosity;
        }
    }
}

// Wherever the cells cut the drum, moving or at rest: the pressure's inverse of every cut cell has the viscosity.
TEST(FreeSlip, DrumsTakeFewIterations) {
    for (const auto kind : {scene::BodyKind::kinematic, scene::BodyKind::fixed}) {
        for (const double place : {0.1, 0.25, 0.4}) {
            for (const double viscosity : {1e3, 1e5, 1e6}) {
                const double speed = kind == scene::BodyKind::kinematic ? 12 : 0;
                auto sample = drum_of(viscosity, kind, speed, 0.025 * place);
                sample.velocity = [](const Vec3& x) { return Vec3{std::sin(9 * x[1]), std::sin(9 * x[0]), 0}; };
                const auto report = started(Comm::world(), sample)->advance(0.01);
                EXPECT_GT(report.stokes.solve.iterations, 0);
                EXPECT_LE(report.stokes.solve.iterations, 35) << viscosity << " Pa s, " << place << " of a cell";
            }
        }
    }
}

// A face's middle is not that of its open part: with fluxes of the former a turn crosses the wall, and the liquid keeps 0.82 at 1e5 Pa s and
// 0.17 at 1e6.
TEST(FreeSlip, DrumsAtRestLetLiquidTurn) {
    for (const double viscosity : {1.0, 100.0, 1e4, 1e5, 1e6}) {
        auto sample = drum_of(viscosity, scene::BodyKind::fixed, 0);
        sample.velocity = [](const Vec3& x) { return Vec3{-3 * (x[1] - 0.5), 3 * (x[0] - 0.5), 0}; };
        sample.gradient = {{{0, -3, 0}, {3, 0, 0}, {0, 0, 0}}};
        auto step = started(Comm::world(), sample);
        double time = 0;
        while (time < 0.333) time += step->advance(0.0333).dt;
        EXPECT_GT(spin_of(step->totals()), 0.99 * 3) << viscosity;
    }
}

// A free-slip vessel of 8 cells radius, full of liquid that turns at `liquid` rad/s; it turns at `vessel` rad/s, or rests.
StepSample round_vessel_of(double viscosity, double liquid, double vessel, double place) {
    auto sample = sample_of(20, 3);
    const double shift = 0.05 * place;
    const Vec3 centre{0.5 + shift, 0.5 + 0.6 * shift, 0.5 - 0.3 * shift};
    sample.setup.domain.gravity = sample.setup.rigid.gravity = {0, 0, 0};
    sample.setup.viscosity = viscosity;
    auto body = body_of(vessel != 0 ? scene::BodyKind::kinematic : scene::BodyKind::fixed, drum(centre, 0.4), centre);
    body.angular_velocity = {0, 0, vessel};
    sample.setup.rigid.bodies = {body};
    sample.setup.slip = {{scene::Slip::free_slip}, {0}};
    sample.liquid = [centre](const Vec3& x) {
        return std::hypot(x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]) - 0.4;
    };
    sample.velocity = [=](const Vec3& x) { return Vec3{-liquid * (x[1] - centre[1]), liquid * (x[0] - centre[0]), 0}; };
    sample.gradient = {{{0, -liquid, 0}, {liquid, 0, 0}, {0, 0, 0}}};
    return sample;
}

// Angular momentum along z about the middle of that vessel over that at 1 rad/s [rad/s].
double ball_spin_of(const LiquidTotals& totals, double place) {
    const double shift = 0.05 * place;
    const double about =
        totals.angular_momentum[2] - (0.5 + shift) * totals.momentum[1] + (0.5 + 0.6 * shift) * totals.momentum[0];
    return about / (0.4 * totals.mass * 0.16);
}

// The same in space, where the open part of a face has its middle off by both axes, and the solid's edge on it is no straight line: with areas
// by chords 1e6 Pa s keep 0.03, with fluxes of the faces' middles it stops within a step.
TEST(FreeSlip, RoundVesselsLetLiquidTurn) {
    struct Case {
        double viscosity, place, lost;
    };
    for (const auto& [viscosity, place, lost] :
        {Case{1, 0.35, 0.02}, {1e5, 0, 0.02}, {1e5, 0.35, 0.02}, {1e6, 0.35, 0.1}}) {
        auto step = started(Comm::world(), round_vessel_of(viscosity, 3, 0, place));
        const double before = ball_spin_of(step->totals(), place);
        int iterations = 0;
        for (int k = 0; k < 6; ++k) iterations = std::max(iterations, step->advance(0.0333).stokes.solve.iterations);
        EXPECT_NEAR(ball_spin_of(step->totals(), place) / before, 1, lost) << viscosity << " " << place;
        EXPECT_LE(iterations, 40) << viscosity << " " << place;
    }
}

TEST(FreeSlip, RoundVesselsTurnAroundLiquidAtRest) {
    for (const double viscosity : {1.0, 1e6}) {
        auto step = started(Comm::world(), round_vessel_of(viscosity, 0, 12, 0.35));
        for (int k = 0; k < 10; ++k) step->advance(0.01);
        EXPECT_LT(std::fabs(ball_spin_of(step->totals(), 0.35)), 0.02 * 12) << viscosity;
    }
}

// Water falls flat onto the floor and meets a slab that rises, in steps of three cells: whatever meets has room. Drops that fly from
// there are a matter of chance, so that it is asked of several falls.
TEST(Gaps, CloseWithoutHeapingUpLiquid) {
    double sum = 0, most = 0;
    int heaps = 0;
    constexpr int falls = 12;
    for (int k = 0; k < falls; ++k) {
        const double shift = 0.1 * (k % 10), speed = 2 + 0.13 * (k % 6);
        auto sample = sample_of(20, 2);
        sample.jitter = 0.1 + 0.02 * (k % 7);
        sample.setup.domain.gravity = sample.setup.rigid.gravity = {0, 0, 0};
        sample.liquid = [=](const Vec3& x) {
            const double y = x[1] - 0.05 * shift;
            return std::min(std::max(y - 0.35, 0.2 - y), std::max(y - 0.9, 0.6 - y));
        };
        sample.velocity = [=](const Vec3& x) { return Vec3{0, x[1] > 0.5 ? -speed : 1.0, 0}; };
        auto step = started(Comm::world(), sample);
        double time = 0, worst = 0;
        while (time < 0.5) {
            const auto report = step->advance(step->stable_step(3));
            time += report.dt;
            worst = std::max(worst, report.correction.density_before);
        }
        sum += worst;
        most = std::max(most, worst);
        heaps += worst < 1.5 ? 0 : 1;
    }
    EXPECT_LE(heaps, 1);
    EXPECT_LT(sum / falls, 1);
    EXPECT_LT(most, 2);
}

// A drop and a plate that meet at 2 m/s in steps of three cells, one of them at rest: `thickness` of the plate and `place` of its upper side
// in cells; `comes`: the plate moves. Returns how many particles end behind it.
double behind_plate(double thickness, double place, bool comes) {
    auto sample = sample_of(20, 2);
    sample.setup.domain.gravity = sample.setup.rigid.gravity = {0, 0, 0};
    const double speed = 2, end = 0.16, top = 0.4 + 0.05 * place - (comes ? 0.1 : 0), bottom = top - 0.05 * thickness;
    scene::Shape plate;
    plate.kind = scene::ShapeKind::box;
    plate.min = {0.1, bottom, -1};
    plate.max = {0.9, top, 1};
    const Vec3 middle{0.5, 0.5 * (bottom + top), 0};
    auto body = body_of(comes ? scene::BodyKind::kinematic : scene::BodyKind::fixed, plate, middle);
    body.velocity = {0, comes ? speed : 0, 0};
    sample.setup.rigid.bodies = {body};
    sample.setup.slip = {{scene::Slip::free_slip}, {0}};
    sample.liquid = [](const Vec3& x) { return std::hypot(x[0] - 0.45, x[1] - 0.65) - 0.12; };
    sample.velocity = [=](const Vec3&) { return Vec3{0.6 * place, comes ? 0 : -speed, 0}; };
    auto step = started(Comm::world(), sample);
    double time = 0, behind = 0;
    while (time < end) time += step->advance(step->stable_step(3)).dt;
    const auto x = step->particles().position();
    const double there = middle[1] + body.velocity[1] * time;
    for (int i = 0; i < step->particles().store.owned(); ++i)
        behind += std::fabs(x(i, 0) - 0.5) < 0.38 && x(i, 1) < there ? 1 : 0;
    return step->comm().sum(behind);
}

// Particles that were pushed out of a thin plate where they would have ended left it on the other side.
TEST(ThinPlates, KeepDropsOnTheirSide) {
    for (const double thickness : {0.75, 1.0, 1.5, 2.0, 3.0}) {
        for (const double place : {0.0, 0.15, 0.3, 0.5, 0.7, 0.85}) {
            for (const bool comes : {false, true})
                EXPECT_EQ(behind_plate(thickness, place, comes), 0) << thickness << " " << place << " " << comes;
        }
    }
}

} // namespace
} // namespace treacle::grid::slip_test
