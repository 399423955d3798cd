#include "app/study/study_memory.hpp"

#include "app/setup/estimates.hpp"
#include "app/study/study_scenes.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <fstream>
#include <limits>

namespace treacle::app {

namespace {
constexpr double program_bytes = 60e6;     // a rank without particles: libraries and their buffers, as measured
constexpr std::size_t most_estimates = 16; // a geometry takes milliseconds to seconds

// A number in a file of the kernel's; infinite where there is none ("max").
double number_in(const char* path) {
    std::ifstream file(path);
    double value = 0;
    return file >> value ? value : std::numeric_limits<double>::infinity();
}
} // namespace

double run_memory(const study::Study& study, const study::StudyScene& scene, const study::Point& values) {
    const auto input = load_scene(source_of(study.scene_file(scene), study::assignments_of(study, scene, values)));
    const auto geometry = build_geometry(input);
    const auto counts = estimate_particles(input, geometry);
    return estimate_run(input, geometry, counts.liquid, counts.solid).bytes + program_bytes * study.runs.ranks;
}

double largest_run_memory(const study::Study& study, const std::vector<study::Candidate>& candidates) {
    const auto count = std::min(candidates.size(), most_estimates);
    double most = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto& one = candidates[count == 1 ? 0 : i * (candidates.size() - 1) / (count - 1)];
        const auto scene = std::ranges::find(study.scenes, one.scene, &study::StudyScene::name);
        most = std::max(most, run_memory(study, *scene, one.values));
    }
    return most;
}

double available_memory() {
    std::ifstream file("/proc/meminfo");
    double machine = std::numeric_limits<double>::infinity();
    for (std::string word; file >> word;) {
        if (word == "MemAvailable:" && file >> machine) machine *= 1024;
    }
    return std::min(machine, number_in("/sys/fs/cgroup/memory.max"));
}

void check_memory(const study::Study& study, const std::vector<study::Candidate>& candidates) {
    if (!study.runs.launcher.empty() || candidates.empty()) return;
    const double one = largest_run_memory(study, candidates), available = available_memory();
    const int lanes = int(std::min<std::size_t>(candidates.size(), std::size_t(study::lane_count(study.runs))));
    if (one * lanes <= available) return;
    const auto bytes = [](double value) { return format_bytes(std::uint64_t(value)); };
    const int fitting = int(available / one);
    throw InputError(
        {study.path.string() + ": runs.lanes = " + std::to_string(lanes), "the runs do not fit in memory at once",
            "one needs about " + bytes(one) + ", and " + bytes(available) + " are free",
            fitting > 0 ? "write runs: {lanes: " + std::to_string(fitting) + "}"
                        : "take a larger spacing, or a machine with more memory"});
}

} // namespace treacle::app
