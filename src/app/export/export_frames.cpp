#include "app/export/export_frames.hpp"

#include "app/render/frame_set.hpp"
#include "base/text/log.hpp"
#include "io/export.hpp"

namespace treacle::app {

namespace {

struct Job {
    std::vector<std::filesystem::path> frames;
    std::filesystem::path out;
};

Job plan(const Comm& comm, const ExportRequest& request) {
    if (std::filesystem::is_regular_file(request.source)) {
        if (!request.frames.empty()) {
            throw InputError({"--frames", "has no effect", request.source.string() + " is a single frame",
                "give the run's folder, or leave it out"});
        }
        return {{request.source}, request.source.parent_path()};
    }
    const auto run = open_run(comm, request.source);
    require_frames(run);
    Job job;
    for (const auto i : pick_frames(read_frame_range(request.frames), run.frames.size())) {
        job.frames.push_back(run.frame(i));
    }
    job.out = run.folder.root / "exports";
    return job;
}

} // namespace

ExitCode export_frames(const Comm& comm, const ExportRequest& request) {
    const auto format = io::export_format(request.format);
    auto job = plan(comm, request);
    if (!request.out.empty()) job.out = request.out;
    comm.guard_root([&] { make_output_folder(job.out); });
    comm.guard([&] {
        for (auto i = static_cast<std::size_t>(comm.rank()); i < job.frames.size();
             i += static_cast<std::size_t>(comm.size())) {
            const auto name = job.frames[i].stem().string() + "." + io::format_name(format);
            io::export_particles(job.out / name, io::read_frame(job.frames[i]), format);
        }
    });
    Log log(comm.is_root() ? LogOutput::enabled : LogOutput::disabled);
    log.line(std::to_string(job.frames.size()) + (job.frames.size() == 1 ? " frame" : " frames") + " to " +
             (job.out.empty() ? "." : job.out.string()) + " as " + request.format);
    return ExitCode::ok;
}

} // namespace treacle::app
