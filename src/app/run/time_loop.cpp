#include "app/run/time_loop.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "io/manifest.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <sys/resource.h>

namespace treacle::app {

namespace {
// Times closer than this share of the run count as equal.
constexpr double same_time = 1e-10;

double with_tolerance(double time) { return time * (1 + same_time) + 1e-300; }

constexpr const char* cause_words[loss_causes] = {
    "flowed out", "went through a wall", "were no longer finite", "left through an open side"};

std::int64_t lost_against_limit(const Progress& progress) {
    return std::accumulate(progress.lost.begin() + 1, progress.lost.end(), std::int64_t{0}); // all but what flowed out
}

// A step, or the least step, that the scene states and a limit forbids.
void check_limit(
    const scene::Time& time, double limit, const std::string& of, const std::string& why, const std::string& cure) {
    const double step = time.rule == scene::StepRule::fixed ? time.step : 0;
    if (std::max(step, time.min_step) <= limit) return;
    const auto [given, most] = tell_apart(std::max(step, time.min_step), limit);
    throw InputError({time.where,
        std::string("time.") + (step > 0 ? "step" : "min_step") + " = " + given + " s is above the limit of the " + of +
            ", " + most + " s",
        why, cure});
}
} // namespace

void check_time_step(const Input& input) {
    if (input.on_grid()) return; // its steps follow what limits them
    const auto& time = input.scene.time;
    const double tension = input.scene.liquids.front().surface_tension;
    check_limit(time, capillary_step_limit(input), "surface tension",
        "waves as short as a few spacings move by " + format_number(tension) + " N/m",
        "take a step below the limit, or a larger spacing");
    if (viscosity_integration(input) == sph::ViscosityIntegration::implicit) return;
    check_limit(time, viscous_step_limit(input), "explicit viscosity",
        "a viscosity of " + format_number(limiting_viscosity(input)) + " Pa s is integrated explicitly",
        "take a step below the limit, or leave out method.viscosity.integration: explicit");
}

TimeLoop::TimeLoop(LoopSetup setup, std::unique_ptr<Simulation> solver, const Progress& progress)
    : setup_(std::move(setup)), solver_(std::move(solver)), progress_(progress),
      stop_(setup_.comm, setup_.folder.stop(), setup_.wall_limit),
      log_(setup_.comm.is_root() ? setup_.company.log_output : LogOutput::disabled), next_line_(progress.time),
      start_time_(progress.time), next_wall_save_(setup_.input.scene.output.checkpoint_wall_interval),
      start_step_(progress.step) {}

bool TimeLoop::finished() const {
    const double end = setup_.input.scene.time.end;
    return progress_.time >= end * (1 - same_time);
}

// With the CFL rule steps end exactly on the times of frames: the way to the next one is divided evenly.
double TimeLoop::choose_step() const {
    const auto& time = setup_.input.scene.time;
    if (time.rule == scene::StepRule::fixed) return time.step;
    double dt = solver_->stable_step(time.cfl);
    if (time.step > 0) dt = std::min(dt, time.step);
    if (!(dt >= time.min_step)) {
        throw SimulationError({"time step", "the stable step has fallen to " + format_number(dt) + " s",
            "the liquid has become too fast for time.min_step = " + format_number(time.min_step) + " s",
            "look at the last frame for particles that fly off; a smaller time.cfl may help"});
    }
    double target = time.end;
    target = std::min(target, next_frame_);
    const double way = target - progress_.time;
    // The step dt is infinite where nothing moves and nothing pulls.
    if (way <= time.min_step)
        return std::min({dt, time.end, setup_.input.scene.output.next_frame(target) - progress_.time});
    return way / std::max(1.0, std::ceil(way / dt * (1 - same_time)));
}

void TimeLoop::check_losses(const StepDiagnostics& report, Outputs& outputs) {
    std::int64_t gone = 0;
    for (std::size_t k = 0; k < loss_causes; ++k) {
        progress_.lost[k] += report.lost_by_cause[k];
        gone += report.lost_by_cause[k];
    }
    stale_ = gone > 0;
    if (gone == report.lost_by_cause[static_cast<std::size_t>(LossCause::outflow) - 1]) return;
    outputs.write_lost(progress_, report);
    const double limit =
        setup_.input.scene.max_lost_fraction * double(progress_.initial_particles + solver_->emitted());
    if (double(lost_against_limit(progress_)) <= limit) return;
    const auto through_sides = progress_.lost[static_cast<std::size_t>(LossCause::open_side) - 1];
    std::string causes;
    for (std::size_t k = 1; k < loss_causes; ++k) {
        if (progress_.lost[k] == 0) continue;
        causes += (causes.empty() ? "" : ", ") + std::to_string(progress_.lost[k]) + " " + cause_words[k];
    }
    throw SimulationError({"step " + std::to_string(progress_.step),
        std::to_string(lost_against_limit(progress_)) + " particles are lost: " + causes,
        "max_lost_fraction allows " + format_number(limit) + "; the culprits are in " +
            setup_.folder.lost_particles().string(),
        through_sides > 0 ? "where liquid may leave, write for the side {kind: open, outflow: true}; else take a "
                            "smaller time step, or raise max_lost_fraction"
                          : "take a smaller time step, or raise max_lost_fraction"});
}

// Tables first: after a crash the checkpoint's step and all before it stand in them.
void TimeLoop::save(Outputs& outputs) {
    outputs.sync();
    auto progress = progress_;
    progress.wall_seconds += stop_.wall_seconds();
    save_checkpoint(setup_.folder, setup_.input, setup_.state_hash, progress, *solver_);
    saved_step_ = progress_.step;
}

bool TimeLoop::keeps_checkpoints() const {
    const auto& output = setup_.input.scene.output;
    return output.checkpoint_interval > 0 || output.checkpoint_wall_interval > 0;
}

// Frames and checkpoints that were due so far, by intervals that may be others than before the run went on.
void TimeLoop::count_due() {
    const auto& output = setup_.input.scene.output;
    const double now = with_tolerance(progress_.time);
    next_frame_ = output.next_frame(now);
    if (output.checkpoint_interval > 0) {
        progress_.checkpoints = static_cast<std::int64_t>(std::floor(now / output.checkpoint_interval));
    }
}

// The end of the run has a frame, and a checkpoint to go on from when there are any, whatever their intervals.
void TimeLoop::write_due(Outputs& outputs, const StepDiagnostics& report) {
    const auto& output = setup_.input.scene.output;
    const double now = with_tolerance(progress_.time);
    bool line = finished();
    if (output.has_frames() && (now >= next_frame_ || finished())) {
        if (stale_) solver_->refresh();
        outputs.write_frame(progress_);
        outputs.write_solids(progress_);
        next_frame_ = output.next_frame(now);
        line = line || output.log_interval == 0;
        if (setup_.company.told_enough && !finished()) told_enough_ = setup_.company.told_enough();
    }
    if (output.log_interval > 0 && now >= next_line_) {
        next_line_ += output.log_interval;
        line = true;
    }
    if (line) report_progress(report);
    bool due = finished() && keeps_checkpoints();
    if (output.checkpoint_interval > 0 && now >= output.checkpoint_interval * double(progress_.checkpoints + 1)) {
        progress_.checkpoints = static_cast<std::int64_t>(std::floor(now / output.checkpoint_interval));
        due = true;
    }
    if (output.checkpoint_wall_interval > 0 && setup_.comm.max(stop_.wall_seconds()) >= next_wall_save_) {
        next_wall_save_ += output.checkpoint_wall_interval;
        due = true;
    }
    if (due) save(outputs);
}

void TimeLoop::report_progress(const StepDiagnostics& report) {
    const double end = setup_.input.scene.time.end;
    const double done = progress_.time / end;
    const double rate = (progress_.time - start_time_) / std::max(1e-9, stop_.wall_seconds());
    const double left = rate > 0 ? (end - progress_.time) / rate : 0;
    char text[256];
    std::snprintf(text, sizeof text,
        "step %6lld  t %.5g s  dt %.3g s  its %3d  particles %lld  lost %lld  max speed %.3g m/s  %3.0f %%  ",
        static_cast<long long>(progress_.step), progress_.time, report.dt, report.pressure_iterations,
        static_cast<long long>(totals_.particles), static_cast<long long>(lost_against_limit(progress_)),
        totals_.max_speed, 100 * done);
    log_.line(text + format_duration(left) + " left");
}

void TimeLoop::take_step(Outputs& outputs) {
    const double dt = choose_step();
    const auto report = solver_->advance(dt);
    ++progress_.step;
    progress_.time += report.dt; // shorter than stated where the liquid became too fast
    iterations_ += report.pressure_iterations;
    for (const auto& warning : report.warnings) log_.warn("step " + std::to_string(progress_.step) + ": " + warning);
    check_losses(report, outputs);
    totals_ = solver_->totals();
    if (!std::isfinite(totals_.kinetic_energy)) {
        throw SimulationError({"step " + std::to_string(progress_.step), "the kinetic energy is not finite",
            "velocities have grown without bound", "take a smaller time step"});
    }
    outputs.write_step(progress_, report, totals_);
    outputs.write_bodies(progress_, report);
    outputs.write_measurements(progress_);
    outputs.flush(); // each step is shown while the user watches the run
    write_due(outputs, report);
}

void TimeLoop::write_summary(const std::string& how_it_ended) {
    const auto& comm = setup_.comm;
    struct rusage usage {};
    getrusage(RUSAGE_SELF, &usage);
    const double peak = 1024.0 * double(usage.ru_maxrss);
    using io::Value;
    Value summary = Value::object({{"ended", how_it_ended}, {"steps", progress_.step}, {"time [s]", progress_.time},
        {"particles at the start", progress_.initial_particles}, {"particles that flowed in", solver_->emitted()},
        {"particles that flowed out", progress_.lost[0]}, {"particles", totals_.particles},
        {"maximum speed [m/s]", totals_.max_speed}, {"kinetic energy [J]", totals_.kinetic_energy},
        {"potential energy [J]", totals_.potential_energy}, {"pressure iterations in this sitting", iterations_},
        {"ranks", comm.size()}});
    Value lost = Value::object({});
    for (std::size_t k = 1; k < loss_causes; ++k) lost.set(cause_words[k], progress_.lost[k]);
    summary.set("lost particles", lost);
    const auto spread = [&](double value) {
        return Value::object(
            {{"min", comm.min(value)}, {"mean", comm.sum(value) / comm.size()}, {"max", comm.max(value)}});
    };
    Value phases = Value::object({});
    for (const auto& phase : solver_->timers().phases()) phases.set(phase.name, spread(phase.seconds));
    summary.set("seconds per phase", phases);
    const double sitting = stop_.wall_seconds();
    summary.set("wall time of this sitting [s]", comm.max(sitting));
    summary.set("wall time [s]", comm.max(sitting + progress_.wall_seconds));
    summary.set("peak memory per rank [bytes]", spread(peak));
    summary.set("memory of particles, lists and matrix per rank [bytes]", spread(double(solver_->bytes())));
    io::write_summary(comm, setup_.folder.summary(), summary);
}

ExitCode TimeLoop::run(Opening opening) {
    totals_ = solver_->totals();
    Outputs outputs(setup_.folder, setup_.input, *solver_, progress_, opening);
    if (opening == Opening::fresh) {
        if (setup_.folder.lock && !setup_.folder.lock->warning().empty()) log_.warn(setup_.folder.lock->warning());
        progress_.initial_particles = totals_.particles - solver_->emitted();
        progress_.initial_mass = totals_.mass;
        const std::int64_t solids = solver_->solid() ? setup_.comm.sum(std::int64_t{solver_->solid()->owned()}) : 0;
        log_.line(std::to_string(totals_.particles) + " liquid" +
                  (solver_->solid() ? " and " + std::to_string(solids) + " solid" : std::string()) + " particles on " +
                  std::to_string(setup_.comm.size()) + " ranks");
        if (setup_.input.scene.output.has_frames()) {
            solver_->refresh();
            outputs.write_solids(progress_);
            outputs.write_frame(progress_);
        }
        outputs.write_measurements(progress_);
    }
    count_due();
    auto reason = StopControl::Reason::none;
    while (!finished() && !told_enough_ && reason == StopControl::Reason::none) {
        take_step(outputs);
        if (setup_.company.between_steps) setup_.company.between_steps();
        reason = stop_.ask();
    }
    outputs.flush();
    if (finished()) {
        write_summary("finished");
        log_.line("finished: " + setup_.folder.root.string());
        return ExitCode::ok;
    }
    if (told_enough_) {
        write_summary("ended early");
        log_.line("ended early: " + setup_.folder.root.string());
        return ExitCode::ok;
    }
    if (saved_step_ != progress_.step) save(outputs);
    stop_.clear();
    write_summary("stopped by " + describe(reason));
    log_.line("stopped by " + describe(reason) + " with a checkpoint; go on with treacle resume " +
              setup_.folder.root.string());
    return ExitCode::stopped;
}

} // namespace treacle::app
