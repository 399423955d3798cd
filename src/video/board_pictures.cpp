#include "video/board_pictures.hpp"

#include "base/error.hpp"
#include "base/text.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace treacle::video {

namespace {

constexpr std::size_t sizes_tried_on = 5; // pictures, of which three must agree

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

[[noreturn]] void refuse_size(const Board& board, const Board& other, std::size_t votes, std::size_t tried) {
    const bool squares = board.columns == other.columns + 1 && board.rows == other.rows + 1;
    const bool turned = (other.columns + other.rows) % 2 == 0;
    throw InputError({"--board", "the pictures show a " + other.text() + ", not a " + board.text(),
                      "seen in " + std::to_string(votes) + " of the first " + std::to_string(tried) + " pictures" +
                          (squares ? "; corners where four squares meet are counted, not squares" : ""),
                      turned ? "take another board: this one looks the same turned by 180 degrees"
                             : "write --board " + std::to_string(other.columns) + "x" + std::to_string(other.rows)});
}

// Whether the board of most of the first pictures has the size given. Searches for a wrong one would take minutes.
void check_size(const std::vector<std::filesystem::path>& paths, const Board& board) {
    if (board.kind != BoardKind::chessboard) return;
    std::map<std::array<int, 2>, std::size_t> votes;
    std::size_t tried = 0;
    for (const auto& path : paths) {
        if (tried == sizes_tried_on) break;
        const auto read = read_photo(path);
        const auto* photo = std::get_if<Photo>(&read);
        if (!photo) continue;
        ++tried;
        if (const auto size = size_of_chessboard(*photo)) ++votes[*size];
    }
    const std::array<int, 2> given{std::max(board.columns, board.rows), std::min(board.columns, board.rows)};
    for (const auto& [size, count] : votes) {
        if (size == given || 2 * count <= tried || count < std::min<std::size_t>(3, tried)) continue;
        Board other = board;
        other.columns = size[0];
        other.rows = size[1];
        refuse_size(board, other, count, tried);
    }
}

} // namespace

std::vector<BoardPicture> find_boards(const std::vector<std::filesystem::path>& paths, const Board& board,
                                      const BoardPicturesOptions& options) {
    check_size(paths, board);
    std::vector<BoardPicture> out;
    for (const auto& path : paths) {
        options.progress(double(out.size()) / double(paths.size()), path.filename().string());
        const auto read = read_photo(path);
        if (const auto* unreadable = std::get_if<Unreadable>(&read)) {
            BoardPicture& picture = out.emplace_back();
            picture.name = path.filename().string();
            picture.state = PictureState::unreadable;
            picture.reason = unreadable->reason;
            continue;
        }
        out.push_back(look_at(std::get<Photo>(read), board, options.search));
    }
    return out;
}

} // namespace treacle::video
