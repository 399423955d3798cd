#pragma once
#include "video/mask/contour.hpp"

#include <cmath>
#include <memory>

namespace treacle::video {

// Signed distance [px] from a point to the contour of a mask along its outward normal: positive where the contour is
// further out. Farther than `band` from any contour it goes on along the normal until the liquid ends, at the picture's
// rim at last; or, outside of it, until it begins, within four times the distance to the nearest pixel of the contour,
// which is taken where it does not. The nearest contour alone would give the thread's width at a drop's tip within a
// long thread. Without liquid in the mask, or without background, the picture's diagonal.
class ContourDistance {
public:
    explicit ContourDistance(const Mask& mask, double band = 6);
    ~ContourDistance();
    double operator()(const ContourPoint& point) const;
    // To the nearest pixel of the contour, in whole pixels; how it changes over a small time is smooth, where along a normal it may leap.
    double nearest(const ContourPoint& point) const;
    bool is_far(const ContourPoint& point) const { return std::abs(nearest(point)) > band_; }

private:
    double along_normal(const ContourPoint& point, double far) const;

    struct Fields;
    std::unique_ptr<Fields> fields_;
    double band_;
};

} // namespace treacle::video
