#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace treacle::video {

// A grey picture.
struct Photo {
    std::string name; // of the file, or "clip.mp4 frame 120"
    int width = 0, height = 0;
    std::vector<std::uint8_t> grey; // [height][width], top row first
};

// Why a picture could not be read: "cut off", "not a picture".
struct Unreadable {
    std::string reason;
};

// Reads a picture, turned upright by its EXIF orientation. A file that ends before its picture does is unreadable.
// InputError with the cure for HEIC, which OpenCV cannot read, and for a missing file.
std::variant<Photo, Unreadable> read_photo(const std::filesystem::path& path);

// All pictures that a list of files and folders names, folders sorted by name. InputError when there is none.
std::vector<std::filesystem::path> list_pictures(const std::vector<std::filesystem::path>& given);

// True when the extension is that of a video.
bool is_video(const std::filesystem::path& path);

} // namespace treacle::video
