#pragma once
#include "base/text/vec3.hpp"
#include "video/picture/photo.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace treacle::video {

// Kinds of flat targets that find_board recognises.
enum class BoardKind {
    chessboard,         // corners of squares
    asymmetric_circles, // rows of circles, every second one shifted by half of the distance in a row
    symmetric_circles,
};

// A flat calibration target. Its points are the inner corners of a chessboard or the centres of circles.
struct Board {
    BoardKind kind = BoardKind::chessboard;
    int columns = 9, rows = 6; // of points
    double spacing = 0;        // [m] side of a square; circles: between neighbouring rows

    std::string text() const;                    // "chessboard with 9 x 6 inner corners"
    int count() const { return columns * rows; } // points of the whole board
};

// "9x6", "circles 4x11", "symmetric 7x5". InputError.
Board read_board(const std::string& text);

// InputError for a board that is the same turned by 180 degrees: its place in the scene would have two answers.
// Chessboards whose numbers of corners are both even or both odd, asymmetric circles with an even number of rows,
// symmetric circles.
void check_board(const Board& board);

// Places of the points [m], row by row, in axes of the board: x along a row, y along a column, z into the board, away
// from the viewer. The first point of a chessboard is the inner corner of a black corner square.
std::vector<Vec3> board_points(const Board& board);

// The points in a picture.
struct BoardView {
    std::vector<std::array<double, 2>> points; // [pixels], centre of the top left pixel at (0, 0)
    double edge_width = 0; // [pixels] over which the edges of squares rise from 10 to 90 %; circles: 0
    double separation = 0; // [pixels] smallest distance of neighbours
    double diameter = 0;   // [m] of circles, as they are seen; chessboards: 0
    bool is_blurred() const { return edge_width > 0.35 * separation; }
};

struct BoardSearch {
    // [pixels] half of the side of the window in which a corner is refined; 0: 0.4 of the smallest distance between
    // neighbours, 2 to 11. A window that reaches the next corner moves both.
    int window = 0;
};

// Points to sub-pixel accuracy; nothing where the board is not seen as a whole.
std::optional<BoardView> find_board(const Photo& photo, const Board& board, const BoardSearch& search = {});

// Numbers of inner corners of the chessboard in a picture, whatever its size, the larger one first; nothing where there is
// none of at least 4 x 3.
std::optional<std::array<int, 2>> size_of_chessboard(const Photo& photo);

} // namespace treacle::video
