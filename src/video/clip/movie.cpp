#include "video/clip/movie.hpp"

#include "base/text/error.hpp"
#include "base/text/file.hpp"
#include "base/text/text.hpp"
#include "video/picture/codecs.hpp"
#include "video/picture/matrix_image.hpp"

#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

namespace treacle::video {

namespace {
struct CodecEntry {
    const char* name;
    const char* tag; // four characters
    const char* extension;
};

const CodecEntry& entry_of(Codec codec) {
    static const CodecEntry h264{"H.264", "avc1", ".mp4"}, mpeg4{"MPEG-4", "mp4v", ".mp4"},
        motion_jpeg{"motion JPEG", "MJPG", ".avi"};
    return codec == Codec::h264 ? h264 : codec == Codec::mpeg4 ? mpeg4 : motion_jpeg;
}

void check(const MovieOptions& options) {
    const auto refuse = [](const std::string& problem, const std::string& cure) {
        throw InputError({"movie", problem, "", cure});
    };
    if (!(options.frames_per_second > 0) || !std::isfinite(options.frames_per_second))
        refuse("frames per second = " + format_number(options.frames_per_second) + ": must be > 0", "30 is usual");
    if (options.width < 2 || options.height < 2 || options.width % 2 != 0 || options.height % 2 != 0)
        refuse("size of " + std::to_string(options.width) + " x " + std::to_string(options.height) +
                   " pixels: both must be even",
            "1280 x 720 is usual");
}

// Codecs fail in the same way for a bad folder as for a missing library, so the folder is tested first.
void check_folder(const std::filesystem::path& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    if (!file)
        throw SimulationError({temporary.parent_path().string(), "cannot write a movie into this folder",
            "it is missing or not writable", "create it or choose another folder"});
}
} // namespace

void write_png(const std::filesystem::path& path, const Image& image) {
    std::vector<std::uint8_t> bytes;
    if (!codecs().encode_png(matrix_of(image), bytes))
        throw SimulationError({path.string(), "cannot encode a PNG", "OpenCV lacks it", "install its image codecs"});
    write_file_atomically(path, std::string(bytes.begin(), bytes.end()));
}

std::vector<Codec> all_codecs() { return {Codec::h264, Codec::mpeg4, Codec::motion_jpeg}; }

struct MovieWriter::State {
    std::filesystem::path path, temporary;
    MovieOptions options;
    Codec codec = Codec::h264;
    std::string message;
    std::unique_ptr<MovieEncoder> encoder;
    std::size_t frames = 0;
    bool finished = false;

    bool open(Codec wanted) {
        const auto& entry = entry_of(wanted);
        auto name = path;
        name.replace_extension(entry.extension);
        path = name;
        // The encoder picks the container by the extension, so the mark of a temporary file goes before it.
        temporary = name.replace_extension(std::string(".tmp") + entry.extension);
        check_folder(temporary);
        const cv::Size size(options.width, options.height);
        const int backend = wanted == Codec::motion_jpeg ? cv::CAP_OPENCV_MJPEG : cv::CAP_FFMPEG;
        codec = wanted;
        encoder = codecs().encode(temporary.string(), {backend, entry.tag, options.frames_per_second, size});
        return encoder != nullptr;
    }

    void remove_temporary() {
        std::error_code ignored; // nothing is left to be done about a file that is gone
        std::filesystem::remove(temporary, ignored);
    }
};

MovieWriter::MovieWriter(const std::filesystem::path& path, const MovieOptions& options)
    : state_(std::make_unique<State>()) {
    cv::setNumThreads(1);
    check(options);
    state_->path = path;
    state_->options = options;
    std::string missing;
    for (const Codec codec : options.codecs) {
        if (state_->open(codec)) {
            if (!missing.empty())
                state_->message = state_->path.string() + ": written as " + entry_of(codec).name +
                                  "; this OpenCV cannot write " + missing;
            return;
        }
        state_->remove_temporary();
        missing += (missing.empty() ? "" : ", ") + std::string(entry_of(codec).name);
    }
    throw SimulationError({path.string(), "no codec for a movie",
        "this OpenCV cannot write " + (missing.empty() ? "with an empty list of codecs" : missing),
        "install OpenCV with FFMPEG, or write PNG pictures"});
}

MovieWriter::~MovieWriter() {
    if (!state_ || state_->finished) return;
    state_->encoder.reset();
    state_->remove_temporary();
}

MovieWriter::MovieWriter(MovieWriter&&) noexcept = default;

void MovieWriter::add(const Image& image) {
    const auto& options = state_->options;
    if (image.width != options.width || image.height != options.height)
        throw InputError({state_->path.string(),
            "a picture of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                " pixels in a movie of " + std::to_string(options.width) + " x " + std::to_string(options.height),
            "", "draw all frames with one size"});
    state_->encoder->add(matrix_of(image));
    ++state_->frames;
}

std::filesystem::path MovieWriter::finish() {
    if (state_->frames == 0)
        throw SimulationError({state_->path.string(), "a movie without frames", "", "add at least one picture"});
    state_->encoder.reset();
    // The writer reports no failure of the disk: count what can be read back.
    const auto found = codecs().count_frames(state_->temporary.string());
    if (std::llround(found) != static_cast<long long>(state_->frames))
        throw SimulationError({state_->path.string(),
            "the movie has " + std::to_string(std::llround(found)) + " frames of " + std::to_string(state_->frames),
            "the disk may be full", "free some space and draw again"});
    sync_and_rename(state_->temporary, state_->path);
    state_->finished = true;
    return state_->path;
}

Codec MovieWriter::codec() const { return state_->codec; }

const std::string& MovieWriter::message() const { return state_->message; }

} // namespace treacle::video
