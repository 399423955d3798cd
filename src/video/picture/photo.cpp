#include "video/picture/photo.hpp"

#include "base/text/error.hpp"
#include "video/picture/codecs.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <string_view>

namespace treacle::video {

namespace fs = std::filesystem;

namespace {

using Bytes = std::vector<char>;

std::string extension_of(const fs::path& path) {
    auto text = path.extension().string();
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text;
}

bool is_picture(const fs::path& path) {
    static const std::set<std::string> known{
        ".jpg", ".jpeg", ".png", ".tif", ".tiff", ".bmp", ".webp", ".pgm", ".ppm", ".jp2", ".heic", ".heif"};
    return known.contains(extension_of(path));
}

Bytes read_bytes(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file || fs::is_directory(path))
        throw InputError({path.string(), "there is no such picture", "", "give files, or folders with pictures"});
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

bool matches(const Bytes& bytes, std::size_t at, std::string_view mark) {
    return bytes.size() >= at + mark.size() && std::string_view(bytes.data() + at, mark.size()) == mark;
}

// HEIC and AVIF are ISO media files of these brands.
bool is_heic(const Bytes& bytes) {
    if (!matches(bytes, 4, "ftyp")) return false;
    for (const auto* brand : {"heic", "heix", "hevc", "heim", "heis", "mif1", "msf1", "avif"})
        if (matches(bytes, 8, brand)) return true;
    return false;
}

// Decoders fill what is missing with grey without an error.
bool is_cut_off(const Bytes& bytes) {
    using namespace std::string_view_literals;
    const std::string_view all(bytes.data(), bytes.size());
    if (matches(bytes, 0, "\xff\xd8"sv))
        return all.find("\xff\xd9"sv, all.size() > 4096 ? all.size() - 4096 : 0) == all.npos;
    if (matches(bytes, 0, "\x89PNG"sv)) return all.rfind("IEND") == all.npos;
    return false;
}

} // namespace

namespace {

// Picture without pixels where the bytes cannot be decoded.
cv::Mat decoded_grey(const Bytes& bytes) {
    try {
        return codecs().decode(
            cv::Mat(1, int(bytes.size()), CV_8U, const_cast<char*>(bytes.data())), cv::IMREAD_GRAYSCALE);
    } catch (const cv::Exception&) {
        return {};
    }
}

} // namespace

std::variant<Photo, Unreadable> read_photo(const fs::path& path) {
    const Bytes bytes = read_bytes(path);
    if (is_heic(bytes))
        throw InputError({path.string(), "is a HEIC picture, which this program cannot read",
            "phones store them unless told otherwise",
            "convert it to JPEG or PNG, or choose \"most compatible\" in the phone's camera settings"});
    if (bytes.empty()) return Unreadable{"the file is empty"};
    if (is_cut_off(bytes)) return Unreadable{"the file is cut off"};
    const cv::Mat grey = decoded_grey(bytes);
    if (grey.empty()) return Unreadable{"not a picture that can be decoded"};
    Photo photo{path.filename().string(), grey.cols, grey.rows, {}};
    photo.grey.reserve(grey.total());
    for (int row = 0; row < grey.rows; ++row)
        photo.grey.insert(photo.grey.end(), grey.ptr<std::uint8_t>(row), grey.ptr<std::uint8_t>(row) + grey.cols);
    return photo;
}

std::vector<fs::path> list_pictures(const std::vector<fs::path>& given) {
    std::vector<fs::path> out;
    for (const auto& path : given) {
        if (!fs::is_directory(path)) {
            out.push_back(path);
            continue;
        }
        std::vector<fs::path> inside;
        for (const auto& entry : fs::directory_iterator(path))
            if (entry.is_regular_file() && is_picture(entry.path())) inside.push_back(entry.path());
        if (inside.empty())
            throw InputError(
                {path.string(), "holds no pictures", "looked for JPEG, PNG, TIFF, BMP, WebP", "give another folder"});
        std::ranges::sort(inside);
        out.insert(out.end(), inside.begin(), inside.end());
    }
    return out;
}

bool is_video(const fs::path& path) {
    static const std::set<std::string> known{".mp4", ".mov", ".avi", ".mkv", ".webm", ".m4v", ".mts", ".3gp"};
    return known.contains(extension_of(path));
}

} // namespace treacle::video
