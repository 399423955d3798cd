#pragma once
#include "video/picture/image.hpp"

#include <filesystem>
#include <memory>
#include <string>

namespace treacle::video {

// Codec and container of a clip.
enum class ClipCodec {
    h264,          // MP4, 4:2:0
    h264_lossless, // MP4, RGB without loss, exact stamps
    ffv1,          // MKV or AVI, RGB without loss; MKV rounds stamps to 1 ms, AVI has a constant rate
};

// Format of a clip, and faults on request.
struct ClipOptions {
    int width = 1280, height = 720;    // of the frames given, upright [pixels], even
    ClipCodec codec = ClipCodec::h264; // the name must end in a container of the codec
    double quality = 16;               // H.264's constant rate factor: 0 best, 51 worst
    int turned = 0;                // clockwise degrees that the display matrix states: frames are stored turned back
    double frames_per_second = 30; // of an AVI, and the duration of the last frame
    int reordered = 0;             // B-frames between others, as phones write them
    // Faults that a reader must report, for tests:
    bool interlaced = false;
    bool hybrid_log_gamma = false;
    int pixel_width = 1, pixel_height = 1; // sample aspect ratio
    bool index_first = false;              // MP4 whose index comes before its frames
};

// Video with a time stamp for each frame, under a temporary name until `finish`. The same frames give the same bytes.
class ClipWriter {
public:
    // InputError for a bad size, angle or ending of the name; SimulationError where FFmpeg lacks the codec or the
    // folder cannot be written.
    ClipWriter(const std::filesystem::path& path, const ClipOptions& options);
    ~ClipWriter();
    ClipWriter(ClipWriter&&) noexcept;
    ClipWriter& operator=(ClipWriter&&) = delete;

    // `stamp` ascends by 0.1 ms at least [s]. InputError for a picture of another size or a stamp that does not.
    void add(const Image& image, double stamp);
    // Syncs and renames. SimulationError without frames or when the disk is full.
    void finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace treacle::video
