#pragma once
#include "app/run/checkpointing.hpp"
#include "base/text/csv.hpp"
#include "io/frame.hpp"

#include <optional>

namespace treacle::app {

// Beginning of a run's files: all new, or after the rows and frames that a checkpoint goes with.
enum class Opening { fresh, resumed };

// The files that a run writes while it goes: frames, steps.csv, measurements.csv, bodies.csv, the lost particles.
// Collective; tables are on rank 0.
class Outputs {
public:
    // Resumed: rows and frames later than the progress are dropped.
    // The input and the simulation must outlive this object.
    Outputs(const io::RunFolder& folder, const Input& input, Simulation& simulation, const Progress& progress,
        Opening opening);

    // The liquid's particles, with the fields of the scene's `output.fields`, id and liquid; each rank its own rows.
    void write_frame(const Progress& progress);
    // Once for a run where nothing solid moves, otherwise with every frame.
    void write_solids(const Progress& progress);
    void write_step(const Progress& progress, const StepDiagnostics& report, const LiquidTotals& totals);
    void write_measurements(const Progress& progress);
    // Loads of all solids, and where the bodies that move are.
    void write_bodies(const Progress& progress, const StepDiagnostics& report);
    // Appends the culprits to lost_particles.csv.
    void write_lost(const Progress& progress, const StepDiagnostics& report);
    void flush();
    // Blocks until the disk has all rows.
    void sync();

private:
    void resume_measurements(double time);

    Comm comm_;
    io::RunFolder folder_;
    const Input& input_;
    Simulation& simulation_;
    io::FrameWriter frames_, solid_frames_;
    std::optional<CsvTable> steps_, measurements_, bodies_, lost_;
    std::vector<double> next_measurement_; // [s] per measurement
    std::vector<double> last_measurement_;
    std::vector<std::string> phases_;
    std::vector<double> phase_seconds_; // at the last step
};

} // namespace treacle::app
