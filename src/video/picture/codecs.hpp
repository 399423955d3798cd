#pragma once
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace treacle::video {

// A movie while it is encoded; its file is complete once this is gone.
class MovieEncoder {
public:
    virtual ~MovieEncoder() = default;
    virtual void add(const cv::Mat& frame) = 0;
};

// Format that OpenCV's writer is opened with.
struct MovieFormat {
    int backend = 0;               // cv::VideoCaptureAPIs
    const char* codec = "avc1";    // four characters
    double frames_per_second = 30; // positive
    cv::Size size;                 // [pixels]
};

// OpenCV's codecs of pictures and movies, with its errors. Their libraries load some 200 others, which takes longer than
// anything else at the program's start: they stand in a module that is loaded at the first use.
class Codecs {
public:
    virtual ~Codecs() = default;
    virtual cv::Mat read(const std::string& path, int flags) const = 0; // cv::imread: empty when it is no picture
    virtual cv::Mat decode(const cv::Mat& bytes, int flags) const = 0;  // cv::imdecode
    virtual bool encode_png(const cv::Mat& picture, std::vector<std::uint8_t>& bytes) const = 0;
    virtual std::unique_ptr<MovieEncoder> encode(
        const std::string& path, const MovieFormat& format) const = 0; // null: cannot
    virtual double count_frames(const std::string& movie) const = 0;   // 0 when it cannot be read
};

// Loads the module. SimulationError when it cannot be loaded.
const Codecs& codecs();

} // namespace treacle::video
