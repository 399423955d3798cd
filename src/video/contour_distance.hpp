#pragma once
#include "video/contour.hpp"

#include <memory>

namespace treacle::video {

// Signed distance [px] from a point to the contour of a mask along its outward normal: positive where the contour is
// further out. Beyond `band` it is the distance to the nearest pixel of the contour; without liquid in the mask, or without
// background, the picture's diagonal.
class ContourDistance {
public:
    explicit ContourDistance(const Mask& mask, double band = 6);
    ~ContourDistance();
    double operator()(const ContourPoint& point) const;

private:
    struct Fields;
    std::unique_ptr<Fields> fields_;
    double band_;
};

} // namespace treacle::video
