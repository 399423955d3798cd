#include "video/drawing/view.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/picture/vector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace treacle::video {

namespace {
constexpr int largest_side = 16384; // [pixels]
// The part of the picture that the domain may fill: at the right stands the colour bar, below the caption.
constexpr double left_end = 0.03, right_end = 0.88, top_end = 0.05, bottom_end = 0.91;
constexpr double automatic_angle = 0.55; // [rad]

bool is_finite(const Vec3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

void check(const View& view) {
    const auto refuse = [](const std::string& problem, const std::string& cure) {
        throw InputError({"camera", problem, "", cure});
    };
    if (view.width < 1 || view.height < 1 || view.width > largest_side || view.height > largest_side)
        refuse("picture of " + std::to_string(view.width) + " x " + std::to_string(view.height) + " pixels",
            "each side must be between 1 and " + std::to_string(largest_side) + " pixels");
    if (view.model) return;
    const double angle = view.vertical_field_of_view;
    if (!(angle > 0 && angle < std::numbers::pi))
        refuse("vertical field of view = " + format_number(angle) + " rad: must be between 0 and pi",
            "0.7 rad is a normal lens");
    if (!is_finite(view.position) || !is_finite(view.target) || !is_finite(view.up))
        refuse("position, target or up is not finite", "give numbers in metres");
    const Vec3 direction = view.target - view.position;
    if (!(length(direction) > 0)) refuse("position and target are the same point", "move one of them");
    if (!(length(cross(direction, view.up)) > 1e-9 * length(direction) * length(view.up)))
        refuse("up points along the viewing direction", "choose another up, such as [0, 1, 0]");
}

struct Bounds {
    double left = std::numeric_limits<double>::infinity(), top = left;
    double right = -left, bottom = -left;
    double nearest = left;
};

Vec3 corner(const DomainBox& box, int i) {
    return {(i & 1) ? box.max[0] : box.min[0], (i & 2) ? box.max[1] : box.min[1], (i & 4) ? box.max[2] : box.min[2]};
}

Bounds project_corners(const View& view, const DomainBox& box) {
    const Camera camera(view);
    Bounds bounds;
    for (int i = 0; i < 8; ++i) {
        const auto p = camera.project(corner(box, i));
        bounds.left = std::min(bounds.left, p.x);
        bounds.right = std::max(bounds.right, p.x);
        bounds.top = std::min(bounds.top, p.y);
        bounds.bottom = std::max(bounds.bottom, p.y);
        bounds.nearest = std::min(bounds.nearest, p.depth);
    }
    return bounds;
}

View plane_view(const DomainBox& box, View view) {
    const Vec3 extent = box.max - box.min;
    const double aspect = double(view.width) / view.height;
    const double height = std::max(extent[1] / (bottom_end - top_end), extent[0] / (right_end - left_end) / aspect);
    view.target = 0.5 * (box.min + box.max) +
                  height * Vec3{aspect * (0.5 - 0.5 * (left_end + right_end)), 0.5 * (top_end + bottom_end) - 0.5, 0};
    view.target[2] = 0;
    const double distance = 0.5 * height / std::tan(0.5 * view.vertical_field_of_view);
    view.position = view.target + Vec3{0, 0, distance};
    view.up = {0, 1, 0};
    view.projection = Projection::orthographic;
    return view;
}

View space_view(const DomainBox& box, View view) {
    const double diameter = length(box.max - box.min);
    const Vec3 towards_camera = normalised({0.46, -0.80, 0.40});
    view.target = 0.5 * (box.min + box.max);
    view.up = {0, 0, 1};
    double distance = 4 * diameter;
    // Perspective makes fitting and centring depend on each other; both settle within a few rounds.
    for (int round = 0; round < 30; ++round) {
        view.position = view.target + distance * towards_camera;
        const Bounds b = project_corners(view, box);
        const Camera camera(view);
        const double fill = std::max((b.right - b.left) / ((right_end - left_end) * view.width),
            (b.bottom - b.top) / ((bottom_end - top_end) * view.height));
        const Vec3 shift{0.5 * (b.left + b.right) - 0.5 * (left_end + right_end) * view.width,
            0.5 * (b.top + b.bottom) - 0.5 * (top_end + bottom_end) * view.height, 0};
        view.target = view.target + (distance / camera.scale()) * camera.direction_to_world(shift);
        distance = std::max(distance * fill, distance - b.nearest + 0.05 * diameter);
    }
    view.position = view.target + distance * towards_camera;
    return view;
}
} // namespace

View automatic_view(const DomainBox& box, int width, int height) {
    const Vec3 extent = box.max - box.min;
    for (int axis = 0; axis < box.dimensions; ++axis)
        if (!std::isfinite(extent[axis]) || !(extent[axis] > 0))
            throw InputError({"camera", "the domain has no extent along axis " + std::to_string(axis),
                "an automatic view shows the whole domain", "give domain.min < domain.max"});
    View view;
    view.width = width;
    view.height = height;
    view.vertical_field_of_view = automatic_angle;
    check(view);
    return box.dimensions == 2 ? plane_view(box, view) : space_view(box, view);
}

Camera::Camera(const View& view)
    : position_(view.position), width_(view.width), height_(view.height), projection_(view.projection) {
    check(view);
    if (view.model) {
        take(view.model->for_size(width_, height_));
        return;
    }
    const Vec3 direction = view.target - view.position;
    forward_ = normalised(direction);
    right_ = normalised(cross(forward_, view.up));
    down_ = cross(forward_, right_);
    scale_ = 0.5 * height_ / std::tan(0.5 * view.vertical_field_of_view);
    if (projection_ == Projection::orthographic) scale_ /= length(direction);
}

scene::CameraModel camera_model(const View& view, const std::string& name) {
    if (view.model) return view.model->for_size(view.width, view.height);
    const Camera seen(view);
    scene::Lens lens;
    lens.width = view.width;
    lens.height = view.height;
    lens.cx = (view.width - 1) / 2.0;
    lens.cy = (view.height - 1) / 2.0;
    scene::CameraPose pose;
    for (std::size_t k = 0; k < 3; ++k) {
        Vec3 axis{0, 0, 0};
        axis[k] = 1;
        const auto column = seen.direction_to_camera(axis);
        for (std::size_t row = 0; row < 3; ++row) pose.rotation[row][k] = column[row];
    }
    pose.translation = seen.to_camera({0, 0, 0});
    // On the plane z = 0 a pinhole at depth D with f = D times the pixels per metre draws what parallel rays draw.
    lens.fx = lens.fy = seen.scale() * (seen.is_perspective() ? 1 : pose.translation[2]);
    return {name, lens, pose};
}

LensRays::LensRays(const scene::CameraModel& camera) : model(camera) {
    const int width = model.lens().width, height = model.lens().height;
    x.reserve(std::size_t(width) * height);
    y.reserve(std::size_t(width) * height);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            const auto ray = model.ray({double(column), double(row)});
            x.push_back(float(ray[0]));
            y.push_back(float(ray[1]));
        }
}

void Camera::take(const scene::CameraModel& model) {
    const auto& rotation = model.pose().rotation;
    position_ = model.pose().position();
    right_ = rotation[0];
    down_ = rotation[1];
    forward_ = rotation[2];
    scale_ = 0.5 * (model.lens().fx + model.lens().fy);
    projection_ = Projection::perspective;
    lens_ = std::make_shared<const LensRays>(model);
}

Camera Camera::enlarged(int factor) const {
    Camera larger = *this;
    larger.width_ *= factor;
    larger.height_ *= factor;
    larger.scale_ *= factor;
    if (lens_) larger.take(lens_->model.for_size(larger.width_, larger.height_));
    return larger;
}

Vec3 Camera::direction_to_camera(const Vec3& d) const { return {dot(right_, d), dot(down_, d), dot(forward_, d)}; }

Vec3 Camera::direction_to_world(const Vec3& d) const { return d[0] * right_ + d[1] * down_ + d[2] * forward_; }

Vec3 Camera::to_camera(const Vec3& point) const { return direction_to_camera(point - position_); }

Vec3 Camera::to_world(const Vec3& point) const { return position_ + direction_to_world(point); }

ScreenPoint Camera::project(const Vec3& point) const { return project_camera(to_camera(point)); }

ScreenPoint Camera::project_camera(const Vec3& p) const {
    if (lens_) {
        const auto pixel = lens_->model.project_camera(p);
        return {pixel.x + scene::pixel_corner_offset, pixel.y + scene::pixel_corner_offset, p[2]};
    }
    const double s = is_perspective() ? scale_ / p[2] : scale_;
    return {0.5 * width_ + s * p[0], 0.5 * height_ + s * p[1], p[2]};
}

} // namespace treacle::video
