#include "app/render/frame_set.hpp"

#include "base/text/error.hpp"
#include "base/text/split.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace treacle::app {

namespace {

[[noreturn]] void refuse_range(const std::string& text, const std::string& reason) {
    throw InputError({"--frames " + text, "is no range of frames", reason,
        "write first:last:stride, such as 10:20, ::5, or -1 for the last one"});
}

std::optional<std::int64_t> read_index(const std::string& part, const std::string& text) {
    if (part.empty()) return std::nullopt;
    std::int64_t value = 0;
    const auto* end = part.data() + part.size();
    const auto [stop, error] = std::from_chars(part.data(), end, value);
    if (error != std::errc{} || stop != end) refuse_range(text, "'" + part + "' is no whole number");
    return value;
}

std::size_t index_of(std::int64_t asked, std::size_t count) {
    const auto size = static_cast<std::int64_t>(count);
    const auto index = asked < 0 ? asked + size : asked;
    if (index < 0 || index >= size) {
        throw InputError({"--frames", "there is no frame " + std::to_string(asked),
            "there are " + std::to_string(count) + ", counted from 0",
            "choose one between 0 and " + std::to_string(size - 1)});
    }
    return static_cast<std::size_t>(index);
}

} // namespace

FrameRange read_frame_range(const std::string& text) {
    FrameRange range;
    if (text.empty()) return range;
    const auto parts = split(text, ':');
    if (parts.size() > 3) refuse_range(text, "it has more than three parts");
    range.first = read_index(parts[0], text);
    range.last = parts.size() > 1 ? read_index(parts[1], text) : range.first;
    if (parts.size() > 2) range.stride = read_index(parts[2], text).value_or(1);
    if (range.stride < 1) refuse_range(text, "the stride must be at least 1");
    return range;
}

std::vector<std::size_t> pick_frames(const FrameRange& range, std::size_t count) {
    std::vector<std::size_t> indices;
    if (count > 0) {
        const auto first = index_of(range.first.value_or(0), count);
        const auto last = index_of(range.last.value_or(-1), count);
        for (auto i = first; i <= last; i += static_cast<std::size_t>(range.stride)) indices.push_back(i);
    }
    if (indices.empty()) {
        throw InputError({"--frames", "no frame is left", "the first one comes after the last one", "swap the two"});
    }
    return indices;
}

std::size_t nearest_frame(const RunView& run, double time) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < run.frames.size(); ++i) {
        if (std::abs(run.frames[i].time - time) < std::abs(run.frames[best].time - time)) best = i;
    }
    return best;
}

RunView open_run(const Comm& comm, const std::filesystem::path& path) {
    RunView run;
    run.folder = io::open_run_folder(comm, path);
    comm.guard([&] {
        run.input = load_input({run.folder.effective_scene(), {}, {}, {}, {}});
        look_again(run);
    });
    return run;
}

void look_again(RunView& run) {
    const auto series = run.folder.frames() / (run.input.scene.output.name + ".hdf.series");
    if (std::filesystem::exists(series)) run.frames = io::read_series(series);
    const auto solids = run.folder.frames() / "solid.hdf.series";
    if (std::filesystem::exists(solids)) run.solids = io::read_series(solids);
}

std::optional<std::filesystem::path> RunView::solids_of(std::size_t i) const {
    if (solids.empty()) return std::nullopt;
    const auto later = [](double time, const io::SeriesEntry& entry) { return time < entry.time; };
    const auto next = std::upper_bound(solids.begin() + 1, solids.end(), frames[i].time, later);
    return folder.frames() / (next - 1)->file;
}

void require_frames(const RunView& run) {
    if (!run.frames.empty()) return;
    throw InputError({run.folder.root.string(), "there is no frame", "the run has not written one",
        "set output.interval or output.times and run again"});
}

void make_output_folder(const std::filesystem::path& path) {
    if (path.empty()) return; // the current one
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error || !std::filesystem::is_directory(path)) {
        throw InputError(
            {path.string(), "the folder cannot be made", error.message(), "choose another one with --out"});
    }
}

} // namespace treacle::app
