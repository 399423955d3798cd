#pragma once
#include "app/run/simulation.hpp"
#include "app/setup/solid_points.hpp"
#include "grid/grid_step.hpp"

#include <optional>

namespace treacle::app {

// The MAC/APIC solver.
class GridSimulation final : public Simulation {
public:
    // Both must outlive this object.
    GridSimulation(const Comm& comm, const Input& input, const Geometry& geometry);

    const Comm& comm() const override { return solver_.comm(); }
    std::vector<std::string> fill(const Geometry& geometry) override;
    void restore(const RestartState& state) override;
    RestartState state() const override;
    StepDiagnostics advance(double dt) override;
    double stable_step(double cfl) const override { return solver_.stable_step(cfl); }
    void refresh() override { solver_.refresh(); }
    LiquidTotals totals() const override { return solver_.totals(); }
    ParticleStore& liquid() override { return solver_.particles().store; }
    const ParticleStore& liquid() const override { return solver_.particles().store; }
    ParticleStore* solid() override { return nullptr; }
    const ParticleStore* solid() const override { return nullptr; }
    const ParticleStore& solid_points() override;
    LiquidView view() const override;
    const rigid::RigidBodies& bodies() const override { return solver_.bodies(); }
    std::int64_t emitted() const override { return solver_.emitted(); }
    const PhaseTimers& timers() const override { return solver_.timers(); }
    std::size_t bytes() const override { return solver_.bytes(); }
    std::vector<std::string> load_names() const override;
    std::vector<std::string> columns() const override;
    std::vector<std::string> phases() const override;

private:
    std::vector<double> of_all(const std::vector<double>& resting, const std::vector<double>& moving) const;
    void look_at_solve(const grid::StokesReport& stokes, StepDiagnostics& out);

    const Input& input_;
    grid::GridStep solver_;
    const Geometry& geometry_;
    std::optional<SolidPoints> points_; // made at their first use: a run without frames needs none
    double warned_ = 0;                 // residual that the last warning was about
};

} // namespace treacle::app
