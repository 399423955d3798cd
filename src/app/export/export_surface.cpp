#include "app/export/export_surface.hpp"

#include "app/input/option_values.hpp"
#include "app/input/table_text.hpp"
#include "app/render/surface_fields.hpp"
#include "base/text/file.hpp"
#include "base/text/log.hpp"
#include "base/text/progress.hpp"
#include "base/text/text.hpp"
#include "io/series.hpp"
#include "surface/mesh/mesh_check.hpp"

namespace treacle::app {

namespace {
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

// "0 0 0 cm; 10 10 5 cm".
std::array<Vec3, 2> read_box(const std::string& text) {
    const auto parts = split_at(text, ';');
    if (parts.size() != 2)
        throw InputError({"--box \"" + text + "\"", "is no box", "it takes two corners, the lower one first",
            "write for instance \"0 0 0 cm; 10 10 5 cm\""});
    return {read_vector(parts[0], unit::length, "--box"), read_vector(parts[1], unit::length, "--box")};
}

// Verdict on a mesh in a line: closed, oriented and a manifold, or what is not.
bool report_check(const Comm& comm, const surface::Mesh& mesh, Log& log) {
    const auto faults = surface::check_mesh(comm, mesh);
    if (faults.none()) {
        log.line("check: closed, oriented, manifold");
        return true;
    }
    log.warn("check: " + std::to_string(faults.open) + " open edges, " + std::to_string(faults.crowded) +
             " edges of more than two triangles or turned against each other, " + std::to_string(faults.pinched) +
             " vertices where the surface touches itself, " + std::to_string(faults.flat) + " triangles without area");
    return false;
}

// The liquids whose surfaces are requested, by their numbers, with their part of the files' names.
std::vector<std::pair<int, std::string>> pick_liquids(const scene::Scene& scene, const std::string& name) {
    if (name.empty()) return {{-1, ""}};
    std::vector<std::pair<int, std::string>> out;
    std::vector<std::string> names;
    for (std::size_t k = 0; k < scene.liquids.size(); ++k) {
        names.push_back(scene.liquids[k].name);
        if (name == "each" || name == names.back()) out.emplace_back(static_cast<int>(k), "_" + names.back());
    }
    if (out.empty())
        throw InputError(
            {"--liquid " + name, "the scene has no such liquid", "there are " + join(names, ", ") + ", each", ""});
    return out;
}

// The frames of one surface.
class SurfaceExport {
public:
    // Collective. `suffix` of the files' names, before the frame's number.
    SurfaceExport(const Comm& comm, const RunView& run, const SurfaceRequest& request, const SurfaceChoice& choice,
        const std::string& suffix)
        : comm_(comm), run_(run), request_(request), format_(io::surface_format(request.format)),
          surface_(comm, run, choice), name_(run.input.scene.output.name + "_surface" + suffix),
          extension_("." + io::format_name(format_)) {}

    // Collective: the file of a frame. False for one in which a check finds a fault.
    bool write(std::size_t frame, SurfaceFields& fields, const std::filesystem::path& out, Log& log) {
        const auto& mesh = surface_.build(frame);
        const auto stem = run_.frame(frame).stem().string(); // NAME_000042
        const auto file = name_ + stem.substr(stem.rfind('_')) + extension_;
        io::write_surface(comm_, out / file, fields.part_of(mesh, surface_.time()), format_);
        entries_.push_back({file, surface_.time()});
        const bool space = mesh.dimensions == 3;
        const auto& figures = surface_.summary();
        log.line(file + ": time " + short_number(surface_.time()) + " s, vertices " +
                 std::to_string(mesh.total_vertices) + (space ? ", triangles " : ", segments ") +
                 std::to_string(mesh.total_triangles) + ", volume " + short_number(figures.volume) +
                 (space ? " m3" : " m2") + ", pieces " + std::to_string(figures.components) +
                 (figures.dropped > 0 ? ", dropped " + std::to_string(figures.dropped) + " of " +
                                            short_number(figures.dropped_volume) + (space ? " m3" : " m2")
                                      : ""));
        return !request_.check || report_check(comm_, mesh, log);
    }

    void write_index(const std::filesystem::path& out) const {
        io::write_series(out / (name_ + extension_ + ".series"), entries_);
        if (format_ == io::SurfaceFormat::vtp) write_file_atomically(out / (name_ + ".pvd"), pvd_text(entries_));
    }

private:
    Comm comm_;
    const RunView& run_;
    const SurfaceRequest& request_;
    io::SurfaceFormat format_;
    SceneSurface surface_;
    std::string name_, extension_;
    std::vector<io::SeriesEntry> entries_;
};
} // namespace

ExitCode export_surface(const Comm& comm, const SurfaceRequest& request) {
    const auto format = io::surface_format(request.format);
    if (std::filesystem::is_regular_file(request.source)) {
        throw InputError({request.source.string(), "is a single frame",
            "a surface is cut at the walls and bodies of the run's scene",
            "give the run's folder, and the frame with --frames"});
    }
    const auto run = open_run(comm, request.source);
    require_frames(run);
    const auto frames = pick_frames(read_frame_range(request.frames), run.frames.size());
    const auto liquids = pick_liquids(run.input.scene, request.liquid);
    const auto out = request.out.empty() ? run.folder.root / "exports" : request.out;
    const auto first = io::read_frame(comm, run.frame(frames.front()));
    std::optional<SurfaceFields> fields;
    comm.guard([&] { fields.emplace(request.fields, first, format); });
    SurfaceChoice choice{surface_options(run.input), fields->scalars()};
    choice.options.min_volume = request.min_volume;
    if (!request.box.empty()) choice.box = read_box(request.box);
    comm.guard_root([&] { make_output_folder(out); });
    Log log(comm.is_root() ? LogOutput::enabled : LogOutput::disabled);
    bool sound = true;
    std::int64_t done = 0;
    const auto all = frames.size() * liquids.size();
    Progress progress(log, "export", "surfaces");
    for (const auto& [liquid, suffix] : liquids) {
        choice.options.liquid = liquid;
        SurfaceExport surface(comm, run, request, choice, suffix);
        for (const auto frame : frames) {
            sound = surface.write(frame, *fields, out, log) && sound;
            progress.report(++done, static_cast<std::int64_t>(all));
        }
        comm.guard_root([&] { surface.write_index(out); });
    }
    progress.finish();
    log.line(
        std::to_string(all) + (all == 1 ? " surface to " : " surfaces to ") + out.string() + " as " + request.format);
    return sound ? ExitCode::ok : ExitCode::simulation_failed;
}

} // namespace treacle::app
