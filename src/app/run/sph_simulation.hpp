#pragma once
#include "app/run/simulation.hpp"
#include "sph/isph_step.hpp"

namespace treacle::app {

// Hybrid incompressible SPH.
class SphSimulation final : public Simulation {
public:
    // The input must outlive this object.
    SphSimulation(const Comm& comm, const Input& input, double reference_speed, const Geometry& geometry);

    const Comm& comm() const override { return solver_->comm(); }
    std::vector<std::string> fill(const Geometry& geometry) override;
    void restore(const RestartState& state) override;
    RestartState state() const override;
    StepDiagnostics advance(double dt) override;
    double stable_step(double cfl) const override { return solver_->stable_step(cfl); }
    void refresh() override { solver_->refresh(); }
    LiquidTotals totals() const override;
    ParticleStore& liquid() override { return solver_->liquid().store; }
    const ParticleStore& liquid() const override { return solver_->liquid().store; }
    ParticleStore* solid() override { return &solver_->solid().store; }
    const ParticleStore* solid() const override { return &solver_->solid().store; }
    const ParticleStore& solid_points() override { return solver_->solid().store; }
    LiquidView view() const override;
    const rigid::RigidBodies& bodies() const override { return solver_->bodies(); }
    std::int64_t emitted() const override { return solver_->emitted(); }
    const PhaseTimers& timers() const override { return solver_->timers(); }
    std::size_t bytes() const override { return solver_->bytes(); }
    std::vector<std::string> load_names() const override;
    std::vector<std::string> columns() const override;
    std::vector<std::string> phases() const override;

private:
    const Input& input_;
    std::unique_ptr<sph::IsphStep> solver_;
};

} // namespace treacle::app
