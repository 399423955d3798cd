#pragma once
#include "base/text/vec3.hpp"

#include <array>
#include <string>

namespace treacle::scene {

// Pinhole cameras with OpenCV's lens distortion.
//
// Camera axes: x right, y down, z forward. Pixels by OpenCV's convention: the centre of the top left pixel is (0, 0),
// so that a picture of w x h pixels covers [-0.5, w - 0.5] x [-0.5, h - 0.5]. COLMAP, OpenGL and src/video's rasteriser
// put (0, 0) into the corner of that pixel: add `pixel_corner_offset` to go there, subtract it to come back.
inline constexpr double pixel_corner_offset = 0.5; // [pixels]

using Matrix3 = std::array<Vec3, 3>; // rows
using Vec2 = std::array<double, 2>;  // [pixels], or (X/Z, Y/Z) without unit

// Intrinsic parameters. A point (x, y) = (X/Z, Y/Z) of camera axes is seen at pixel (cx + fx x', cy + fy y') with
//   x' = x c + 2 p1 x y + p2 (r^2 + 2 x^2),  y' = y c + p1 (r^2 + 2 y^2) + 2 p2 x y,  r^2 = x^2 + y^2,
//   c = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
// (OpenCV 4.6, calib3d; the first five: Brown 1966).
struct Lens {
    int width = 0, height = 0;             // [pixels] of the pictures for which the numbers hold
    double fx = 0, fy = 0, cx = 0, cy = 0; // [pixels]
    std::array<double, 8> distortion{};    // k1 k2 p1 p2 k3 k4 k5 k6

    bool is_distorted() const; // any coefficient is not 0
    bool operator==(const Lens&) const = default;
};

// The same lens for pictures resized to width x height. InputError when the shape (width over height) differs by more
// than the rounding of one pixel: such a picture was cropped or turned.
Lens resized(const Lens& lens, int width, int height);

// Extrinsic parameters: X_camera = R X_world + t.
struct CameraPose {
    Matrix3 rotation{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}; // R, world to camera
    Vec3 translation{0, 0, 0};                                     // t [m]

    Vec3 position() const; // of the camera in the world, -R^T t [m]
    bool operator==(const CameraPose&) const = default;
};

// Rotation by |v| radians about v (Rodrigues), and back; the vector has at most pi radians.
Matrix3 rotation_matrix(const Vec3& v);
Vec3 rotation_vector(const Matrix3& m);
Matrix3 product(const Matrix3& a, const Matrix3& b);
Matrix3 transposed(const Matrix3& m);
Vec3 apply(const Matrix3& m, const Vec3& v);
// The pose of the same camera in a world whose axes are those of this one moved by X_old = R X_new + t.
CameraPose in_moved_world(const CameraPose& pose, const Matrix3& rotation, const Vec3& translation);

// A point in a camera's picture.
struct PixelPoint {
    double x = 0, y = 0; // [pixels]
    double depth = 0;    // [m] along z of camera axes; below near_plane: not seen, x and y are meaningless
};

// Treatment of a distortion that folds the picture over within its corners: InputError, or max_radius() short of them.
enum class Folds { refuse, allow };

// A lens in a pose.
class CameraModel {
public:
    CameraModel() = default;
    // InputError for a lens without pixels or focal length, with values that are not finite, or whose distortion folds
    // the picture over within its own corners, unless `allow`; for a rotation that is none.
    CameraModel(std::string name, const Lens& lens, const CameraPose& pose, Folds folds = Folds::refuse);

    // Name for messages, lens for pictures of its own size, and pose [m].
    const std::string& name() const { return name_; }
    const Lens& lens() const { return lens_; }
    const CameraPose& pose() const { return pose_; }

    static constexpr double near_plane = 1e-4; // [m]

    // The same camera for pictures resized to width x height; InputError as resized().
    CameraModel for_size(int width, int height) const;

    Vec3 to_camera(const Vec3& world) const;             // [m]
    Vec3 to_world(const Vec3& camera) const;             // [m]
    PixelPoint project(const Vec3& world) const;         // of a point in the world [m]
    PixelPoint project_camera(const Vec3& camera) const; // of a point in camera axes [m]

    // Distortion of (x, y) = (X/Z, Y/Z), and its inverse by Newton's method to 1e-13. Beyond max_radius() the
    // distortion goes on along the radius with slope 1, so that both are one to one everywhere.
    Vec2 distort(const Vec2& ideal) const;
    Vec2 undistort(const Vec2& distorted) const;
    // The ray (X/Z, Y/Z) through a pixel.
    Vec2 ray(const Vec2& pixel) const;
    // Point [m] of the world at a depth [m] on the ray of a pixel.
    Vec3 unproject(const Vec2& pixel, double depth) const;

    // Radius |(X/Z, Y/Z)| up to which the distortion is one to one: its Jacobian's determinant has not fallen below 2 %
    // of that at the centre in any direction. 57 (89 degrees) for a lens that never folds.
    double max_radius() const { return max_radius_; }

private:
    std::string name_;
    Lens lens_;
    CameraPose pose_;
    double max_radius_ = 0;
};

} // namespace treacle::scene
