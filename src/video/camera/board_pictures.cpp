#include "video/camera/board_pictures.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/clip/frame_source.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace treacle::video {

namespace {

constexpr std::size_t sizes_tried_on = 5;                        // pictures, of which three must agree
constexpr std::int64_t frames_looked_at = 120, frames_kept = 50; // of a video
constexpr double least_motion = 0.03; // of the board between frames that are kept, over the picture's width

Photo photo_of(const TimedFrame& frame, const std::string& clip) {
    Photo photo{clip + " frame " + std::to_string(frame.index), frame.image.width, frame.image.height, {}};
    photo.grey.reserve(frame.image.pixels.size() / 3);
    for (std::size_t i = 0; i + 2 < frame.image.pixels.size(); i += 3) {
        const auto* p = frame.image.pixels.data() + i;
        photo.grey.push_back(std::uint8_t((299 * p[0] + 587 * p[1] + 114 * p[2] + 500) / 1000)); // ITU-R BT.601
    }
    return photo;
}

// Frames of a video, evenly picked, until `visit` returns false.
void visit_frames(
    const std::filesystem::path& path, std::int64_t wanted, const std::function<bool(const Photo&, double)>& visit) {
    SourceRequest request;
    request.clip = path;
    request.allow_damage = true;
    const auto source = open_frames(request);
    const auto count = std::int64_t(source->info().stamps.size());
    const auto stride = std::max<std::int64_t>(1, count / wanted);
    TimedFrame frame;
    for (std::int64_t i = 0; source->read(frame); ++i)
        if (i % stride == 0 &&
            !visit(photo_of(frame, path.filename().string()), double(i) / double(std::max<std::int64_t>(count, 1))))
            return;
}

std::vector<Photo> first_photos(const std::vector<std::filesystem::path>& paths, std::size_t count) {
    std::vector<Photo> out;
    for (const auto& path : paths) {
        if (out.size() == count) break;
        if (is_video(path)) {
            visit_frames(path, std::int64_t(2 * count), [&](const Photo& photo, double) {
                out.push_back(photo);
                return out.size() < count;
            });
            continue;
        }
        auto read = read_photo(path);
        if (auto* photo = std::get_if<Photo>(&read)) out.push_back(std::move(*photo));
    }
    return out;
}

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
        out.reason =
            "blurred: edges are " + rounded(view->edge_width) + " pixels wide, squares " + rounded(view->separation);
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

// Checks that the board of most of the first pictures has the size given. Searches for a wrong one would take minutes.
void check_size(const std::vector<std::filesystem::path>& paths, const Board& board) {
    if (board.kind != BoardKind::chessboard) return;
    std::map<std::array<int, 2>, std::size_t> votes;
    const auto photos = first_photos(paths, sizes_tried_on);
    const std::size_t tried = photos.size();
    for (const auto& photo : photos)
        if (const auto size = size_of_chessboard(photo)) ++votes[*size];
    const std::array<int, 2> given{std::max(board.columns, board.rows), std::min(board.columns, board.rows)};
    for (const auto& [size, count] : votes) {
        if (size == given || 2 * count <= tried || count < std::min<std::size_t>(3, tried)) continue;
        Board other = board;
        other.columns = size[0];
        other.rows = size[1];
        refuse_size(board, other, count, tried);
    }
}

// Mean distance of the points of two views.
double motion(const BoardView& a, const BoardView& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.points.size(); ++i)
        sum += std::hypot(a.points[i][0] - b.points[i][0], a.points[i][1] - b.points[i][1]);
    return sum / double(a.points.size());
}

// Frames in which the board is seen elsewhere than in those before, and which of two at one place is the sharper.
void add_video(const std::filesystem::path& path, const Board& board, const BoardPicturesOptions& options,
    const std::function<void(double)>& progress, std::vector<BoardPicture>& out) {
    const std::size_t first = out.size();
    std::size_t seen = 0, looked = 0;
    visit_frames(path, frames_looked_at, [&](const Photo& photo, double fraction) {
        progress(fraction);
        ++looked;
        auto picture = look_at(photo, board, options.search);
        if (picture.state == PictureState::no_board) return true;
        ++seen;
        for (std::size_t i = first; i < out.size(); ++i) {
            if (motion(out[i].view, picture.view) > least_motion * photo.width) continue;
            if (picture.view.edge_width < out[i].view.edge_width) out[i] = picture;
            return true;
        }
        out.push_back(picture);
        return out.size() - first < std::size_t(frames_kept);
    });
    if (seen > 0) return;
    BoardPicture& none = out.emplace_back();
    none.name = path.filename().string();
    none.reason = "no " + board.text() + " was found in " + std::to_string(looked) + " frames";
}

} // namespace

std::vector<BoardPicture> find_boards(
    const std::vector<std::filesystem::path>& paths, const Board& board, const BoardPicturesOptions& options) {
    check_size(paths, board);
    std::vector<BoardPicture> out;
    for (std::size_t k = 0; k < paths.size(); ++k) {
        const auto& path = paths[k];
        const auto progress = [&](double part) { options.progress((double(k) + part) / double(paths.size())); };
        progress(0);
        if (is_video(path)) {
            add_video(path, board, options, progress, out);
            continue;
        }
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
    options.progress(1);
    return out;
}

} // namespace treacle::video
