#pragma once
#include "scene/camera/camera_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace treacle::scene {

// When a picture is taken, from the time of the points that are seen: they move on by their velocities.
struct Exposure {
    double shift = 0;    // [s] of the picture's middle row
    double row_time = 0; // [s] from one row to the next below it (rolling shutter)
};

// A point in camera axes [m] and where it is seen [pixels].
struct Seen {
    Vec3 camera{0, 0, 0}; // [m]
    double x = 0, y = 0;  // [pixels]; 0 before the near plane
};

// Points in the camera's picture at the time of their row.
class Projection {
public:
    Projection(const CameraModel& camera, const Exposure& exposure) : camera_(camera), exposure_(exposure) {}

    // `velocity` null: at rest. A point before the near plane has no pixel.
    Seen see(const double* position, const double* velocity) const;
    Seen at(const Vec3& in_camera) const;
    // The middle of an edge, the same number whichever end comes first.
    Seen middle(const Seen& a, const Seen& b) const;
    // True when the edge's image is farther than `straightness` pixels from a straight line.
    bool bent(const Seen& a, const Seen& b, double straightness) const;
    const CameraModel& camera() const { return camera_; }

    static constexpr double near = 1e-3; // [m]

private:
    const CameraModel& camera_;
    Exposure exposure_;
};

// The points x of camera axes with normal . x <= offset.
struct HalfSpace {
    Vec3 normal{0, 0, 0}; // unit
    double offset = 0;    // [m]
};

// A sample of the picture that a triangle covers.
struct RasterSample {
    std::int64_t column, row; // of samples
    double depth;             // [m] along the camera's axis
    Vec3 barycentric;         // of the triangle's corners in the point that is seen there; their sum is 1
    bool front;               // seen from the side on which the corners go counter-clockwise
};

// Draws triangles on samples x samples points of each pixel. A triangle covers a sample that lies in its image, on an
// edge only when that is a top or left one: corners are rounded to 1/256 pixel and edges are functions of whole
// numbers, so that triangles that share an edge cover each sample beside it once. For an odd number of samples the
// middle one is the pixel's centre, with the same result as that of one sample. Triangles are cut at the near plane and
// at given planes, and split until the images of their edges are straight.
class TriangleRaster {
public:
    // `straightness` [pixels]. The projection must stay.
    TriangleRaster(const Projection& projection, int samples = 1, double straightness = 0.05);
    // Leaves out what is not in the half-space.
    void keep(const HalfSpace& part) { parts_.push_back(part); }

    int width() const { return width_; }   // samples
    int height() const { return height_; } // samples

    // visit(const RasterSample&) for each sample, row by row.
    template <class Visit>
    void draw(const Seen& a, const Seen& b, const Seen& c, const Visit& visit) {
        const Piece whole{{{a, {1, 0, 0}}, {b, {0, 1, 0}}, {c, {0, 0, 1}}}};
        if (is_simple(whole)) return fill(whole, visit);
        pieces_.clear();
        cut(whole);
        for (const auto& piece : pieces_) fill(piece, visit);
    }

private:
    struct Corner {
        Seen seen;
        Vec3 barycentric;
    };
    struct Piece {
        Corner corner[3];
    };
    static constexpr std::int64_t unit = 256; // of a pixel: corners are rounded to them

    bool is_simple(const Piece& piece) const;
    void cut(const Piece& piece);
    void split(const Piece& piece, int level);
    Corner middle(const Corner& a, const Corner& b) const;

    static std::int64_t cross(
        std::int64_t ax, std::int64_t ay, std::int64_t bx, std::int64_t by, std::int64_t px, std::int64_t py) {
        return (bx - ax) * (py - ay) - (by - ay) * (px - ax);
    }
    static std::int64_t divide_down(std::int64_t v, std::int64_t by) { return v >= 0 ? v / by : -((-v + by - 1) / by); }

    // Coordinates in 1 / (256 samples) of a pixel; the middle of the sample s is at 256 s + 128 (1 - samples).
    template <class Visit>
    void fill(const Piece& piece, const Visit& visit) const {
        const std::int64_t first = unit / 2 * (1 - samples_);
        const Corner* corner[3] = {&piece.corner[0], &piece.corner[1], &piece.corner[2]};
        std::int64_t x[3], y[3];
        for (int k = 0; k < 3; ++k) {
            x[k] = samples_ * std::llround(corner[k]->seen.x * double(unit));
            y[k] = samples_ * std::llround(corner[k]->seen.y * double(unit));
        }
        std::int64_t area = cross(x[0], y[0], x[1], y[1], x[2], y[2]);
        if (area == 0) return;
        const bool front = area < 0; // rows go down
        if (area < 0) {
            std::swap(x[1], x[2]);
            std::swap(y[1], y[2]);
            std::swap(corner[1], corner[2]);
            area = -area;
        }
        const auto up = [&](std::int64_t v) { return -divide_down(first - v, unit); };
        const auto down = [&](std::int64_t v) { return divide_down(v - first, unit); };
        const auto left = std::max<std::int64_t>(0, up(std::min({x[0], x[1], x[2]})));
        const auto right = std::min<std::int64_t>(width_ - 1, down(std::max({x[0], x[1], x[2]})));
        const auto top = std::max<std::int64_t>(0, up(std::min({y[0], y[1], y[2]})));
        const auto bottom = std::min<std::int64_t>(height_ - 1, down(std::max({y[0], y[1], y[2]})));
        double inverse[3];
        std::int64_t step[3], least[3];
        for (int k = 0; k < 3; ++k) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            inverse[k] = 1 / corner[k]->seen.camera[2];
            step[k] = -(y[j] - y[i]) * unit;
            // Rows go down: the inside is on the right of an edge. Left edges go up, top edges to the right.
            least[k] = y[j] < y[i] || (y[j] == y[i] && x[j] > x[i]) ? 0 : 1;
        }
        for (auto row = top; row <= bottom; ++row) {
            std::int64_t w[3];
            for (int k = 0; k < 3; ++k) {
                const int i = (k + 1) % 3, j = (k + 2) % 3;
                w[k] = cross(x[i], y[i], x[j], y[j], left * unit + first, row * unit + first);
            }
            for (auto column = left; column <= right; ++column) {
                if (w[0] >= least[0] && w[1] >= least[1] && w[2] >= least[2]) {
                    const double weight[3] = {
                        double(w[0]) * inverse[0], double(w[1]) * inverse[1], double(w[2]) * inverse[2]};
                    const double sum = (weight[0] + weight[1] + weight[2]) / double(area);
                    RasterSample sample{column, row, 1 / sum, {0, 0, 0}, front};
                    for (int k = 0; k < 3; ++k) {
                        for (std::size_t c = 0; c < 3; ++c)
                            sample.barycentric[c] += weight[k] / (double(area) * sum) * corner[k]->barycentric[c];
                    }
                    visit(sample);
                }
                for (int k = 0; k < 3; ++k) w[k] += step[k];
            }
        }
    }

    const Projection& projection_;
    int samples_, width_, height_;
    double straightness_;
    std::vector<HalfSpace> parts_;
    std::vector<Piece> pieces_;
};

} // namespace treacle::scene
