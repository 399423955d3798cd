#pragma once
#include "video/picture/image.hpp"

#include <cstddef>
#include <vector>

namespace treacle::video {

// Motion of a frame against the reference: the point p of the reference is seen at
// q = c + R(angle) (p - c) + shift, with c the picture's centre.
struct FrameShift {
    double x = 0, y = 0;                         // [px]
    double angle = 0;                            // [rad]
    double gain = 1;                             // brightness of the frame over that of the reference
    double changed = 0;                          // share of the background's points that fit neither
    bool known = false;                          // false where the background has no texture to go by
    double largest(int width, int height) const; // displacement of a pixel [px]
};

// Finds frames' shifts by Gauss-Newton on the background's points of steepest grey levels, with Tukey's biweight
// against what covers them (inverse compositional: Baker & Matthews, IJCV 56, 2004; gain as in Bartoli, PAMI 30, 2008).
class Registration {
public:
    Registration() = default;
    // `usable` [height][width]: pixels of the background, not 0; empty for all.
    Registration(const Image& reference, const std::vector<unsigned char>& usable);

    // Shift of a frame of the reference's size; start: first iterate, best the shift of the frame before. `known` is
    // false without texture or with a singular system.
    FrameShift find(const Image& frame, const FrameShift& start) const;
    // True when there is texture to go by.
    bool possible() const { return possible_; }

private:
    struct Point {
        float x, y, level, gx, gy, gt;
    };
    std::vector<Point> points_;
    int width_ = 0, height_ = 0;
    bool possible_ = false;
};

// The frame moved onto the reference by cubic interpolation; the frame itself for less than 0.02 px.
Image undo_shift(const Image& frame, const FrameShift& shift);

} // namespace treacle::video
