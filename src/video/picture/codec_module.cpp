// The module that holds OpenCV's codecs; codecs.hpp has the reason.
#include "video/picture/codecs.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

namespace treacle::video {

namespace {

class Encoder : public MovieEncoder {
public:
    bool open(const std::string& path, const MovieFormat& format) {
        const int codec = cv::VideoWriter::fourcc(format.codec[0], format.codec[1], format.codec[2], format.codec[3]);
        return writer_.open(path, format.backend, codec, format.frames_per_second, format.size);
    }
    void add(const cv::Mat& frame) override { writer_.write(frame); }

private:
    cv::VideoWriter writer_;
};

class OpenCvCodecs : public Codecs {
public:
    cv::Mat read(const std::string& path, int flags) const override { return cv::imread(path, flags); }
    cv::Mat decode(const cv::Mat& bytes, int flags) const override { return cv::imdecode(bytes, flags); }
    bool encode_png(const cv::Mat& picture, std::vector<std::uint8_t>& bytes) const override {
        return cv::imencode(".png", picture, bytes);
    }
    std::unique_ptr<MovieEncoder> encode(const std::string& path, const MovieFormat& format) const override {
        auto encoder = std::make_unique<Encoder>();
        if (!encoder->open(path, format)) return nullptr;
        return encoder;
    }
    double count_frames(const std::string& movie) const override {
        const cv::VideoCapture back(movie, cv::CAP_ANY);
        return back.isOpened() ? back.get(cv::CAP_PROP_FRAME_COUNT) : 0;
    }
};

} // namespace

} // namespace treacle::video

extern "C" const treacle::video::Codecs* treacle_codecs() {
    static const treacle::video::OpenCvCodecs codecs;
    return &codecs;
}
