#pragma once
#include "app/run/simulation.hpp"
#include "io/run_folder.hpp"

namespace treacle::app {

// Progress of a run, besides its particles: everything that the time loop needs to go on as if it had not stopped.
struct Progress {
    std::int64_t step = 0;
    double time = 0;              // [s]
    std::int64_t checkpoints = 0; // due by simulated time so far
    double reference_speed = 0;   // [m/s]
    double initial_mass = 0;      // [kg]
    std::int64_t initial_particles = 0;
    std::array<std::int64_t, loss_causes> lost{}; // by cause
    double wall_seconds = 0;                      // of earlier sessions
};

// Collective: writes a checkpoint of all state fields, keeps the last ones, removes older ones.
void save_checkpoint(const io::RunFolder& folder, const Input& input, const std::string& state_hash,
    const Progress& progress, const Simulation& solver);

// Collective: reads the newest valid checkpoint into a solver without particles and starts it. `report` gets a
// message for each broken checkpoint that was skipped. Throws InputError when there is none, or when it belongs
// to another scene.
struct Checkpoint {
    Progress progress;
    std::filesystem::path path;
    std::vector<std::string> skipped;
};
Checkpoint find_checkpoint(const Comm& comm, const io::RunFolder& folder, const std::string& state_hash);
void load_checkpoint(const Checkpoint& checkpoint, Simulation& solver);

} // namespace treacle::app
