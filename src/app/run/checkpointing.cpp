#include "app/run/checkpointing.hpp"

#include "app/input/host_rows.hpp"
#include "base/text/error.hpp"
#include "io/checkpoint/checkpoint.hpp"

namespace treacle::app {

namespace {
constexpr const char* cause_names[loss_causes] = {"lost_outflow", "lost_leak", "lost_non_finite", "lost_open_side"};

void add_store(io::CheckpointWriter& writer, const std::string& prefix, const ParticleStore& store) {
    for (const auto& field : store.fields()) {
        if (field.role != FieldRole::state) continue;
        std::visit(
            [&](const auto& view) {
                writer.distributed(prefix + "/" + field.name, components(field), host_rows(view, store.owned()));
            },
            field.array);
    }
}

void read_store(const io::CheckpointReader& reader, const std::string& prefix, ParticleStore& store) {
    bool sized = false;
    for (auto& field : store.fields()) {
        if (field.role != FieldRole::state) continue;
        const auto name = prefix + "/" + field.name;
        const auto fill = [&](const auto& rows) {
            if (!sized) store.resize_owned(static_cast<int>(rows.size()));
            sized = true;
            std::visit([&](const auto& view) { set_rows(view, rows.values); }, field.array);
        };
        const bool real =
            std::holds_alternative<Array<double>>(field.array) || std::holds_alternative<Array3>(field.array);
        if (real) {
            fill(reader.distributed<double>(name));
        } else {
            fill(reader.distributed<std::int64_t>(name));
        }
    }
}
} // namespace

namespace {

void write_progress(io::CheckpointWriter& writer, const Progress& progress) {
    writer.attribute("step", progress.step);
    writer.attribute("time", progress.time);
    writer.attribute("checkpoints", progress.checkpoints);
    writer.attribute("reference_speed", progress.reference_speed);
    writer.attribute("initial_mass", progress.initial_mass);
    writer.attribute("initial_particles", progress.initial_particles);
    writer.attribute("wall_seconds", progress.wall_seconds);
    for (std::size_t k = 0; k < loss_causes; ++k) writer.attribute(cause_names[k], progress.lost[k]);
}

} // namespace

void save_checkpoint(const io::RunFolder& folder, const Input& input, const std::string& state_hash,
    const Progress& progress, const Simulation& solver) {
    const auto& comm = solver.comm();
    io::CheckpointWriter writer(comm, io::checkpoint_path(folder.checkpoints(), progress.step));
    writer.attribute("scene", state_hash);
    write_progress(writer, progress);
    const auto state = solver.state();
    writer.replicated("decomposition", std::span<const std::int64_t>(state.decomposition));
    writer.replicated("bodies", std::span<const double>(state.bodies));
    if (!state.history.empty()) writer.replicated("history", std::span<const double>(state.history));
    add_store(writer, "liquid", solver.liquid());
    if (solver.solid()) add_store(writer, "solid", *solver.solid());
    writer.commit();
    io::keep_last_checkpoints(comm, folder.checkpoints(), input.scene.output.checkpoints_kept);
}

Checkpoint find_checkpoint(const Comm& comm, const io::RunFolder& folder, const std::string& state_hash) {
    const auto newest = io::newest_valid_checkpoint(comm, folder.checkpoints());
    Checkpoint out;
    out.skipped = newest.skipped;
    if (!newest.path) {
        std::string reason = "checkpoints are written when output.checkpoint_interval is set, or on request";
        for (const auto& message : newest.skipped) reason += "; " + message;
        throw InputError({folder.checkpoints().string(), "there is no valid checkpoint to go on from", reason,
            "start anew with treacle run"});
    }
    out.path = *newest.path;
    const io::CheckpointReader reader(comm, out.path);
    if (reader.attribute<std::string>("scene") != state_hash) {
        throw InputError({out.path.string(), "this checkpoint belongs to another scene",
            "effective.yaml of the folder is not the scene that it was written from",
            "put back the effective.yaml of the run, or start anew with treacle run"});
    }
    auto& progress = out.progress;
    progress.step = reader.attribute<std::int64_t>("step");
    progress.time = reader.attribute<double>("time");
    progress.checkpoints = reader.attribute<std::int64_t>("checkpoints");
    progress.reference_speed = reader.attribute<double>("reference_speed");
    progress.initial_mass = reader.attribute<double>("initial_mass");
    progress.initial_particles = reader.attribute<std::int64_t>("initial_particles");
    progress.wall_seconds = reader.attribute<double>("wall_seconds");
    for (std::size_t k = 0; k < loss_causes; ++k) {
        progress.lost[k] = reader.attribute<std::int64_t>(cause_names[k]);
    }
    return out;
}

void load_checkpoint(const Checkpoint& checkpoint, Simulation& solver) {
    const auto& comm = solver.comm();
    const io::CheckpointReader reader(comm, checkpoint.path);
    read_store(reader, "liquid", solver.liquid());
    if (solver.solid()) read_store(reader, "solid", *solver.solid());
    RestartState state{{}, reader.replicated<double>("bodies"), {}};
    if (!solver.state().history.empty()) state.history = reader.replicated<double>("history");
    if (reader.writer_ranks() == comm.size()) state.decomposition = reader.replicated<std::int64_t>("decomposition");
    solver.restore(state);
}

} // namespace treacle::app
