#pragma once
#include "base/text/vec3.hpp"
#include "scene/camera/camera_model.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace treacle::video {

// Mapping from space to the picture for cameras that were not measured.
enum class Projection { perspective, orthographic };

// Pose of the camera, and what it shows.
struct View {
    Vec3 position{0, -1, 0};             // [m]
    Vec3 target{0, 0, 0};                // [m], seen at the centre of the picture
    Vec3 up{0, 0, 1};                    // not parallel to the direction of view; any length
    double vertical_field_of_view = 0.7; // [rad]; orthographic: height that this angle spans at the target
    int width = 1280, height = 720;      // [pixels]
    Projection projection = Projection::perspective;
    std::optional<scene::CameraModel> model = {}; // a measured camera in the place of all but the size
};

// The part of space that a scene fills. 2D scenes lie in x, y.
struct DomainBox {
    Vec3 min{0, 0, 0}, max{1, 1, 1}; // [m]
    int dimensions = 3;
};

// A view of the whole domain: in 3D from the front, right and slightly above, z up; in 2D straight
// onto it, y up. InputError for an empty or non-finite box and for a picture without pixels.
View automatic_view(const DomainBox& box, int width, int height);

// The view as a pinhole or a measured lens. An orthographic one becomes a pinhole that draws the same picture of the plane z = 0.
scene::CameraModel camera_model(const View& view, const std::string& name);

// A point in the picture of a camera.
struct ScreenPoint {
    double x = 0, y = 0; // [pixels] from the top left corner; a pixel's centre lies at +0.5
    double depth = 0;    // [m] along the viewing direction; not positive: behind the camera
};

// The rays of a measured camera through the centres of its pixels.
struct LensRays {
    explicit LensRays(const scene::CameraModel& camera);

    scene::CameraModel model; // the one that the rays are of
    std::vector<float> x, y;  // [height][width] X/Z and Y/Z in camera axes
};

// A view turned into numbers. Camera axes: x right, y down, z into the picture.
class Camera {
public:
    // InputError when the view has no direction, an `up` along it, a bad angle or a bad size.
    explicit Camera(const View& view);
    // The same view with `factor` times as many pixels on each side.
    Camera enlarged(int factor) const;

    Vec3 to_camera(const Vec3& point) const; // [m]
    // Vectors turned only, into camera axes and back.
    Vec3 direction_to_camera(const Vec3& d) const;
    Vec3 direction_to_world(const Vec3& d) const;
    Vec3 to_world(const Vec3& point) const;              // [m]
    ScreenPoint project(const Vec3& point) const;        // from a point in the scene's axes [m]
    ScreenPoint project_camera(const Vec3& point) const; // in camera axes

    int width() const { return width_; }                                           // [pixels]
    int height() const { return height_; }                                         // [pixels]
    bool is_perspective() const { return projection_ == Projection::perspective; } // true for measured cameras, too
    // Perspective: f [pixels], the mean of both directions. Orthographic: pixels per metre.
    double scale() const { return scale_; }
    // Rays of a measured camera; null: a pinhole with the centre in the middle.
    const LensRays* lens() const { return lens_.get(); }
    const Vec3& position() const { return position_; }
    const Vec3& forward() const { return forward_; }

private:
    void take(const scene::CameraModel& model);

    Vec3 position_, right_, down_, forward_;
    double scale_;
    int width_, height_;
    Projection projection_;
    std::shared_ptr<const LensRays> lens_;
};

} // namespace treacle::video
