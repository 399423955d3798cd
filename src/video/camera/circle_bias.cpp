#include "video/camera/circle_bias.hpp"

#include "video/camera/camera_matrix.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace treacle::video {

namespace {
constexpr int corners = 64; // of the polygon that stands for a circle's image
constexpr int rounds = 3;   // of pose and bias: each leaves some hundredth of the bias
} // namespace

std::vector<scene::Vec2> circle_bias(
    const scene::CameraModel& camera, const std::vector<Vec3>& centres, double diameter) {
    std::vector<scene::Vec2> out;
    for (const auto& centre : centres) {
        const auto middle = camera.project(centre);
        double area = 0, x = 0, y = 0; // moments about the middle's image
        scene::Vec2 last{0, 0};
        for (int k = 0; k <= corners; ++k) {
            const double angle = 2 * std::numbers::pi * k / corners;
            const auto rim = camera.project({centre[0] + 0.5 * diameter * std::cos(angle),
                centre[1] + 0.5 * diameter * std::sin(angle), centre[2]});
            const scene::Vec2 now{rim.x - middle.x, rim.y - middle.y};
            if (k > 0) {
                const double turn = last[0] * now[1] - last[1] * now[0];
                area += turn / 2;
                x += turn * (last[0] + now[0]) / 6;
                y += turn * (last[1] + now[1]) / 6;
            }
            last = now;
        }
        out.push_back(area != 0 ? scene::Vec2{x / area, y / area} : scene::Vec2{0, 0});
    }
    return out;
}

std::vector<scene::Vec2> unbiased_points(const scene::Lens& lens, const Board& board, const BoardView& view) {
    const auto centres = board_points(board);
    auto points = view.points;
    for (int round = 0; board.kind != BoardKind::chessboard && round < rounds; ++round) {
        const auto pose = pose_from_points(lens, centres, points);
        const auto bias = circle_bias(unchecked_camera(lens, pose), centres, view.diameter);
        for (std::size_t i = 0; i < points.size(); ++i)
            points[i] = {view.points[i][0] - bias[i][0], view.points[i][1] - bias[i][1]};
    }
    return points;
}

} // namespace treacle::video
