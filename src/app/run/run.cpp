#include "app/run/run.hpp"

#include "app/run/time_loop.hpp"
#include "app/setup/bodies.hpp"
#include "app/setup/build_scene.hpp"
#include "base/options/options.hpp"
#include "base/text/file.hpp"
#include "base/text/text.hpp"
#include "io/checkpoint/checkpoint.hpp"
#include "io/manifest.hpp"
#include "kokkos/runtime.hpp"
#include "solve/rows/runtime.hpp"

#include <fstream>
#include <sstream>

namespace treacle::app {

namespace {
std::string read_text(const Comm& comm, const std::filesystem::path& path) {
    std::string text;
    comm.guard_root([&] {
        std::ifstream file(path);
        std::ostringstream content;
        content << file.rdbuf();
        text = content.str();
    });
    return comm.broadcast(text);
}

void write_description(const Comm& comm, const io::RunFolder& folder, const RunRequest& request, const Input& input,
    const std::string& scene) {
    comm.guard_root([&] { write_file_atomically(folder.effective_scene(), scene); });
    io::Manifest manifest;
    manifest.command = request.command;
    manifest.input = request.source.scene.string();
    manifest.input_text = scene;
    manifest.libraries = {{"PETSc", solve::petsc_version()}, {"HYPRE", solve::hypre_version()},
        {"Kokkos", std::to_string(kokkos_version())}, {"execution space", execution_space_name()}};
    if (!input.transfers.empty()) manifest.extra = io::Value::object({{"materials", record(input.transfers)}});
    io::write_manifest(comm, folder.manifest(), manifest);
}

void describe_resumption(const Comm& comm, const io::RunFolder& folder, const ResumeRequest& request,
    const std::string& scene, std::int64_t step) {
    if (!request.changes.empty()) comm.guard_root([&] { write_file_atomically(folder.effective_scene(), scene); });
    io::Resumption resumption{request.command, step, scene, {}};
    for (const auto& change : request.changes) resumption.changes.push_back(change.assignment);
    io::add_resumption(comm, folder.manifest(), resumption);
}

// A new end lies behind the checkpoint.
void check_end(const ResumeRequest& request, const Input& input, double time) {
    const double end = input.scene.time.end;
    for (const auto& change : request.changes) {
        if (!change.assignment.starts_with("time.end=") || end > time) continue;
        throw InputError({change.origin,
            "time.end = " + format_number(end) + " s is not behind the checkpoint, at " + format_number(time) + " s",
            "a run does not go back", "give a later time"});
    }
}

std::filesystem::path default_folder(const std::filesystem::path& scene) {
    const auto stem =
        scene.stem() == "scene" ? std::filesystem::absolute(scene).parent_path().filename() : scene.stem();
    return std::filesystem::path("out") / stem;
}
} // namespace

ExitCode run_scene(const Comm& comm, const RunRequest& request) {
    // Every rank reads and checks the scene; nothing is written before all of it has been found good.
    Input input;
    Geometry geometry;
    comm.guard([&] {
        input = load_scene(request.source);
        check_supported(input);
        geometry = build_geometry(input);
        validate_geometry(input, geometry, comm);
        check_time_step(input);
    });
    const auto folder = io::prepare_run_folder(
        comm, request.out.empty() ? default_folder(request.source.scene) : request.out, request.existing);
    const auto scene = effective(input);
    write_description(comm, folder, request, input, scene);

    Progress progress;
    progress.reference_speed = reference_speed(input, geometry);
    auto solver = make_simulation(comm, input, progress.reference_speed, geometry);
    const auto notes = solver->fill(geometry);
    TimeLoop loop(
        {comm, folder, input, state_hash(input), request.wall_limit, request.company}, std::move(solver), progress);
    for (const auto& one : input.transfers) loop.log().line(one.liquid + ": " + join(describe(one), "; "));
    for (const auto& note : notes) loop.log().warn(note);
    return loop.run(Opening::fresh);
}

ExitCode resume_run(const Comm& comm, const ResumeRequest& request) {
    const auto folder = io::open_run_folder(comm, request.folder, io::Access::write);
    const auto before = read_text(comm, folder.effective_scene());
    Input input;
    Geometry geometry;
    comm.guard([&] {
        input = continued_input(before, folder.effective_scene().string(), request.changes);
        check_supported(input);
        // The files of meshes were found when the run began and stand there with their whole paths.
        if (any_moves(input) || input.on_grid()) geometry = build_geometry(input);
    });
    const auto hash = state_hash(input);
    const auto checkpoint = find_checkpoint(comm, folder, hash);
    check_end(request, input, checkpoint.progress.time);
    auto solver = make_simulation(comm, input, checkpoint.progress.reference_speed, geometry);
    load_checkpoint(checkpoint, *solver);
    describe_resumption(
        comm, folder, request, request.changes.empty() ? before : effective(input), checkpoint.progress.step);
    io::remove_checkpoints_after(comm, folder.checkpoints(), checkpoint.progress.step); // broken ones
    TimeLoop loop({comm, folder, input, hash, request.wall_limit, {}}, std::move(solver), checkpoint.progress);
    for (const auto& message : checkpoint.skipped) loop.log().warn(message);
    loop.log().line("going on from " + checkpoint.path.string());
    return loop.run(Opening::resumed);
}

} // namespace treacle::app
