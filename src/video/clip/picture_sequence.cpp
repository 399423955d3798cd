#include "video/clip/picture_sequence.hpp"

#include "base/text/text.hpp"
#include "video/picture/codecs.hpp"
#include "video/picture/number_table.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fnmatch.h>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <regex>

namespace treacle::video {

namespace {
namespace fs = std::filesystem;

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

bool picture_name(const fs::path& path) {
    constexpr std::array endings = {
        ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp", ".pgm", ".ppm", ".heic", ".heif"};
    return std::ranges::find(endings, lower(path.extension().string())) != endings.end();
}

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// Digits from k on, without leading zeros; k goes behind them.
std::string take_number(const std::string& text, std::size_t& k) {
    while (k < text.size() && text[k] == '0') ++k;
    const auto start = k;
    while (k < text.size() && is_digit(text[k])) ++k;
    return text.substr(start, k - start);
}

// "a10" after "a9": numbers by value, the rest by letter.
bool before(const std::string& a, const std::string& b) {
    std::size_t i = 0, j = 0;

    while (i < a.size() && j < b.size()) {
        if (is_digit(a[i]) && is_digit(b[j])) {

            const auto x = take_number(a, i), y = take_number(b, j);
            if (x.size() != y.size()) return x.size() < y.size();
            if (x != y) return x < y;
        } else if (a[i] != b[j]) {
            return a[i] < b[j];
        } else {
            ++i, ++j;
        }
    }
    return a.size() - i < b.size() - j || (a.size() - i == b.size() - j && a < b);
}

bool is_pattern(const std::string& name) { return name.find_first_of("*?%") != std::string::npos; }

// "frame_%04d.png" as a regular expression with the number in its first group.
std::regex number_pattern(const std::string& name, const fs::path& clip) {
    static const std::regex number("%0?[0-9]*d");
    std::smatch found;
    if (!std::regex_search(name, found, number))
        throw InputError({clip.string(), "is no pattern of pictures", "% must begin a number such as %04d",
            "write for instance frame_%04d.png"});
    const auto quote = [](const std::string& text) {
        static const std::regex special(R"([.^$|()\[\]{}*+?\\])");
        return std::regex_replace(text, special, R"(\$&)");
    };
    return std::regex(quote(found.prefix()) + "([0-9]+)" + quote(found.suffix()));
}

std::vector<fs::path> numbered(const fs::path& folder, const fs::path& clip) {
    const auto pattern = number_pattern(clip.filename().string(), clip);
    std::vector<std::pair<long, fs::path>> found;
    for (const auto& entry : fs::directory_iterator(folder)) {
        std::smatch match;
        const auto name = entry.path().filename().string();
        if (std::regex_match(name, match, pattern)) found.emplace_back(std::stol(match[1]), entry.path());
    }
    std::ranges::sort(found);
    std::vector<fs::path> paths;
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (i > 0 && found[i].first != found[i - 1].first + 1)
            throw InputError({clip.string(), "number " + std::to_string(found[i - 1].first + 1) + " is missing",
                "the frames after it would get wrong times", "add it, or name the pictures by *.png with --times"});
        paths.push_back(found[i].second);
    }
    return paths;
}

std::vector<fs::path> list_pictures(const fs::path& clip) {
    const auto folder = fs::is_directory(clip) ? clip : clip.has_parent_path() ? clip.parent_path() : fs::path(".");
    const auto name = clip.filename().string();
    if (!fs::is_directory(folder)) throw InputError({clip.string(), "there is no such folder", "", "check its name"});
    if (!fs::is_directory(clip) && name.find('%') != std::string::npos) return numbered(folder, clip);
    std::vector<fs::path> paths;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const auto file = entry.path().filename().string();
        const bool wanted = fs::is_directory(clip) ? picture_name(entry.path()) && file.front() != '.'
                                                   : fnmatch(name.c_str(), file.c_str(), FNM_PERIOD) == 0;
        if (wanted && entry.is_regular_file()) paths.push_back(entry.path());
    }
    std::ranges::sort(paths,
        [](const fs::path& a, const fs::path& b) { return before(a.filename().string(), b.filename().string()); });
    return paths;
}

std::vector<double> times_of(const SourceRequest& request, std::size_t count) {
    std::vector<double> times;
    if (!request.times.empty()) {
        times = NumberTable(request.times).column("time", unit::time);
        if (times.size() != count)
            throw InputError({request.times.string(), "has " + std::to_string(times.size()) + " times",
                request.clip.string() + " has " + std::to_string(count) + " pictures", "give one row a picture"});
        if (std::ranges::adjacent_find(times, [](double a, double b) { return !(a < b); }) != times.end())
            throw InputError({request.times.string(), "its times do not ascend", "", "sort them as the pictures"});
        return times;
    }
    if (!(request.rate > 0))
        throw InputError({request.clip.string(), "is a sequence of pictures without times", "pictures carry none",
            "give --rate FRAMES_PER_SECOND, or --times FILE.csv with a column time"});
    for (std::size_t i = 0; i < count; ++i) times.push_back(static_cast<double>(i) / request.rate);
    return times;
}

Image load(const fs::path& path, int& bits) {
    if (is_heif(path)) throw heif_refused(path);
    cv::Mat read = codecs().read(path.string(), cv::IMREAD_ANYDEPTH | cv::IMREAD_COLOR);
    if (read.empty())
        throw InputError({path.string(), "is no picture that can be read", "", "PNG, JPEG and TIFF are usual"});
    bits = read.depth() == CV_8U ? 8 : 16;
    if (read.depth() == CV_16U) read.convertTo(read, CV_8U, 1 / 257.0);
    Image image{read.cols, read.rows, std::vector<std::uint8_t>(3 * read.total())};
    cv::Mat rgb(read.rows, read.cols, CV_8UC3, image.pixels.data());
    cv::cvtColor(read, rgb, cv::COLOR_BGR2RGB);
    return image;
}

class PictureSequence final : public FrameSource {
public:
    explicit PictureSequence(const SourceRequest& request) : paths_(list_pictures(request.clip)) {
        if (!paths_.empty() && is_heif(paths_.front())) throw heif_refused(paths_.front());
        if (paths_.size() < 2)
            throw InputError({request.clip.string(), paths_.empty() ? "holds no picture" : "is a single picture",
                "a clip has two frames at least",
                "name a folder, or a pattern such as \"frame_%04d.png\" or \"*.png\""});
        const auto first = load(paths_.front(), info_.bits);
        info_.file = request.clip.string();
        info_.kind = std::to_string(paths_.size()) + " pictures";
        info_.width = first.width;
        info_.height = first.height;
        info_.fields = FieldOrder::progressive;
        info_.stamps = times_of(request, paths_.size());
    }

    const ClipInfo& info() const override { return info_; }
    void rewind() override { next_ = 0; }

    bool read(TimedFrame& out) override {
        if (next_ == paths_.size()) return false;
        int bits = 8;
        out.image = load(paths_[next_], bits);
        if (out.image.width != info_.width || out.image.height != info_.height)
            throw InputError({paths_[next_].string(),
                "is " + std::to_string(out.image.width) + " x " + std::to_string(out.image.height) + " pixels",
                paths_.front().filename().string() + " is " + std::to_string(info_.width) + " x " +
                    std::to_string(info_.height),
                "all frames of a clip have one size"});
        out.index = static_cast<std::int64_t>(next_);
        out.stamp = out.time = info_.stamps[next_++];
        return true;
    }

private:
    std::vector<fs::path> paths_;
    ClipInfo info_;
    std::size_t next_ = 0;
};
} // namespace

bool names_pictures(const fs::path& clip) {
    return fs::is_directory(clip) || picture_name(clip) || (!fs::exists(clip) && is_pattern(clip.filename().string()));
}

bool is_heif(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::array<char, 12> start{};
    if (!file.read(start.data(), start.size())) return false;
    const std::string_view text(start.data(), start.size());
    if (text.substr(4, 4) != "ftyp") return false;
    constexpr std::array<std::string_view, 7> brands = {"heic", "heix", "hevc", "heim", "heis", "mif1", "msf1"};
    return std::ranges::find(brands, text.substr(8, 4)) != brands.end();
}

InputError heif_refused(const fs::path& path) {
    return InputError({path.string(), "is a HEIC picture, which OpenCV cannot read", "it is the default of iPhones",
        "convert it with `heif-convert IN.heic OUT.png`, or set Camera, Formats, Most Compatible"});
}

std::unique_ptr<FrameSource> open_pictures(const SourceRequest& request) {
    return std::make_unique<PictureSequence>(request);
}

} // namespace treacle::video
