#include "app/identify/hidden_fields.hpp"

#include "app/study/sweep.hpp"
#include "base/text/error.hpp"
#include "study/lanes/child_process.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

namespace treacle::app {

namespace {
constexpr std::size_t pictures = 4; // of each field, at most

// Runs a command of this program, true when it succeeds; its output goes into `output`.
bool succeeds(std::vector<std::string> command, const std::filesystem::path& output, Log& log) {
    command.insert(command.begin(), this_program().string());
    study::ChildProcess child(command, output);
    while (!child.poll()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const auto ending = *child.poll();
    if (ending.exit_code == 0 && ending.signal == 0) return true;
    log.warn("hidden fields: treacle " + command[1] + " " + describe(ending) + "; see " + output.string());
    return false;
}

std::size_t count_frames(const std::filesystem::path& run) {
    std::size_t count = 0;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(run / "frames", none))
        count += entry.path().filename().string().starts_with("frame_");
    return count;
}

// The camera of the scene's first film; the scene's own first without one.
std::vector<std::string> camera_words(const identify::StudyFile& file, const study::StudyScene& scene) {
    for (const auto& one : file.experiments) {
        if (!identify::has_masks(one.kind) || &file.scene_of(one) != &scene || one.camera.empty()) continue;
        const auto path = file.beside(one.camera);
        return {"--camera", std::filesystem::exists(path) ? path.string() : one.camera};
    }
    return {};
}

std::vector<identify::ReportPicture> draw(const std::filesystem::path& run, const std::filesystem::path& folder,
    const std::string& field, const std::string& scene, const std::vector<std::string>& camera, Log& log) {
    const auto frames = count_frames(run);
    if (frames < 2) return {};
    const auto name = "hidden_" + scene + "_" + field;
    const auto stride = std::max<std::size_t>(1, (frames - 1 + pictures - 1) / pictures);
    std::vector<std::string> command{"render", run.string(), "--style", "surface", "--field", field, "--no-movie",
        "--size", "480x360", "--frames", std::to_string(std::min(stride, frames - 1)) + ":-1:" + std::to_string(stride),
        "--out", (folder / name).string()};
    command.insert(command.end(), camera.begin(), camera.end());
    if (!succeeds(command, folder / (name + ".txt"), log)) return {};
    std::filesystem::remove(folder / (name + ".txt"));
    std::vector<identify::ReportPicture> out;
    for (const auto& entry : std::filesystem::directory_iterator(folder / name)) {
        if (entry.path().extension() == ".png")
            out.push_back({name + "/" + entry.path().filename().string(), scene + ": " + field});
    }
    std::ranges::sort(out, {}, &identify::ReportPicture::file);
    return out;
}
} // namespace

std::vector<identify::ReportPicture> draw_hidden_fields(const std::filesystem::path& folder,
    const identify::StudyFile& file, const identify::Identification& found,
    const std::function<std::filesystem::path(std::int64_t)>& folder_of, Log& log) {
    std::vector<identify::ReportPicture> out;
    const auto* best = identify::best_trial(found);
    if (!best) return out;
    std::filesystem::create_directories(folder);
    for (std::size_t i = 0; i < best->runs.size(); ++i) {
        const auto& scene = file.study.scenes[i];
        const auto kept = folder_of(best->runs[i]) / "run", again = folder / ("run_" + scene.name);
        const bool is_kept = count_frames(kept) > 0;
        if (!is_kept && !succeeds({"run", (kept / "effective.yaml").string(), "--out", again.string(), "--overwrite"},
                            folder / "run.txt", log))
            continue;
        for (const char* field : {"pressure", "speed"}) {
            for (auto& one : draw(is_kept ? kept : again, folder, field, scene.name, camera_words(file, scene), log))
                out.push_back(std::move(one));
        }
        std::filesystem::remove_all(again);
        std::filesystem::remove(folder / "run.txt");
    }
    return out;
}

} // namespace treacle::app
