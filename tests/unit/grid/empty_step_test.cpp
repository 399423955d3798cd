#include "../sph/solver_environment.hpp"
#include "step_sample.hpp"

#include <gtest/gtest.h>

// Steps with no liquid, or none that has a pressure or a stress, on any rank or on all: liquid comes, leaves, and is held
// in gaps that are closed.
namespace treacle::grid::empty_step_test {
namespace {

[[maybe_unused]] const auto* const solvers = testing::AddGlobalTestEnvironment(new sph::SolverEnvironment);

const std::vector<Preconditioner> all_preconditioners{Preconditioner::multilevel, Preconditioner::boomeramg,
    Preconditioner::gamg, Preconditioner::incomplete_cholesky, Preconditioner::jacobi};

struct EmptyCase {
    std::string name;
    std::function<double(const Vec3&)> liquid;
};

double box(const Vec3& x, const Vec3& lower, const Vec3& upper) {
    double most = -1;
    for (std::size_t k = 0; k < 3; ++k) most = std::max({most, lower[k] - x[k], x[k] - upper[k]});
    return most;
}

// 8 cells a side, open all around, so that what falls is soon gone.
const std::vector<EmptyCase>& empty_cases() {
    static const std::vector<EmptyCase> cases{
        {"no liquid", [](const Vec3&) { return 1.0; }},
        {"one drop in the air",
            [](const Vec3& x) {
                return box(x, {0.6, 0.6, -1}, {0.66, 0.66, 2});
            }},
        {"a drop that leaves",
            [](const Vec3& x) {
                return box(x, {0.01, 0.01, -1}, {0.3, 0.1, 2});
            }},
    };
    return cases;
}

void prepare(StepSample& sample, const EmptyCase& scene, double viscosity) {
    for (auto& face : sample.setup.domain.faces) face.kind = scene::BoundaryKind::open;
    sample.liquid = scene.liquid;
    sample.setup.viscosity = viscosity;
    sample.velocity = [](const Vec3&) { return Vec3{-1, -2, 0}; };
}

void expect_to_run(const Comm& comm, const StepSample& sample, const std::string& what) {
    auto step = started(comm, sample);
    for (int k = 0; k < 4; ++k) {
        try {
            step->advance(0.02);
        } catch (const std::exception& error) {
            ADD_FAILURE() << what << ": " << error.what();
            return;
        }
    }
    for (const auto& [id, state] : states(*step)) {
        for (const double value : state) EXPECT_TRUE(std::isfinite(value)) << what;
    }
}

class EmptySteps : public testing::Test {
protected:
    const Comm comm = Comm::world();
};

TEST_F(EmptySteps, NeedNoLiquid) {
    for (const auto& scene : empty_cases()) {
        for (const int dimensions : {2, 3}) {
            for (const double viscosity : {0.0, 1.0, 1e5}) {
                for (const auto solve : {StokesSolve::split, StokesSolve::together}) {
                    auto sample = sample_of(8, dimensions);
                    prepare(sample, scene, viscosity);
                    sample.setup.options.stokes.solve = solve;
                    expect_to_run(comm, sample, scene.name + ", " + std::to_string(viscosity));
                }
            }
        }
    }
}

TEST_F(EmptySteps, NeedNoPreconditionerOfAnyKind) {
    for (const auto& scene : empty_cases()) {
        for (const auto kind : all_preconditioners) {
            for (const auto solve : {StokesSolve::split, StokesSolve::together}) {
                auto sample = sample_of(8, 2);
                prepare(sample, scene, 1);
                sample.setup.options.pressure.preconditioner = kind;
                sample.setup.options.viscosity.preconditioner = kind;
                sample.setup.options.stokes.solve = solve;
                expect_to_run(comm, sample, scene.name);
            }
        }
    }
}

// Of particles in a slot narrower than the least opening there is no face that is open, and no stress.
TEST_F(EmptySteps, LeaveLiquidInClosedGapsAlone) {
    for (const int dimensions : {2, 3}) {
        for (const auto slip : {scene::Slip::no_slip, scene::Slip::free_slip}) {
            for (const auto solve : {StokesSolve::split, StokesSolve::together}) {
                auto sample = sample_of(8, dimensions);
                const auto up = static_cast<std::size_t>(dimensions - 1);
                for (auto& face : sample.setup.domain.faces) face.slip = slip;
                rigid::BodySetup block;
                scene::Shape shape;
                shape.kind = scene::ShapeKind::box;
                shape.min = {-1, -1, -1};
                shape.max = {2, 2, 2};
                shape.min[up] = 0.005; // 4 % of a cell above the floor
                block.region = {scene::SolidRegion(shape)};
                block.bounding_radius = 4;
                sample.setup.rigid.bodies = {block};
                sample.setup.slip = {{slip}, {0}};
                sample.liquid = [=](const Vec3& x) { return x[up] - 0.06; };
                sample.jitter = 0;
                sample.setup.viscosity = 10;
                sample.setup.options.stokes.solve = solve;
                expect_to_run(comm, sample, dimensions == 2 ? "plane slot" : "slot");
            }
        }
    }
}

// As behind a narrow inlet into air: a row of cells all faces of which solids take along.
TEST_F(EmptySteps, SolveForStressesWithoutAnyPressure) {
    for (const double viscosity : {1.0, 1e4}) {
        auto sample = sample_of(8, 2);
        for (auto& face : sample.setup.domain.faces) face.kind = scene::BoundaryKind::open;
        rigid::BodySetup plug;
        scene::Shape shape;
        shape.kind = scene::ShapeKind::box;
        shape.min = {0.25, 0.55, -1};
        shape.max = {0.75, 0.8, 1};
        plug.kind = scene::BodyKind::kinematic;
        plug.velocity = {0, -0.2, 0};
        plug.region = {scene::SolidRegion(shape)};
        plug.centre = {0.5, 0.7, 0};
        plug.bounding_radius = 0.4;
        sample.setup.rigid.bodies = {plug};
        sample.setup.slip = {{scene::Slip::no_slip}, {0}};
        sample.liquid = [](const Vec3& x) { return box(x, {0.26, 0.51, -1}, {0.74, 0.55, 2}); };
        sample.jitter = 0;
        sample.setup.viscosity = viscosity;
        sample.setup.options.stokes.solve = StokesSolve::together;
        expect_to_run(comm, sample, "below a plug");
    }
}

} // namespace
} // namespace treacle::grid::empty_step_test
