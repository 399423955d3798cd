#pragma once
#include "video/camera/calibration.hpp"

#include <functional>

namespace treacle::video {

// Options of find_boards.
struct BoardPicturesOptions {
    BoardSearch search; // the same for every picture
    // Called after each picture and frame, with the part of the work that is done, 0 to 1.
    std::function<void(double fraction)> progress = [](double) {};
};

// Searches the board in each picture, and in frames of videos, of which those are taken that show it at another place.
// Pictures that cannot be read, show no board or are blurred are named with the reason; they stop nothing. InputError when the
// board of most of the first pictures has another size than the one given, with the size that fits; for a HEIC picture.
std::vector<BoardPicture> find_boards(
    const std::vector<std::filesystem::path>& paths, const Board& board, const BoardPicturesOptions& options);

} // namespace treacle::video
