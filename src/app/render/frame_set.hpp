#pragma once
#include "app/input/input.hpp"
#include "io/frame.hpp"
#include "io/run_folder.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace treacle::app {

// Frames of a series: "first:last:stride", counted from 0, `last` included, negative from the end; any part may be left
// out, and a single number is one frame.
struct FrameRange {
    std::optional<std::int64_t> first, last;
    std::int64_t stride = 1;
};

// Throws InputError for what is no range.
FrameRange read_frame_range(const std::string& text);

// The places in a series of `count` frames. Throws InputError for a place that there is not, and for none.
std::vector<std::size_t> pick_frames(const FrameRange& range, std::size_t count);

// A finished or running run, opened for reading: its scene, its frames.
struct RunView {
    io::RunFolder folder;
    Input input;                         // of effective.yaml
    std::vector<io::SeriesEntry> frames; // of the liquid, by time; may be empty
    std::vector<io::SeriesEntry> solids; // of the solids' particles: one, or one for each frame

    // The solids at the time of a frame; nothing when there are none.
    std::optional<std::filesystem::path> solids_of(std::size_t i) const;
    std::filesystem::path frame(std::size_t i) const { return folder.frames() / frames[i].file; }
};

// The place of the frame nearest to a time [s]; the run has frames.
std::size_t nearest_frame(const RunView& run, double time);

// Collective. Throws InputError on every rank when it is no run's folder.
RunView open_run(const Comm& comm, const std::filesystem::path& path);

// Finds the frames that a run under way has written meanwhile. On this rank alone.
void look_again(RunView& run);

// Throws InputError when the run has no frame.
void require_frames(const RunView& run);

// Makes a folder for pictures or exports, on this rank alone. Throws InputError.
void make_output_folder(const std::filesystem::path& path);

} // namespace treacle::app
