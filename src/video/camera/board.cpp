#include "video/camera/board.hpp"

#include "base/median.hpp"
#include "base/text/error.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

namespace {

constexpr int largest_search = 1600; // [pixels] width or height of the picture in which boards are searched

using Points = std::vector<cv::Point2f>;

cv::Mat matrix_of(const Photo& photo) {
    cv::setNumThreads(1);
    return {photo.height, photo.width, CV_8U, const_cast<std::uint8_t*>(photo.grey.data())};
}

double distance(const cv::Point2f& a, const cv::Point2f& b) { return std::hypot(a.x - b.x, a.y - b.y); }

double smallest_distance(const Points& points, const Board& board) {
    double least = 1e30;
    for (int row = 0; row < board.rows; ++row)
        for (int column = 0; column < board.columns; ++column) {
            const std::size_t i = std::size_t(row) * board.columns + column;
            if (column + 1 < board.columns) least = std::min(least, distance(points[i], points[i + 1]));
            if (row + 1 < board.rows) least = std::min(least, distance(points[i], points[i + board.columns]));
        }
    return least;
}

// Rows from left to right as seen from the front: the y axis is 90 degrees clockwise of x in the picture.
void make_right_handed(Points& points, const Board& board) {
    const auto& origin = points.front();
    const cv::Point2f x = points[std::size_t(board.columns) - 1] - origin;
    const cv::Point2f y = points[std::size_t(board.columns) * (board.rows - 1)] - origin;
    if (x.x * y.y - x.y * y.x > 0) return;
    for (int row = 0; row < board.rows; ++row)
        std::reverse(points.begin() + std::ptrdiff_t(row) * board.columns,
            points.begin() + std::ptrdiff_t(row + 1) * board.columns);
}

// Least share of squares between the points that are light and dark in turns: those of a grid that OpenCV finds where
// there is none are not.
constexpr double least_alternating = 0.97;

bool alternates(const cv::Mat& picture, const Points& points, const Board& board) {
    const int columns = board.columns - 1, rows = board.rows - 1;
    std::vector<double> grey;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const std::size_t i = std::size_t(row) * board.columns + column, w = std::size_t(board.columns);
            cv::Mat patch;
            cv::getRectSubPix(
                picture, {3, 3}, 0.25f * (points[i] + points[i + 1] + points[i + w] + points[i + w + 1]), patch);
            grey.push_back(((row + column) % 2 ? -1 : 1) * cv::mean(patch)[0]);
        }
    int pairs = 0, right = 0;
    const auto count = [&](int a, int b) {
        ++pairs;
        right += grey[std::size_t(a)] + grey[std::size_t(b)] > 0 ? 1 : 0; // even squares minus odd ones
    };
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const int i = row * columns + column;
            if (column + 1 < columns) count(i, i + 1);
            if (row + 1 < rows) count(i, i + columns);
        }
    return std::max(right, pairs - right) >= least_alternating * pairs;
}

// Grey level in the middle of the corner square that lies outside of a corner of the grid.
double corner_square(
    const cv::Mat& picture, const Points& points, std::size_t corner, std::size_t beside, std::size_t below) {
    const cv::Point2f at = points[corner] - 0.5f * (points[beside] - points[corner] + points[below] - points[corner]);
    cv::Mat patch;
    cv::getRectSubPix(picture, {3, 3}, at, patch);
    return cv::mean(patch)[0];
}

// The first point beside a black corner square; the last one lies beside a white one.
void start_at_black(const cv::Mat& picture, Points& points, const Board& board) {
    const std::size_t n = points.size(), w = std::size_t(board.columns);
    const double first = corner_square(picture, points, 0, 1, w);
    const double last = corner_square(picture, points, n - 1, n - 2, n - 1 - w);
    if (first > last) std::reverse(points.begin(), points.end());
}

void refine(const cv::Mat& picture, Points& points, const Board& board, const BoardSearch& search) {
    // The window stays within the four squares that meet at a corner.
    const int half = search.window > 0 ? search.window : std::clamp(int(0.4 * smallest_distance(points, board)), 2, 11);
    const cv::TermCriteria stop(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 60, 1e-4);
    cv::cornerSubPix(picture, points, {half, half}, {-1, -1}, stop);
}

double edge_width(const cv::Mat& picture, const Points& points, const Board& board) {
    double widest = 0;
    for (const bool vertical : {false, true})
        widest = std::max(
            widest, cv::estimateChessboardSharpness(picture, {board.columns, board.rows}, points, 0.8f, vertical)[0]);
    return widest;
}

Points find_corners(const cv::Mat& picture, const Board& board) {
    const double scale = std::min(1.0, double(largest_search) / std::max(picture.cols, picture.rows));
    cv::Mat small = picture;
    if (scale < 1) cv::resize(picture, small, {}, scale, scale, cv::INTER_AREA);
    const cv::Size size(board.columns, board.rows);
    Points points;
    const int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE;
    if (!cv::findChessboardCorners(small, size, points, flags | cv::CALIB_CB_FAST_CHECK) &&
        !cv::findChessboardCornersSB(small, size, points, cv::CALIB_CB_NORMALIZE_IMAGE))
        return {};
    if (scale < 1) {
        refine(small, points, board, {});
        for (auto& p : points) p = cv::Point2f(float((p.x + 0.5) / scale - 0.5), float((p.y + 0.5) / scale - 0.5));
    }
    return points;
}

Points find_circles(const cv::Mat& picture, const Board& board) {
    const bool symmetric = board.kind == BoardKind::symmetric_circles;
    const int flags = symmetric ? cv::CALIB_CB_SYMMETRIC_GRID : cv::CALIB_CB_ASYMMETRIC_GRID;
    cv::SimpleBlobDetector::Params parameters;
    parameters.maxArea = float(picture.total()) / 50;
    parameters.minDistBetweenBlobs = 4;
    const auto blobs = cv::SimpleBlobDetector::create(parameters);
    Points points;
    if (!cv::findCirclesGrid(picture, {board.columns, board.rows}, points, flags, blobs) &&
        !cv::findCirclesGrid(picture, {board.columns, board.rows}, points, flags | cv::CALIB_CB_CLUSTERING, blobs))
        return {};
    return points;
}

// Area [pixels] of what stands out from the rim of a disc: by its light, so that blur counts for nothing.
double area_within(const cv::Mat& picture, const cv::Point2f& centre, double radius) {
    double rim = 0, rim_count = 0, light = 0, count = 0;
    const auto clamped = [](double v, int size) { return std::clamp(int(std::lround(v)), 0, size - 1); };
    for (int row = clamped(centre.y - radius, picture.rows); row <= clamped(centre.y + radius, picture.rows); ++row)
        for (int column = clamped(centre.x - radius, picture.cols); column <= clamped(centre.x + radius, picture.cols);
             ++column) {
            const double apart = std::hypot(column - centre.x, row - centre.y),
                         value = picture.at<std::uint8_t>(row, column);
            if (apart > radius) continue;
            light += value;
            ++count;
            if (apart < 0.85 * radius) continue;
            rim += value;
            ++rim_count;
        }
    cv::Mat middle;
    cv::getRectSubPix(picture, {3, 3}, centre, middle);
    const double contrast = cv::mean(middle)[0] - rim / rim_count;
    return std::abs(contrast) < 1 ? 0 : (light - count * rim / rim_count) / contrast;
}

// Diameter [m] of circles: median of what their areas are on the board, by the homography that the points give.
double circle_diameter(const cv::Mat& picture, const Points& points, const Board& board) {
    if (!(board.spacing > 0)) return 0;
    std::vector<cv::Point2f> positions;
    for (const auto& p : board_points(board)) positions.emplace_back(float(p[0]), float(p[1]));
    const cv::Mat h = cv::findHomography(positions, points);
    if (h.empty()) return 0;
    std::vector<double> diameters;
    for (std::size_t i = 0; i < points.size(); ++i) {
        double nearest = 1e30;
        for (std::size_t j = 0; j < points.size(); ++j)
            if (j != i) nearest = std::min(nearest, distance(points[i], points[j]));
        const double w = h.at<double>(2, 0) * positions[i].x + h.at<double>(2, 1) * positions[i].y + h.at<double>(2, 2);
        const double area =
            area_within(picture, points[i], nearest / 2) * std::abs(w * w * w / cv::determinant(h)); // [m2]
        diameters.push_back(std::sqrt(std::max(0.0, area) * 4 / std::numbers::pi));
    }
    return upper_median(diameters);
}

bool is_inside(const Points& points, const cv::Mat& picture) {
    return std::ranges::all_of(points, [&](const cv::Point2f& p) {
        return p.x >= 0 && p.y >= 0 && p.x <= float(picture.cols - 1) && p.y <= float(picture.rows - 1);
    });
}

} // namespace

std::string Board::text() const {
    const auto size = std::to_string(columns) + " x " + std::to_string(rows);
    if (kind == BoardKind::chessboard) return "chessboard with " + size + " inner corners";
    return (kind == BoardKind::symmetric_circles ? "symmetric grid of " : "asymmetric grid of ") + size + " circles";
}

Board read_board(const std::string& text) {
    Board board;
    std::string size = text;
    const auto take = [&](const std::string& word, BoardKind kind) {
        if (!size.starts_with(word)) return;
        board.kind = kind;
        size = size.substr(word.size());
    };
    take("chessboard", BoardKind::chessboard);
    take("circles", BoardKind::asymmetric_circles);
    take("symmetric", BoardKind::symmetric_circles);
    while (!size.empty() && (size.front() == ' ' || size.front() == ':')) size.erase(0, 1);
    char rest = 0;
    if (std::sscanf(size.c_str(), "%3dx%3d%c", &board.columns, &board.rows, &rest) != 2 || board.columns < 2 ||
        board.rows < 2)
        throw InputError({"--board " + text, "is no board", "it takes the numbers of points of a row and of a column",
            "write 9x6 for a chessboard with 9 x 6 inner corners, circles:4x11 for an asymmetric grid of circles"});
    return board;
}

void check_board(const Board& board) {
    const bool alike = board.kind == BoardKind::symmetric_circles ||
                       (board.kind == BoardKind::chessboard && (board.columns + board.rows) % 2 == 0) ||
                       (board.kind == BoardKind::asymmetric_circles && board.rows % 2 == 0);
    if (!alike) return;
    throw InputError(
        {"--board", "a " + board.text() + " looks the same turned by 180 degrees", "its pose would have two answers",
            board.kind == BoardKind::chessboard
                ? "take one whose numbers of inner corners are one even and one odd, such as 9x6"
                : "take an asymmetric grid with an odd number of rows, such as circles:4x11"});
}

std::vector<Vec3> board_points(const Board& board) {
    std::vector<Vec3> out;
    for (int row = 0; row < board.rows; ++row)
        for (int column = 0; column < board.columns; ++column) {
            const double x = board.kind == BoardKind::asymmetric_circles ? 2 * column + row % 2 : column;
            out.push_back({x * board.spacing, row * board.spacing, 0});
        }
    return out;
}

std::optional<BoardView> find_board(const Photo& photo, const Board& board, const BoardSearch& search) {
    const cv::Mat picture = matrix_of(photo);
    const bool chessboard = board.kind == BoardKind::chessboard;
    Points points = chessboard ? find_corners(picture, board) : find_circles(picture, board);
    if (points.size() != std::size_t(board.count()) || !is_inside(points, picture)) return {};
    BoardView view;
    if (chessboard) {
        if (!alternates(picture, points, board)) return {};
        make_right_handed(points, board);
        refine(picture, points, board, search);
        start_at_black(picture, points, board);
        view.edge_width = edge_width(picture, points, board);
    } else {
        view.diameter = circle_diameter(picture, points, board);
    }
    view.separation = smallest_distance(points, board);
    for (const auto& p : points) view.points.push_back({p.x, p.y});
    return view;
}

std::optional<std::array<int, 2>> size_of_chessboard(const Photo& photo) {
    cv::Mat picture = matrix_of(photo), size;
    const double scale = std::min(1.0, double(largest_search) / std::max(picture.cols, picture.rows));
    if (scale < 1) cv::resize(picture, picture, {}, scale, scale, cv::INTER_AREA);
    Points points;
    if (!cv::findChessboardCornersSB(picture, {4, 3}, points, cv::CALIB_CB_LARGER | cv::CALIB_CB_NORMALIZE_IMAGE, size))
        return {};
    return std::array<int, 2>{std::max(size.cols, size.rows), std::min(size.cols, size.rows)};
}

} // namespace treacle::video
