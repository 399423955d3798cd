#include "video/clip/frame_source.hpp"

#include "base/median.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/clip/picture_sequence.hpp"
#include "video/clip/usable_clip.hpp"
#include "video/clip/video_file.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::video {

int Orientation::degrees() const {
    if (a == 1 || (a == -1 && mirrored())) return 0;
    if (a == -1) return 180;
    return b == 1 ? 90 : 270;
}

Image turn(const Image& image, const Orientation& o) {
    Image out;
    out.width = o.swaps_sides() ? image.height : image.width;
    out.height = o.swaps_sides() ? image.width : image.height;
    out.pixels.resize(image.pixels.size());
    const int left = std::min(0, o.a * (image.width - 1)) + std::min(0, o.c * (image.height - 1));
    const int top = std::min(0, o.b * (image.width - 1)) + std::min(0, o.d * (image.height - 1));
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const int column = o.a * x + o.c * y - left, row = o.b * x + o.d * y - top;
            std::copy_n(image.at(x, y), 3,
                out.pixels.data() + 3 * (std::size_t(row) * std::size_t(out.width) + std::size_t(column)));
        }
    }
    return out;
}

double ClipInfo::rate() const {
    const double span = stamps.size() < 2 ? 0 : stamps.back() - stamps.front();
    return span > 0 ? static_cast<double>(stamps.size() - 1) / span : 0;
}

double ClipInfo::median_interval() const {
    if (stamps.size() < 2) return 0;
    std::vector<double> steps;
    for (std::size_t i = 1; i < stamps.size(); ++i) steps.push_back(stamps[i] - stamps[i - 1]);
    return upper_median(steps);
}

bool ClipInfo::variable_rate() const {
    const double usual = median_interval();
    for (std::size_t i = 1; i < stamps.size(); ++i)
        if (std::abs(stamps[i] - stamps[i - 1] - usual) > 0.01 * usual + 1.01 * tick) return true;
    return false;
}

namespace {
TimeMap map_of(const SourceRequest& request, const ClipInfo& info) {
    if (!request.time_map.empty() && request.true_rate > 0)
        throw InputError(
            {"--time-map and --true-rate", "exclude each other", "both say when frames were shot", "give one"});
    if (!request.time_map.empty()) return TimeMap::read(request.time_map);
    if (!(request.true_rate > 0)) return {};
    if (info.variable_rate())
        throw InputError({info.file, "has a variable rate: --true-rate does not fit",
            "a slow-motion file that a phone exports runs at normal speed at its ends", "give --time-map"});
    return TimeMap::slowed(info.stamps.front(), info.rate(), request.true_rate);
}

// Frames of another source at their true times.
class MappedSource final : public FrameSource {
public:
    MappedSource(std::unique_ptr<FrameSource> source, const SourceRequest& request)
        : source_(std::move(source)), map_(map_of(request, source_->info())), info_(source_->info()) {
        for (const double stamp : info_.stamps) info_.times.push_back(map_.at(stamp));
    }

    const ClipInfo& info() const override { return info_; }
    void rewind() override { source_->rewind(); }
    bool read(TimedFrame& frame) override {
        if (!source_->read(frame)) return false;
        frame.time = map_.at(frame.stamp);
        return true;
    }

private:
    std::unique_ptr<FrameSource> source_;
    TimeMap map_;
    ClipInfo info_;
};

} // namespace

std::vector<Diagnostic> reasons_against(const ClipInfo& info) {
    std::vector<Diagnostic> found;
    if (info.fields == FieldOrder::interlaced)
        found.push_back({info.file, "is interlaced", "its odd and even rows are of different times",
            "film progressive, or convert it with `ffmpeg -i IN -vf bwdif=mode=send_field -c:v libx264 -crf 12 "
            "OUT.mp4`"});
    if (info.transfer == Transfer::pq || info.transfer == Transfer::hlg)
        found.push_back({info.file,
            std::string("is HDR video (") + (info.transfer == Transfer::pq ? "PQ" : "HLG") + ", " +
                std::to_string(info.bits) + " bit)",
            "its levels are not those of a standard picture",
            "film with HDR off, or convert it with `ffmpeg -i IN -vf "
            "zscale=t=linear:npl=100,zscale=t=bt709:m=bt709:r=tv,format=yuv420p OUT.mp4`"});
    if (std::abs(info.pixel_aspect - 1) > 1e-3)
        found.push_back({info.file,
            "has pixels that are not square (" + format_number(std::round(1e4 * info.pixel_aspect) / 1e4) +
                " wide to 1 high)",
            "a camera calibrated on square ones would not fit",
            "convert it with `ffmpeg -i IN -vf scale=iw*sar:ih,setsar=1 OUT.mp4`"});
    if (info.orientation.mirrored())
        found.push_back({info.file, "is mirrored by its display matrix", "front cameras do so",
            "film with the back camera, or convert it with `ffmpeg -i IN OUT`"});
    return found;
}

std::unique_ptr<FrameSource> open_any_frames(const SourceRequest& request) {
    const auto& clip = request.clip;
    if (names_pictures(clip)) return std::make_unique<MappedSource>(open_pictures(request), request);
    if (!std::filesystem::exists(clip))
        throw InputError({clip.string(), "there is no such file", "", "check its name"});
    if (is_heif(clip)) throw heif_refused(clip);
    return std::make_unique<MappedSource>(open_video_file(request), request);
}

std::unique_ptr<FrameSource> open_frames(const SourceRequest& request) {
    auto source = open_any_frames(request);
    auto reasons = reasons_against(source->info());
    if (!reasons.empty()) throw InputError(std::move(reasons));
    return source;
}

} // namespace treacle::video
