#include "video/clip/video_file.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/clip/libav.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

extern "C" {
#include <libavutil/pixdesc.h>
}

namespace treacle::video {

namespace {
using namespace libav;

struct OpenFile {
    Input input;
    int stream = -1;
    CodecContext codec;

    AVStream& video() const { return *input->streams[stream]; }
    double seconds(std::int64_t stamp) const { return static_cast<double>(stamp) * av_q2d(video().time_base); }
};

bool is_mp4(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::array<char, 8> start{};
    return file.read(start.data(), start.size()) && std::string_view(start.data() + 4, 4) == "ftyp";
}

InputError unreadable(const std::filesystem::path& path, int code) {
    const auto said = take_complaint();
    const auto reason = said.empty() ? error_text(code) : said;
    if (reason.find("moov atom not found") != std::string::npos && is_mp4(path))
        return InputError({path.string(), "is cut off: its index is missing",
            "an MP4 has its index at the end, which was not copied or not written",
            "copy the file again, or repair it with `untrunc`"});
    return InputError({path.string(), "is no video that can be read", reason,
        "give a video, a folder of pictures, or a pattern such as \"frame_%04d.png\""});
}

namespace {

void open_decoder(OpenFile& file, const AVCodec* decoder, const std::filesystem::path& path) {
    file.codec.reset(avcodec_alloc_context3(decoder));
    avcodec_parameters_to_context(file.codec.get(), file.video().codecpar);
    file.codec->thread_count = 2;
    file.codec->pkt_timebase = file.video().time_base;
    if (const int code = avcodec_open2(file.codec.get(), decoder, nullptr); code < 0) throw unreadable(path, code);
}

// Where the clip is damaged: frames that the file's index lists beyond those read.
void count_missing(const OpenFile& file, ClipInfo& info) {
    const auto indexed = avformat_index_get_entries_count(&file.video());
    if (!info.damage.empty() && indexed > static_cast<int>(info.stamps.size()))
        info.damage = "it has " + std::to_string(info.stamps.size()) + " of the " + std::to_string(indexed) +
                      " frames that its index lists";
}

} // namespace

OpenFile open_file(const std::filesystem::path& path) {
    capture_log();
    take_complaint();
    OpenFile file;
    AVFormatContext* context = nullptr;
    if (const int code = avformat_open_input(&context, path.c_str(), nullptr, nullptr); code < 0)
        throw unreadable(path, code);
    file.input.reset(context);
    if (const int code = avformat_find_stream_info(context, nullptr); code < 0) throw unreadable(path, code);
    const AVCodec* decoder = nullptr;
    file.stream = av_find_best_stream(context, AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
    if (file.stream < 0 || decoder == nullptr)
        throw InputError({path.string(), "has no video that can be decoded",
            file.stream < 0 ? "" : "FFmpeg lacks its decoder", "convert it to H.264 in MP4"});
    open_decoder(file, decoder, path);
    return file;
}

Orientation orientation_of(const AVStream& stream, const std::filesystem::path& path) {
    const auto* data = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
    if (data == nullptr) return {};
    const auto* matrix = reinterpret_cast<const std::int32_t*>(data);
    const auto sign = [&](int i) { return matrix[i] > 32768 ? 1 : matrix[i] < -32768 ? -1 : 0; };
    const Orientation turned{sign(0), sign(1), sign(3), sign(4)};
    if (std::abs(turned.a * turned.d - turned.b * turned.c) != 1 || (turned.a != 0) == (turned.b != 0))
        throw InputError({path.string(), "is turned by an angle other than 90, 180 or 270 degrees",
            "its display matrix says so", "convert it with `ffmpeg -i IN OUT`, which turns it"});
    return turned;
}

Transfer transfer_of(AVColorTransferCharacteristic value) {
    switch (value) {
    case AVCOL_TRC_SMPTE2084: return Transfer::pq;
    case AVCOL_TRC_ARIB_STD_B67: return Transfer::hlg;
    case AVCOL_TRC_LINEAR: return Transfer::linear;
    case AVCOL_TRC_UNSPECIFIED:
    case AVCOL_TRC_RESERVED0:
    case AVCOL_TRC_RESERVED: return Transfer::unknown;
    default: return Transfer::gamma;
    }
}

FieldOrder fields_of(AVFieldOrder order) {
    if (order == AV_FIELD_UNKNOWN) return FieldOrder::unknown;
    return order == AV_FIELD_PROGRESSIVE ? FieldOrder::progressive : FieldOrder::interlaced;
}

// Stamps of all packets that are shown, and what stops the reading before the end.
void scan_packets(const OpenFile& file, ClipInfo& info) {
    const Packet packet(av_packet_alloc());
    int code = 0;
    while ((code = av_read_frame(file.input.get(), packet.get())) >= 0) {
        const bool broken = (packet->flags & AV_PKT_FLAG_CORRUPT) != 0;
        if (packet->stream_index == file.stream && !broken && (packet->flags & AV_PKT_FLAG_DISCARD) == 0) {
            const auto stamp = packet->pts != AV_NOPTS_VALUE ? packet->pts : packet->dts;
            info.stamps.push_back(file.seconds(stamp));
        }
        if (broken && info.damage.empty()) info.damage = "a part of it is missing";
        av_packet_unref(packet.get());
    }
    if (code != AVERROR_EOF) info.damage = error_text(code);
    std::ranges::sort(info.stamps);
    const auto said = take_complaint();
    if (info.damage.empty() && said.find("partial file") != std::string::npos) info.damage = said;
    count_missing(file, info);
}

ClipInfo describe(const OpenFile& file, const SourceRequest& request) {
    ClipInfo info;
    const auto& stream = file.video();
    const auto& coding = *stream.codecpar;
    info.file = request.clip.string();
    info.kind = std::string(avcodec_get_name(coding.codec_id)) + " in " + file.input->iformat->name;
    info.orientation = orientation_of(stream, request.clip);
    info.width = info.orientation.swaps_sides() ? coding.height : coding.width;
    info.height = info.orientation.swaps_sides() ? coding.width : coding.height;
    const auto* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(coding.format));
    if (format != nullptr) info.bits = format->comp[0].depth;
    info.transfer = transfer_of(coding.color_trc);
    info.fields = fields_of(coding.field_order);
    const auto aspect = av_guess_sample_aspect_ratio(file.input.get(), const_cast<AVStream*>(&stream), nullptr);
    if (aspect.num > 0 && aspect.den > 0) info.pixel_aspect = av_q2d(aspect);
    info.tick = av_q2d(stream.time_base);
    return info;
}

class VideoFile final : public FrameSource {
public:
    explicit VideoFile(const SourceRequest& request) : request_(request), file_(open_file(request.clip)) {
        info_ = describe(file_, request);
        scan_packets(file_, info_);
        if (!info_.damage.empty() && !request.allow_damage)
            throw InputError({request.clip.string(), "is cut off: " + info_.damage,
                "the copy or the recording was not finished", "copy it again; --allow-damage takes what is there"});
        if (info_.stamps.empty())
            throw InputError({request.clip.string(), "holds no frame", "", "choose another file"});
        rewind();
        decode(); // only a decoded frame has its field order for sure
        rewind();
    }

    const ClipInfo& info() const override { return info_; }

    void rewind() override {
        file_ = {};
        file_ = open_file(request_.clip);
        next_ = 0;
        ended_ = false;
    }

    bool read(TimedFrame& out) override {
        const auto frame = decode();
        if (!frame) {
            if (next_ < std::ssize(info_.stamps) && !request_.allow_damage)
                throw InputError({request_.clip.string() + ", frame " + std::to_string(next_), "cannot be decoded",
                    take_complaint(), "--allow-damage takes the frames before it"});
            return false;
        }
        out.index = next_++;
        out.stamp = frame->best_effort_timestamp == AV_NOPTS_VALUE ? stamp_in_list(out.index)
                                                                   : file_.seconds(frame->best_effort_timestamp);
        out.time = out.stamp;
        convert(*frame, out.image);
        return true;
    }

private:
    double stamp_in_list(std::int64_t index) const {
        return info_.stamps[static_cast<std::size_t>(std::min(index, std::ssize(info_.stamps) - 1))];
    }

    // Null at the end.
    Frame decode() {
        Frame frame(av_frame_alloc());
        const Packet packet(av_packet_alloc());
        while (true) {
            const int code = avcodec_receive_frame(file_.codec.get(), frame.get());
            if (code == 0) {
                if (frame->interlaced_frame != 0) info_.fields = FieldOrder::interlaced;
                return frame;
            }
            if (code != AVERROR(EAGAIN) || ended_) return nullptr;
            feed(*packet);
        }
    }

    void feed(AVPacket& packet) {
        while (av_read_frame(file_.input.get(), &packet) >= 0) {
            const bool ours = packet.stream_index == file_.stream && (packet.flags & AV_PKT_FLAG_CORRUPT) == 0;
            if (ours) avcodec_send_packet(file_.codec.get(), &packet);
            av_packet_unref(&packet);
            if (ours) return;
        }
        ended_ = true;
        avcodec_send_packet(file_.codec.get(), nullptr);
    }

    void convert(const AVFrame& frame, Image& image) {
        if (frame.width != scaled_width_ || frame.height != scaled_height_ || frame.format != scaled_format_) {
            if (scaled_width_ != 0 && (frame.width != scaled_width_ || frame.height != scaled_height_))
                throw InputError({request_.clip.string() + ", frame " + std::to_string(next_ - 1),
                    "has another size than the frames before", "", "cut the clip there"});
            make_scaler(frame);
        }
        stored_.width = frame.width;
        stored_.height = frame.height;
        stored_.pixels.resize(3 * std::size_t(frame.width) * std::size_t(frame.height));
        // swscale writes rows in whole vectors: rows of its own, padded.
        const int stride = (3 * frame.width + 63) / 64 * 64 + 64;
        padded_.resize(std::size_t(stride) * std::size_t(frame.height) + 64);
        std::uint8_t* const target[4] = {padded_.data()};
        const int strides[4] = {stride};
        sws_scale(scaler_.get(), frame.data, frame.linesize, 0, frame.height, target, strides);
        for (int row = 0; row < frame.height; ++row)
            std::copy_n(padded_.data() + std::size_t(row) * std::size_t(stride), 3 * frame.width,
                stored_.pixels.data() + 3 * std::size_t(row) * std::size_t(frame.width));
        if (info_.orientation.upright())
            std::swap(image, stored_);
        else
            image = turn(stored_, info_.orientation);
    }

    // Colours by the frame's own matrix and range; BT.709 from 720 rows on, BT.601 below, where it names none.
    void make_scaler(const AVFrame& frame) {
        scaled_width_ = frame.width;
        scaled_height_ = frame.height;
        scaled_format_ = frame.format;
        scaler_.reset(sws_getContext(frame.width, frame.height, static_cast<AVPixelFormat>(frame.format), frame.width,
            frame.height, AV_PIX_FMT_RGB24, SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_BITEXACT, nullptr,
            nullptr, nullptr));
        if (!scaler_)
            throw InputError({request_.clip.string(), "has a pixel format that cannot be converted", "",
                "convert it to H.264 in MP4"});
        const int matrix = frame.colorspace != AVCOL_SPC_UNSPECIFIED && frame.colorspace != AVCOL_SPC_RGB
                               ? frame.colorspace
                           : frame.height >= 720 ? SWS_CS_ITU709
                                                 : SWS_CS_ITU601;
        const int full = frame.color_range == AVCOL_RANGE_JPEG ? 1 : 0;
        const int* coefficients = sws_getCoefficients(matrix);
        sws_setColorspaceDetails(
            scaler_.get(), coefficients, full, sws_getCoefficients(SWS_CS_ITU709), 1, 0, 1 << 16, 1 << 16);
    }

    SourceRequest request_;
    OpenFile file_;
    ClipInfo info_;
    std::int64_t next_ = 0;
    bool ended_ = false;
    Scaler scaler_;
    int scaled_width_ = 0, scaled_height_ = 0, scaled_format_ = -1;
    Image stored_;
    std::vector<std::uint8_t> padded_;
};
} // namespace

std::unique_ptr<FrameSource> open_video_file(const SourceRequest& request) {
    return std::make_unique<VideoFile>(request);
}

} // namespace treacle::video
