#include "grid/viscosity/viscosity.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "grid/viscosity/viscous_problem.hpp"

#include <algorithm>

namespace treacle::grid {

struct Viscosity::State {
    ViscousProblem problem;
    std::vector<double> b, x, scratch;

    void choose_guess(const Comm& comm);
};

// The velocities of before, unless nothing at all has the smaller residual: what is not smooth strains a high-viscosity liquid.
void Viscosity::State::choose_guess(const Comm& comm) {
    scratch.resize(x.size());
    problem.matrix().multiply(x, scratch);
    std::array<double, 2> squares{0, 0};
    for (std::size_t k = 0; k < x.size(); ++k) {
        squares[0] += (b[k] - scratch[k]) * (b[k] - scratch[k]);
        squares[1] += b[k] * b[k];
    }
    comm.sum(std::span<double>(squares));
    if (!(squares[0] < squares[1])) std::fill(x.begin(), x.end(), 0.0);
}

Viscosity::Viscosity(const Comm& comm, ViscosityOptions options, Coupling coupling)
    : comm_(comm), options_(options), state_(new State{{comm, options, coupling}, {}, {}, {}}) {}
Viscosity::~Viscosity() = default;

ViscosityReport Viscosity::solve(
    const ViscousScene& scene, const FaceField& velocity, rigid::RigidBodies& bodies, double dt) {
    auto& [problem, b, x, scratch] = *state_;
    problem.build(scene, velocity, bodies, dt);
    b.assign(problem.rows(), 0.0);
    x.assign(problem.rows(), 0.0);
    problem.right_hand_side(velocity, b);
    problem.read(velocity, x);
    state_->choose_guess(comm_);
    ViscosityReport report;
    report.unknowns = problem.global_faces();
    report.entries = comm_.sum(problem.matrix().entries());
    report.solve = problem.solve(b, x, solve::ConvergenceTest::residual(options_.residual));
    if (!report.solve.converged()) {
        throw SimulationError({"method.viscosity", report.solve.reason,
            "the viscous system of " + std::to_string(report.unknowns) +
                " faces has not been solved: relative residual " + format_number(report.solve.relative_residual) +
                " after " + std::to_string(report.solve.iterations) + " iterations",
            "take a smaller time step, another preconditioner, or a larger residual"});
    }
    report.loads = problem.apply(scene, x, {}, velocity, bodies);
    return report;
}

ViscousProblem& Viscosity::problem() { return state_->problem; }
solve::Matrix* Viscosity::matrix() { return state_->problem.built() ? &state_->problem.matrix() : nullptr; }
std::span<const double> Viscosity::right_hand_side() const { return state_->b; }

std::size_t Viscosity::bytes() const {
    const auto& s = *state_;
    return s.problem.bytes() + 8 * (s.b.capacity() + s.x.capacity() + s.scratch.capacity());
}

} // namespace treacle::grid
