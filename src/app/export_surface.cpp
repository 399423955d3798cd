#include "app/export_surface.hpp"

#include "app/scene_surface.hpp"
#include "app/table_text.hpp"
#include "base/file.hpp"
#include "base/log.hpp"
#include "io/series.hpp"
#include "io/surface_file.hpp"

namespace treacle::app {

namespace {
io::SurfacePart part_of(const surface::Mesh& mesh, double time) {
    const auto owned = static_cast<std::size_t>(mesh.owned);
    io::SurfacePart out;
    out.dimensions = mesh.dimensions;
    out.time = time;
    out.vertices = std::span(mesh.vertices).first(3 * owned);
    out.normals = std::span(mesh.normals).first(3 * owned);
    out.velocity = std::span(mesh.velocity).first(3 * owned);
    out.pressure = std::span(mesh.pressure).first(owned);
    out.liquid = std::span(mesh.liquid).first(owned);
    for (const auto& triangle : mesh.triangles) {
        auto& numbers = out.triangles.emplace_back(std::array<std::int64_t, 3>{-1, -1, -1});
        for (std::size_t k = 0; k < static_cast<std::size_t>(mesh.dimensions); ++k) {
            numbers[k] = mesh.global[static_cast<std::size_t>(triangle[k])];
        }
    }
    return out;
}

// ParaView's index of VTK XML files.
std::string pvd_text(const std::vector<io::SeriesEntry>& entries) {
    std::string out = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
    char time[64];
    for (const auto& entry : entries) {
        std::snprintf(time, sizeof time, "%.17g", entry.time);
        out += std::string("<DataSet timestep=\"") + time + "\" file=\"" + entry.file + "\"/>\n";
    }
    return out + "</Collection>\n</VTKFile>\n";
}
} // namespace

ExitCode export_surface(const Comm& comm, const SurfaceRequest& request) {
    const auto format = io::surface_format(request.format);
    if (std::filesystem::is_regular_file(request.source)) {
        throw InputError({request.source.string(), "is a single frame", "a surface is cut at the walls and bodies of the run's scene",
                          "give the run's folder, and the frame with --frames"});
    }
    const auto run = open_run(comm, request.source);
    require_frames(run);
    const auto frames = pick_frames(read_frame_range(request.frames), run.frames.size());
    const auto out = request.out.empty() ? run.folder.root / "exports" : request.out;
    auto options = surface_options(run.input);
    options.min_volume = request.min_volume;
    SceneSurface surface(comm, run, options);
    comm.guard_root([&] { make_output_folder(out); });
    Log log(comm.is_root() ? Voice::speaks : Voice::silent);
    std::vector<io::SeriesEntry> entries;
    const std::string extension = "." + io::format_name(format), name = run.input.scene.output.name + "_surface";
    for (std::size_t k = 0; k < frames.size(); ++k) {
        const auto& mesh = surface.build(frames[k]);
        const auto stem = run.frame(frames[k]).stem().string(); // NAME_000042
        const auto file = name + stem.substr(stem.rfind('_')) + extension;
        io::write_surface(comm, out / file, part_of(mesh, surface.time()), format);
        entries.push_back({file, surface.time()});
        const auto& figures = surface.summary();
        log.line(file + ": time " + short_number(surface.time()) + " s, vertices " + std::to_string(mesh.total_vertices) +
                 (mesh.dimensions == 3 ? ", triangles " : ", segments ") + std::to_string(mesh.total_triangles) + ", volume " +
                 short_number(figures.volume) + (mesh.dimensions == 3 ? " m3" : " m2") + ", pieces " +
                 std::to_string(figures.components) +
                 (figures.dropped > 0 ? ", dropped " + std::to_string(figures.dropped) + " of " + short_number(figures.dropped_volume) +
                                            (mesh.dimensions == 3 ? " m3" : " m2")
                                      : ""));
        log.progress(static_cast<double>(k + 1) / static_cast<double>(frames.size()),
                     std::to_string(k + 1) + " of " + std::to_string(frames.size()) + " surfaces");
    }
    log.clear_progress();
    comm.guard_root([&] {
        io::write_series(out / (name + extension + ".series"), entries);
        if (format == io::SurfaceFormat::vtp) write_file_atomically(out / (name + ".pvd"), pvd_text(entries));
    });
    log.line(std::to_string(frames.size()) + (frames.size() == 1 ? " surface to " : " surfaces to ") + out.string() + " as " + request.format);
    return ExitCode::ok;
}

} // namespace treacle::app
