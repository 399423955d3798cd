#include "identify/compare/comparison.hpp"

#include "video/mask/contour_distance.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

namespace {
// Depth [m] of the liquid at a pixel or beside it; negative where there is none.
double depth_near(const video::FilmDrawing& drawing, double x, double y) {
    const int column = int(std::lround(x)), row = int(std::lround(y));
    for (int radius = 0; radius <= 2; ++radius) {
        double nearest = -1;
        for (int r = std::max(0, row - radius); r <= std::min(drawing.mask.height - 1, row + radius); ++r) {
            for (int c = std::max(0, column - radius); c <= std::min(drawing.mask.width - 1, column + radius); ++c) {
                if (drawing.mask.liquid(c, r))
                    nearest = std::max(nearest,
                        double(drawing.depth[std::size_t(r) * std::size_t(drawing.mask.width) + std::size_t(c)]));
            }
        }
        if (nearest > 0) return nearest;
    }
    return -1;
}

// Adds the motion of the pixel of a point in camera axes by the camera's parameters, along a normal.
void add_camera(const scene::CameraModel& camera, const Vec3& position, const scene::Vec2& normal, double weight,
    ViewDerivatives& out) {
    const auto pixel = camera.project_camera(position);
    const auto& lens = camera.lens();
    out[view_focal] += weight * (normal[0] * (pixel.x - lens.cx) + normal[1] * (pixel.y - lens.cy));
    const double step = 1e-4 * position[2]; // [m]
    std::array<double, 3> along{};          // by a move of the point along each axis [px/m]
    for (std::size_t k = 0; k < 3; ++k) {
        auto ahead = position, behind = position;
        ahead[k] += step;
        behind[k] -= step;
        const auto a = camera.project_camera(ahead), b = camera.project_camera(behind);
        along[k] = (normal[0] * (a.x - b.x) + normal[1] * (a.y - b.y)) / (2 * step);
        out[view_position + int(k)] += weight * along[k];
    }
    // A turn w of the camera's axes moves the point by w x (X - t).
    const auto& t = camera.pose().translation;
    const Vec3 arm{position[0] - t[0], position[1] - t[1], position[2] - t[2]};
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        out[view_turn + int(k)] += weight * (along[j] * arm[i] - along[i] * arm[j]);
    }
}

// Segments of the observed contour do not depend on how far liquid goes on beyond them: within a long thread a drop's
// tip is half of the thread's width from its contour, however long the thread is. Near parts are left to the segments,
// which have derivatives by the view.
double beyond_observed(const video::Mask& observed, const video::Mask& simulated) {
    constexpr double near = 10; // [px]
    auto seen = simulated;
    for (std::size_t i = 0; i < seen.pixels.size(); ++i) {
        if (observed.pixels[i] == video::mask_excluded) seen.pixels[i] = video::mask_excluded;
    }
    const video::ContourDistance distance(observed);
    double sum = 0;
    for (const auto& segment : contour_segments(seen)) {
        for (const auto& point : segment.points) sum += std::max(0.0, std::abs(distance(point)) - near);
    }
    return sum / segment_length;
}
} // namespace

FrameComparison compare_frame(const ObservedFrame& observed, const video::Mask& mask, const SimulatedFrame& simulated,
    const scene::CameraModel& camera) {
    FrameComparison out;
    for (std::size_t i = 0; i < mask.pixels.size(); ++i) {
        if (mask.pixels[i] == video::mask_excluded) continue;
        const bool a = mask.pixels[i] == video::mask_liquid, b = simulated.now.mask.pixels[i] == video::mask_liquid;
        ++out.compared;
        out.observed += a;
        out.simulated += b;
        out.mismatches += a != b;
    }
    const video::ContourDistance now(simulated.now.mask), later(simulated.later.mask);
    for (const auto& segment : contour_segments(mask)) {
        SegmentResidual residual;
        residual.frame = observed.number;
        residual.time = observed.time;
        residual.points = double(segment.points.size());
        const double weight = 1 / residual.points;
        for (const auto& point : segment.points) {
            residual.x += weight * point.pixel[0];
            residual.y += weight * point.pixel[1];
            residual.normal_x += weight * point.normal[0];
            residual.normal_y += weight * point.normal[1];
            const double d = now(point),
                         change = now.is_far(point) ? later.nearest(point) - now.nearest(point) : later(point) - d;
            const double speed = change / simulated.step;
            residual.displacement += weight * d;
            // A later time zero shows the run earlier. A longer readout shows rows above the middle earlier, those below later.
            residual.by_view[view_time] -= weight * speed;
            residual.by_view[view_readout] += weight * speed * (point.pixel[1] / (mask.height - 1) - 0.5);
            residual.by_view[view_contour] += weight;
            const scene::Vec2 inside{
                point.pixel[0] + (d - 1) * point.normal[0], point.pixel[1] + (d - 1) * point.normal[1]};
            const double depth = depth_near(simulated.now, inside[0], inside[1]);
            if (depth <= 0) continue;
            const auto ray = camera.ray(inside);
            add_camera(camera, {ray[0] * depth, ray[1] * depth, depth}, point.normal, weight, residual.by_view);
        }
        out.segments.push_back(residual);
    }
    out.beyond = beyond_observed(mask, simulated.now.mask);
    return out;
}

double mismatch_objective(const FrameComparison& comparison) {
    return comparison.compared > 0 ? 0.5 * double(comparison.mismatches) / double(comparison.compared) : 0;
}

} // namespace treacle::identify
