#pragma once
#include "app/input/company.hpp"
#include "app/run/outputs.hpp"
#include "app/run/stop_control.hpp"
#include "base/text/error.hpp"

namespace treacle::app {

// Everything that a TimeLoop needs beside the simulation and the progress.
struct LoopSetup {
    Comm comm;              // of the run's ranks
    io::RunFolder folder;   // exists on all ranks
    Input input;            // validated
    std::string state_hash; // of continuation.hpp
    double wall_limit = 0;  // [s]
    Company company;        // log and callbacks of a caller in the same process
};

// Carries a run from where its progress stands to its end, with all output on the way.
class TimeLoop {
public:
    TimeLoop(LoopSetup setup, std::unique_ptr<Simulation> solver, const Progress& progress);

    // Collective. Returns ok or stopped; throws SimulationError when the run fails, the last checkpoint and all
    // earlier output intact.
    ExitCode run(Opening opening);
    Log& log() { return log_; }

private:
    double choose_step() const;
    void take_step(Outputs& outputs);
    void check_losses(const StepDiagnostics& report, Outputs& outputs);
    void write_due(Outputs& outputs, const StepDiagnostics& report);
    void save(Outputs& outputs);
    void count_due();
    bool keeps_checkpoints() const;
    void report_progress(const StepDiagnostics& report);
    void write_summary(const std::string& how_it_ended);
    bool finished() const;

    LoopSetup setup_;
    std::unique_ptr<Simulation> solver_;
    Progress progress_;
    StopControl stop_;
    Log log_;
    LiquidTotals totals_;
    double next_frame_ = 0;     // [s] simulated
    double next_line_ = 0;      // [s] simulated
    double start_time_ = 0;     // [s] simulated, of this session
    double next_wall_save_ = 0; // [s] of the clock
    std::int64_t start_step_ = 0;
    std::int64_t saved_step_ = -1; // of the newest checkpoint
    bool told_enough_ = false;
    bool stale_ = false; // particles were taken out after the densities had been computed
    std::int64_t iterations_ = 0;
};

// Throws InputError when a fixed step is above the limit of the explicit viscosity.
void check_time_step(const Input& input);

} // namespace treacle::app
