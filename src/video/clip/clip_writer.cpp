#include "video/clip/clip_writer.hpp"

#include "base/text/error.hpp"
#include "base/text/file.hpp"
#include "base/text/text.hpp"
#include "video/clip/frame_source.hpp"
#include "video/clip/libav.hpp"

#include <algorithm>
#include <array>
#include <cmath>

extern "C" {
#include <libavutil/cpu.h>
#include <libavutil/opt.h>
}

namespace treacle::video {

namespace {
using namespace libav;

// Divides 24, 25, 30, 48, 50, 60, 120 and 240 Hz, and 1 ms.
constexpr int ticks_a_second = 90000;

// The scaler loads whole vectors, and so up to this many bytes after a picture's last pixel.
constexpr std::size_t bytes_read_past_the_end = 64;

struct FreeOutput {
    void operator()(AVFormatContext* context) const {
        if (context->pb != nullptr) avio_closep(&context->pb);
        avformat_free_context(context);
    }
};

void check(const std::filesystem::path& path, const ClipOptions& options) {
    const auto refuse = [&](const std::string& problem, const std::string& cure) {
        throw InputError({path.string(), problem, "", cure});
    };
    if (options.width < 2 || options.height < 2 || options.width % 2 != 0 || options.height % 2 != 0)
        refuse("a video of " + std::to_string(options.width) + " x " + std::to_string(options.height) +
                   " pixels: both must be even",
            "1280 x 720 is usual");
    if (options.turned % 90 != 0 || options.turned < 0 || options.turned > 270)
        refuse("a video turned by " + std::to_string(options.turned) + " degrees", "0, 90, 180 and 270 can be stated");
    if (!(options.frames_per_second > 0)) refuse("a rate that is not > 0", "30 frames per second is usual");
    const auto ending = path.extension();
    const bool fits =
        options.codec == ClipCodec::ffv1 ? ending == ".mkv" || ending == ".avi" : ending == ".mp4" || ending == ".mov";
    if (!fits)
        refuse("the name's ending does not fit the codec",
            options.codec == ClipCodec::ffv1 ? "name it .mkv or .avi" : "name it .mp4");
}

// Clockwise.
Orientation turn_by(int degrees) {
    switch (degrees) {
    case 90: return {0, 1, -1, 0};
    case 180: return {-1, 0, 0, -1};
    case 270: return {0, -1, 1, 0};
    default: return {};
    }
}
} // namespace

struct ClipWriter::State {
    std::filesystem::path path, temporary;
    ClipOptions options;
    std::unique_ptr<AVFormatContext, FreeOutput> output;
    CodecContext codec;
    AVStream* stream = nullptr;
    Scaler scaler;
    Frame frame;
    std::int64_t last = -1; // stamp in the codec's unit
    std::int64_t count = 0;
    bool finished = false;

    [[noreturn]] void fail(const std::string& problem, int code) const {
        const auto said = take_complaint();
        throw SimulationError({path.string(), problem, said.empty() ? error_text(code) : said,
            "check disk and folder, or choose another codec"});
    }
    void require(int code, const std::string& problem) const {
        if (code < 0) fail(problem, code);
    }

    void open() {
        capture_log();
        take_complaint();
        const auto format = path.extension().string().substr(1);
        AVFormatContext* context = nullptr;
        require(avformat_alloc_output_context2(
                    &context, nullptr, format == "mkv" ? "matroska" : format.c_str(), temporary.c_str()),
            "no such kind of video file");
        output.reset(context);
        output->flags |= AVFMT_FLAG_BITEXACT;
        open_codec();
        add_stream();
        require(avio_open(&output->pb, temporary.c_str(), AVIO_FLAG_WRITE), "cannot be written");
        AVDictionary* settings = nullptr;
        av_dict_set_int(&settings, "video_track_timescale", ticks_a_second, 0);
        // The time of the first frame stands in ticks of the movie, of which there are 1000 a second by default.
        av_dict_set_int(&settings, "movie_timescale", ticks_a_second, 0);
        if (options.index_first) av_dict_set(&settings, "movflags", "faststart", 0);
        const int code = avformat_write_header(output.get(), &settings);
        av_dict_free(&settings);
        require(code, "cannot be written");
    }

    const AVCodec& find_codec() const {
        const char* name = options.codec == ClipCodec::h264            ? "libx264"
                           : options.codec == ClipCodec::h264_lossless ? "libx264rgb"
                                                                       : "ffv1";
        const AVCodec* found = avcodec_find_encoder_by_name(name);
        if (found == nullptr)
            throw SimulationError({path.string(), "no codec for this video", std::string("FFmpeg lacks ") + name,
                "install Debian's libavcodec59"});
        return *found;
    }

    void open_codec() {
        const auto& encoder = find_codec();
        const bool back = options.turned % 180 != 0;
        codec.reset(avcodec_alloc_context3(&encoder));
        codec->width = back ? options.height : options.width;
        codec->height = back ? options.width : options.height;
        codec->pix_fmt = options.codec == ClipCodec::h264
                             ? (options.hybrid_log_gamma ? AV_PIX_FMT_YUV420P10LE : AV_PIX_FMT_YUV420P)
                         : options.codec == ClipCodec::ffv1 ? AV_PIX_FMT_BGR0
                                                            : AV_PIX_FMT_RGB24;
        codec->time_base = path.extension() == ".avi" ? av_inv_q(av_d2q(options.frames_per_second, 100000))
                                                      : AVRational{1, ticks_a_second};
        codec->framerate = av_d2q(options.frames_per_second, 100000);
        codec->sample_aspect_ratio = {options.pixel_width, options.pixel_height};
        codec->thread_count = 1;
        codec->max_b_frames = options.reordered;
        codec->gop_size = 30;
        codec->flags |= AV_CODEC_FLAG_BITEXACT;
        if ((output->oformat->flags & AVFMT_GLOBALHEADER) != 0) codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
        if (options.interlaced) codec->flags |= AV_CODEC_FLAG_INTERLACED_DCT | AV_CODEC_FLAG_INTERLACED_ME;
        if (options.codec == ClipCodec::h264) state_colours();
        if (options.codec != ClipCodec::ffv1) {
            av_opt_set(codec->priv_data, "preset", "veryfast", 0);
            // x264's AVX-512 code lets where its memory lies change one encoding in a hundred.
            if ((av_get_cpu_flags() & AV_CPU_FLAG_AVX512) != 0)
                av_opt_set(codec->priv_data, "x264-params", "asm=AVX2", 0);
            if (options.codec == ClipCodec::h264)
                av_opt_set_double(codec->priv_data, "crf", options.quality, 0);
            else
                av_opt_set(codec->priv_data, "qp", "0", 0);
        }
        require(avcodec_open2(codec.get(), &encoder, nullptr), "no codec for this video");
    }

    void state_colours() const {
        codec->color_range = AVCOL_RANGE_MPEG;
        codec->colorspace = options.hybrid_log_gamma ? AVCOL_SPC_BT2020_NCL : AVCOL_SPC_BT709;
        codec->color_primaries = options.hybrid_log_gamma ? AVCOL_PRI_BT2020 : AVCOL_PRI_BT709;
        codec->color_trc = options.hybrid_log_gamma ? AVCOL_TRC_ARIB_STD_B67 : AVCOL_TRC_BT709;
    }

    void add_stream() {
        stream = avformat_new_stream(output.get(), nullptr);
        require(avcodec_parameters_from_context(stream->codecpar, codec.get()), "no codec for this video");
        stream->time_base = codec->time_base;
        stream->avg_frame_rate = codec->framerate;
        stream->sample_aspect_ratio = codec->sample_aspect_ratio;
        if (options.interlaced) stream->codecpar->field_order = AV_FIELD_TT;
        if (options.turned == 0) return;
        auto* matrix = reinterpret_cast<std::int32_t*>(
            av_stream_new_side_data(stream, AV_PKT_DATA_DISPLAYMATRIX, 9 * sizeof(std::int32_t)));
        const auto [a, b, c, d] = turn_by(options.turned);
        const std::array<std::int32_t, 9> values = {a << 16, b << 16, 0, c << 16, d << 16, 0, 0, 0, 1 << 30};
        std::ranges::copy(values, matrix);
    }

    void prepare_frame() {
        frame.reset(av_frame_alloc());
        frame->format = codec->pix_fmt;
        frame->width = codec->width;
        frame->height = codec->height;
        require(av_frame_get_buffer(frame.get(), 0), "out of memory");
        scaler.reset(sws_getContext(codec->width, codec->height, AV_PIX_FMT_RGB24, codec->width, codec->height,
            codec->pix_fmt, SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP | SWS_BITEXACT,
            nullptr, nullptr, nullptr));
        const int* matrix = sws_getCoefficients(SWS_CS_ITU709);
        const int full = options.codec == ClipCodec::h264 ? 0 : 1;
        sws_setColorspaceDetails(scaler.get(), matrix, 1, matrix, full, 0, 1 << 16, 1 << 16);
    }

    void add(const Image& image, double stamp) {
        const auto ticks = std::llround(stamp / av_q2d(codec->time_base));
        if (ticks <= last || !std::isfinite(stamp))
            throw InputError({path.string(), "the time stamp " + format_number(stamp) + " s does not ascend", "",
                "give each frame a later one"});
        if (!frame) prepare_frame();
        require(av_frame_make_writable(frame.get()), "out of memory");
        auto turned = turn(image, turn_by((360 - options.turned) % 360));
        turned.pixels.resize(turned.pixels.size() + bytes_read_past_the_end);
        const std::uint8_t* const planes[4] = {turned.pixels.data()};
        const int strides[4] = {3 * turned.width};
        sws_scale(scaler.get(), planes, strides, 0, turned.height, frame->data, frame->linesize);
        frame->pts = last = ticks;
        if (options.interlaced) frame->interlaced_frame = frame->top_field_first = 1;
        frame->pict_type = AV_PICTURE_TYPE_NONE;
        require(avcodec_send_frame(codec.get(), frame.get()), "a frame cannot be encoded");
        ++count;
        drain();
    }

    void drain() {
        const Packet packet(av_packet_alloc());
        while (avcodec_receive_packet(codec.get(), packet.get()) == 0) {
            packet->stream_index = stream->index;
            packet->duration = std::llround(1 / (options.frames_per_second * av_q2d(codec->time_base)));
            av_packet_rescale_ts(packet.get(), codec->time_base, stream->time_base);
            require(av_interleaved_write_frame(output.get(), packet.get()), "cannot be written");
        }
    }

    void finish() {
        if (count == 0) throw SimulationError({path.string(), "a video without frames", "", "add one at least"});
        avcodec_send_frame(codec.get(), nullptr);
        drain();
        require(av_write_trailer(output.get()), "cannot be written");
        require(avio_closep(&output->pb), "cannot be written");
        sync_and_rename(temporary, path);
        finished = true;
    }
};

ClipWriter::ClipWriter(const std::filesystem::path& path, const ClipOptions& options)
    : state_(std::make_unique<State>()) {
    check(path, options);
    state_->path = path;
    state_->options = options;
    auto name = path;
    state_->temporary = name.replace_extension(".tmp" + path.extension().string());
    state_->open();
}

ClipWriter::~ClipWriter() {
    if (!state_ || state_->finished) return;
    state_->output.reset();
    std::error_code ignored; // nothing is left to be done about a file that is gone
    std::filesystem::remove(state_->temporary, ignored);
}

ClipWriter::ClipWriter(ClipWriter&&) noexcept = default;

void ClipWriter::add(const Image& image, double stamp) {
    if (image.width != state_->options.width || image.height != state_->options.height)
        throw InputError(
            {state_->path.string(), "a frame has another size than the video", "", "give frames of one size"});
    state_->add(image, stamp);
}

void ClipWriter::finish() { state_->finish(); }

} // namespace treacle::video
