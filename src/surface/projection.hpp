#pragma once
#include "surface/silhouette.hpp"

namespace treacle::surface {

// A point in camera axes [m] and where it is seen [pixels].
struct Seen {
    Vec3 camera{0, 0, 0};
    double x = 0, y = 0;
};

// Vertices as the camera sees them when it takes their row.
class Projection {
public:
    Projection(const scene::CameraModel& camera, const Exposure& exposure) : camera_(camera), exposure_(exposure) {}

    // `velocity` null: at rest. A point before the near plane has no pixel.
    Seen see(const double* position, const double* velocity) const;
    Seen at(const Vec3& in_camera) const;
    // The middle of an edge, the same number whichever end comes first.
    Seen middle(const Seen& a, const Seen& b) const;
    bool in_front(const Seen& a) const { return a.camera[2] >= near; }
    // Whether the edge's image is farther than `straightness` pixels from a straight line.
    bool bent(const Seen& a, const Seen& b, double straightness) const;

    static constexpr double near = 1e-3; // [m]

private:
    const scene::CameraModel& camera_;
    Exposure exposure_;
};

} // namespace treacle::surface
