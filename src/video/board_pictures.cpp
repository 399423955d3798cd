#include "video/board_pictures.hpp"

#include "base/error.hpp"
#include "base/text.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace treacle::video {

namespace {

constexpr std::size_t sizes_tried_on = 4; // pictures

std::string rounded(double value) { return format_number(std::round(10 * value) / 10); }

BoardPicture look_at(const Photo& photo, const Board& board, const BoardSearch& search) {
    BoardPicture out;
    out.name = photo.name;
    out.width = photo.width;
    out.height = photo.height;
    const auto view = find_board(photo, board, search);
    if (!view) {
        out.reason = "no " + board.text() + " was found";
        return out;
    }
    out.view = *view;
    out.state = view->is_blurred() ? PictureState::blurred : PictureState::used;
    if (view->is_blurred())
        out.reason = "blurred: edges are " + rounded(view->edge_width) + " pixels wide, squares " + rounded(view->separation);
    return out;
}

// The size that fits in most of the pictures looked at, with the number of these.
std::optional<std::pair<Board, std::size_t>> common_size(const std::vector<Photo>& photos, const Board& board, OtherSizes sizes) {
    std::map<std::pair<int, int>, std::size_t> votes;
    for (const auto& photo : photos)
        if (const auto other = find_other_size(photo, board, sizes)) ++votes[{other->columns, other->rows}];
    const auto most = std::ranges::max_element(votes, {}, [](const auto& vote) { return vote.second; });
    if (most == votes.end() || 2 * most->second <= photos.size()) return {};
    Board other = board;
    std::tie(other.columns, other.rows) = most->first;
    return std::pair(other, most->second);
}

[[noreturn]] void refuse_size(const Board& board, const Board& other, std::size_t votes, std::size_t tried) {
    const bool squares = board.columns == other.columns + 1 && board.rows == other.rows + 1;
    throw InputError({"--board", "the pictures show a " + other.text() + ", not a " + board.text(),
                      "seen in " + std::to_string(votes) + " of " + std::to_string(tried) + " pictures tried" +
                          (squares ? "; corners where four squares meet are counted, not squares" : ""),
                      "write --board " + std::to_string(other.columns) + "x" + std::to_string(other.rows)});
}

void check_size(const std::vector<Photo>& found, const std::vector<Photo>& missed, const Board& board) {
    if (board.kind != BoardKind::chessboard) return;
    if (const auto larger = common_size(found, board, OtherSizes::larger))
        refuse_size(board, larger->first, larger->second, found.size());
    if (!found.empty()) return;
    if (const auto other = common_size(missed, board, OtherSizes::all))
        refuse_size(board, other->first, other->second, missed.size());
}

} // namespace

std::vector<BoardPicture> find_boards(const std::vector<std::filesystem::path>& paths, const Board& board,
                                      const BoardPicturesOptions& options) {
    std::vector<BoardPicture> out;
    std::vector<Photo> found, missed; // a few of each
    for (const auto& path : paths) {
        options.progress(double(out.size()) / double(paths.size()), path.filename().string());
        auto read = read_photo(path);
        if (const auto* unreadable = std::get_if<Unreadable>(&read)) {
            BoardPicture& picture = out.emplace_back();
            picture.name = path.filename().string();
            picture.state = PictureState::unreadable;
            picture.reason = unreadable->reason;
            continue;
        }
        out.push_back(look_at(std::get<Photo>(read), board, options.search));
        auto& list = out.back().state == PictureState::no_board ? missed : found;
        if (list.size() < sizes_tried_on) list.push_back(std::move(std::get<Photo>(read)));
    }
    check_size(found, missed, board);
    return out;
}

} // namespace treacle::video
