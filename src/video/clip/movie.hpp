#pragma once
#include "video/picture/image.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace treacle::video {

// Writes a PNG as a whole; the same picture gives the same bytes.
// SimulationError when the folder is missing or cannot be written; an older file then stands.
void write_png(const std::filesystem::path& path, const Image& image);

// Codec and container of a movie.
enum class Codec {
    h264,        // MP4, plays everywhere
    mpeg4,       // MP4
    motion_jpeg, // AVI, always available
};

// All, best first.
std::vector<Codec> all_codecs();

// Format of a movie.
struct MovieOptions {
    double frames_per_second = 30;            // positive, constant
    int width = 1280, height = 720;           // [pixels], even: the codecs store colours of 2 x 2 pixels together
    std::vector<Codec> codecs = all_codecs(); // the first that works is taken
};

// A movie under a temporary name until `finish`; an unfinished one leaves nothing behind.
class MovieWriter {
public:
    // InputError for a bad frame rate or size; SimulationError for a folder that cannot be written or when no
    // codec works.
    MovieWriter(const std::filesystem::path& path, const MovieOptions& options);
    ~MovieWriter();
    MovieWriter(MovieWriter&&) noexcept;
    MovieWriter& operator=(MovieWriter&&) = delete;

    // InputError for a picture of another size.
    void add(const Image& image);
    // Syncs and renames. Returns the final path, which ends in .avi when only motion JPEG works.
    // SimulationError without frames or when the disk is full.
    std::filesystem::path finish();

    Codec codec() const; // the one in use, chosen in the order of the options
    // Note for the user: that another codec than the first one was taken; otherwise empty.
    const std::string& message() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace treacle::video
