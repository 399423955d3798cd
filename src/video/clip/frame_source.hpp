#pragma once
#include "video/clip/time_map.hpp"
#include "video/picture/image.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace treacle::video {

// A picture of a clip with its time. Upright: turned by the container's or the picture's own data.
struct TimedFrame {
    std::int64_t index = 0; // from 0, in the order of display
    double stamp = 0;       // time stamp of the container [s]
    double time = 0;        // true time [s], after the true rate or the time map
    Image image;
};

// Signed 2x2 permutation that turns a stored picture upright: (x, y) -> (a x + c y, b x + d y).
struct Orientation {
    int a = 1, b = 0, c = 0, d = 1;

    bool upright() const { return a == 1 && d == 1; }   // true when nothing needs turning or mirroring
    bool swaps_sides() const { return a == 0; }         // true when width and height change places
    int degrees() const;                                // clockwise: 0, 90, 180 or 270
    bool mirrored() const { return a * d - b * c < 0; } // determinant below 0
};

// The picture turned.
Image turn(const Image& image, const Orientation& orientation);

// Transfer from light to the stored numbers.
enum class Transfer { unknown, gamma, linear, pq, hlg };
enum class FieldOrder { progressive, interlaced, unknown };

// Information of a clip's header and of the stamps of its frames. Sizes are those of upright frames.
struct ClipInfo {
    std::string file, kind;    // kind: "H.264 video in mov,mp4,…", "12 PNG pictures"
    int width = 0, height = 0; // [pixels]
    Orientation orientation;   // as the container states it
    int bits = 8;              // a colour
    Transfer transfer = Transfer::unknown;
    FieldOrder fields = FieldOrder::unknown;
    double pixel_aspect = 1;    // width over height of a pixel
    std::vector<double> stamps; // of all frames, ascending [s]
    std::vector<double> times;  // after the true rate or the time map [s]
    double tick = 0;            // resolution of the stamps [s]; 0: unknown
    std::string damage;         // what is wrong with the file's end; empty if nothing

    double rate() const;            // mean frames per second, 0 for fewer than two frames
    double median_interval() const; // [s]
    // True when intervals differ by more than 1 % and one tick.
    bool variable_rate() const;
};

// A clip, the times of its frames, and the faults that are let pass by open_frames. true_rate and time_map exclude each
// other.
struct SourceRequest {
    std::filesystem::path clip;  // a video, a folder, or a pattern: *.png, frame_%04d.png
    double rate = 0;             // frames per second of pictures
    std::filesystem::path times; // CSV with a column time, one row a picture, in place of a rate
    double true_rate = 0;        // frames per second at which a slow-motion file was shot
    std::string time_map;        // see TimeMap::read
    bool allow_damage = false;   // a clip that is cut off counts up to its last whole frame
};

// Frames one after the other, in the order of display. Neither copied nor shared.
class FrameSource {
public:
    virtual ~FrameSource() = default;
    virtual const ClipInfo& info() const = 0;
    // The next frame; false after the last one. InputError for one that cannot be decoded.
    virtual bool read(TimedFrame& frame) = 0;
    // Back to frame 0.
    virtual void rewind() = 0;
};

// InputError with a cure for what is no video: missing, cut off, HEIC, interlaced, HDR (PQ, HLG), pixels that
// are not square, pictures without a rate, of unlike sizes or with a gap in their numbers.
// Source of the rules: container's display matrix, ISO/IEC 14496-12, 8.3.2; transfers, ITU-T H.273, table 3.
std::unique_ptr<FrameSource> open_frames(const SourceRequest& request);

// As `open_frames`, but interlaced, HDR and non-square clips open: for `treacle check-video`, which lists them all.
std::unique_ptr<FrameSource> open_any_frames(const SourceRequest& request);

} // namespace treacle::video
