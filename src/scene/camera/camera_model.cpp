#include "scene/camera/camera_model.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace treacle::scene {

namespace {

constexpr double widest_angle = 89 * std::numbers::pi / 180; // [rad] between a ray and the axis
constexpr double least_determinant = 0.02;
constexpr int radii = 400, directions = 24; // of the search for folds
constexpr int largest_side = 65535;         // [pixels]

// Distorted point and Jacobian.
struct Distorted {
    Vec2 point;
    std::array<Vec2, 2> jacobian; // rows d(x')/d(x, y), d(y')/d(x, y)
    bool sound;                   // neither factor of the rational term is negative

    double determinant() const { return jacobian[0][0] * jacobian[1][1] - jacobian[0][1] * jacobian[1][0]; }
};

// The formulas of Lens.
Distorted distort_within(const std::array<double, 8>& d, const Vec2& p) {
    const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = d;
    const double x = p[0], y = p[1], rr = x * x + y * y;
    const double above = 1 + rr * (k1 + rr * (k2 + rr * k3)), below = 1 + rr * (k4 + rr * (k5 + rr * k6));
    const double c = above / below;
    const double above_slope = k1 + rr * (2 * k2 + rr * 3 * k3), below_slope = k4 + rr * (2 * k5 + rr * 3 * k6);
    const double slope = (above_slope - c * below_slope) / below; // dc/d(r^2)
    const double mixed = 2 * x * y * slope + 2 * p1 * x + 2 * p2 * y;
    return {{x * c + 2 * p1 * x * y + p2 * (rr + 2 * x * x), y * c + p1 * (rr + 2 * y * y) + 2 * p2 * x * y},
        {Vec2{c + 2 * x * x * slope + 2 * p1 * y + 6 * p2 * x, mixed},
            Vec2{mixed, c + 2 * y * y * slope + 6 * p1 * y + 2 * p2 * x}},
        above > 0 && below > 0};
}

bool is_one_to_one(const std::array<double, 8>& d, double radius) {
    for (int k = 0; k < directions; ++k) {
        const double angle = 2 * std::numbers::pi * k / directions;
        const auto at = distort_within(d, {radius * std::cos(angle), radius * std::sin(angle)});
        const double trace = at.jacobian[0][0] + at.jacobian[1][1];
        if (!at.sound || !(at.determinant() >= least_determinant) || !(trace > 0)) return false;
    }
    return true;
}

double find_max_radius(const Lens& lens) {
    if (!lens.is_distorted()) return std::tan(widest_angle);
    double good = 0;
    for (int i = 1; i <= radii; ++i) {
        const double radius = std::tan(widest_angle * i / radii);
        if (is_one_to_one(lens.distortion, radius)) {
            good = radius;
            continue;
        }
        double bad = radius;
        for (int round = 0; round < 40; ++round) {
            const double middle = 0.5 * (good + bad);
            (is_one_to_one(lens.distortion, middle) ? good : bad) = middle;
        }
        break;
    }
    return good;
}

double radius_of(const Vec2& p) { return std::hypot(p[0], p[1]); }

[[noreturn]] void refuse(
    const std::string& name, const std::string& problem, const std::string& reason, const std::string& cure) {
    throw InputError({name, problem, reason, cure});
}

void check_lens(const std::string& name, const Lens& lens) {
    if (lens.width < 1 || lens.height < 1 || lens.width > largest_side || lens.height > largest_side)
        refuse(name, "pictures of " + std::to_string(lens.width) + " x " + std::to_string(lens.height) + " pixels",
            "the focal length and the centre hold for one size of picture only", "give image_width and image_height");
    const auto finite = [](double v) { return std::isfinite(v); };
    if (!std::ranges::all_of(lens.distortion, finite) || !finite(lens.fx) || !finite(lens.fy) || !finite(lens.cx) ||
        !finite(lens.cy))
        refuse(name, "the camera matrix or the distortion is not finite", "", "calibrate the camera anew");
    if (!(lens.fx > 0 && lens.fy > 0))
        refuse(name,
            "focal lengths " + format_number(lens.fx) + " and " + format_number(lens.fy) + " pixels: must be > 0", "",
            "give camera_matrix with fx and fy on its diagonal");
}

void check_pose(const std::string& name, const CameraPose& pose) {
    const Matrix3 square = product(pose.rotation, transposed(pose.rotation));
    double error = 0;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) error = std::max(error, std::abs(square[i][j] - (i == j ? 1.0 : 0.0)));
    const double volume = dot(pose.rotation[0], cross(pose.rotation[1], pose.rotation[2]));
    if (!(error < 1e-4) || !(volume > 0) || !is_finite(pose.translation))
        refuse(name, "the pose is not a rotation and a translation",
            "its matrix does not keep lengths or mirrors space",
            "give R with orthonormal rows and determinant 1, or a rotation vector");
}

// Three steps to the closest rotation (Higham 1986: R <- (R + R^-T) / 2).
Matrix3 orthonormal(Matrix3 r) {
    for (int round = 0; round < 3; ++round) {
        const Matrix3 cofactors{cross(r[1], r[2]), cross(r[2], r[0]), cross(r[0], r[1])};
        const double volume = dot(r[0], cofactors[0]);
        for (std::size_t i = 0; i < 3; ++i) r[i] = 0.5 * (r[i] + (1 / volume) * cofactors[i]);
    }
    return r;
}

} // namespace

bool Lens::is_distorted() const {
    return std::ranges::any_of(distortion, [](double k) { return k != 0; });
}

namespace {

[[noreturn]] void refuse_size(const Lens& lens, int width, int height) {
    const bool turned = std::abs(lens.width * double(width) / lens.height - height) <= 1;
    refuse("",
        "the camera was calibrated for pictures of " + std::to_string(lens.width) + " x " +
            std::to_string(lens.height) + " pixels, these have " + std::to_string(width) + " x " +
            std::to_string(height),
        turned ? "they are turned by a quarter" : "they are cropped or squeezed",
        turned ? "turn the pictures as those of the calibration were"
               : "film board and experiment in the same mode of the camera");
}

} // namespace

Lens resized(const Lens& lens, int width, int height) {
    const double x = double(width) / lens.width, y = double(height) / lens.height;
    if (std::abs(lens.height * x - height) > 1 && std::abs(lens.width * y - width) > 1)
        refuse_size(lens, width, height);
    Lens out = lens;
    out.width = width;
    out.height = height;
    out.fx *= x;
    out.fy *= y;
    out.cx = (lens.cx + pixel_corner_offset) * x - pixel_corner_offset;
    out.cy = (lens.cy + pixel_corner_offset) * y - pixel_corner_offset;
    return out;
}

Matrix3 transposed(const Matrix3& m) {
    return {Vec3{m[0][0], m[1][0], m[2][0]}, Vec3{m[0][1], m[1][1], m[2][1]}, Vec3{m[0][2], m[1][2], m[2][2]}};
}

Vec3 apply(const Matrix3& m, const Vec3& v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }

Matrix3 product(const Matrix3& a, const Matrix3& b) {
    const Matrix3 columns = transposed(b);
    Matrix3 out;
    for (std::size_t i = 0; i < 3; ++i) out[i] = {dot(a[i], columns[0]), dot(a[i], columns[1]), dot(a[i], columns[2])};
    return out;
}

Matrix3 rotation_matrix(const Vec3& v) {
    const double angle = length(v);
    const Vec3 axis = unit(v);
    Matrix3 columns;
    for (std::size_t i = 0; i < 3; ++i) {
        Vec3 e{0, 0, 0};
        e[i] = 1;
        columns[i] = rotated(e, axis, angle);
    }
    return transposed(columns);
}

Vec3 rotation_vector(const Matrix3& m) {
    // sin(angle) times the axis, and the angle without loss near 0 and pi.
    const Vec3 s = 0.5 * Vec3{m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]};
    const double sine = length(s), cosine = 0.5 * (m[0][0] + m[1][1] + m[2][2] - 1);
    const double angle = std::atan2(sine, cosine);
    if (sine > 1e-6) return (angle / sine) * s;
    if (cosine > 0) return s;
    // About pi: the axis is the longest row of (R + R^T)/2 + 1, signed as s.
    Vec3 axis{0, 0, 0};
    for (std::size_t i = 0; i < 3; ++i) {
        Vec3 row = 0.5 * (m[i] + transposed(m)[i]);
        row[i] += 1;
        if (length(row) > length(axis)) axis = row;
    }
    axis = unit(axis);
    return (dot(axis, s) < 0 ? -angle : angle) * axis;
}

Vec3 CameraPose::position() const { return -scene::apply(transposed(rotation), translation); }

CameraPose in_moved_world(const CameraPose& pose, const Matrix3& rotation, const Vec3& translation) {
    return {product(pose.rotation, rotation), scene::apply(pose.rotation, translation) + pose.translation};
}

CameraModel::CameraModel(std::string name, const Lens& lens, const CameraPose& pose, Folds folds)
    : name_(std::move(name)), lens_(lens), pose_(pose) {
    check_lens(name_, lens_);
    check_pose(name_, pose_);
    pose_.rotation = orthonormal(pose_.rotation);
    max_radius_ = find_max_radius(lens_);
    if (folds == Folds::allow) return;
    for (const double x : {-0.5, lens_.width - 0.5}) {
        for (const double y : {-0.5, lens_.height - 0.5}) {
            const double r = max_radius_ > 0 ? radius_of(ray({x, y})) : 1;
            if (r <= max_radius_) continue;
            refuse(name_, "the distortion folds the picture over near its corners",
                "beyond " + format_number(std::round(std::atan(max_radius_) * 1800 / std::numbers::pi) / 10) +
                    " degrees from the axis two rays meet the same pixel",
                "calibrate with the board near the corners too, or with fewer coefficients");
        }
    }
}

CameraModel CameraModel::for_size(int width, int height) const { return {name_, resized(lens_, width, height), pose_}; }

Vec3 CameraModel::to_camera(const Vec3& world) const { return scene::apply(pose_.rotation, world) + pose_.translation; }

Vec3 CameraModel::to_world(const Vec3& camera) const {
    return scene::apply(transposed(pose_.rotation), camera - pose_.translation);
}

PixelPoint CameraModel::project(const Vec3& world) const { return project_camera(to_camera(world)); }

PixelPoint CameraModel::project_camera(const Vec3& camera) const {
    if (!(camera[2] >= near_plane)) return {0, 0, camera[2]};
    const Vec2 p = distort({camera[0] / camera[2], camera[1] / camera[2]});
    return {lens_.cx + lens_.fx * p[0], lens_.cy + lens_.fy * p[1], camera[2]};
}

Vec2 CameraModel::distort(const Vec2& ideal) const {
    const double r = radius_of(ideal);
    if (r <= max_radius_) return distort_within(lens_.distortion, ideal).point;
    const Vec2 direction{ideal[0] / r, ideal[1] / r};
    const Vec2 rim = distort_within(lens_.distortion, {max_radius_ * direction[0], max_radius_ * direction[1]}).point;
    return {rim[0] + (r - max_radius_) * direction[0], rim[1] + (r - max_radius_) * direction[1]};
}

Vec2 CameraModel::undistort(const Vec2& distorted) const {
    if (!lens_.is_distorted()) return distorted;
    const auto residual = [&](const Vec2& p) {
        const Vec2 q = distort(p);
        return Vec2{distorted[0] - q[0], distorted[1] - q[1]};
    };
    Vec2 p = distorted, gap = residual(p);
    for (int round = 0; round < 60 && radius_of(gap) > 1e-13; ++round) {
        const double r = radius_of(p);
        const double inside = r > max_radius_ ? max_radius_ / r : 1;
        const auto at = distort_within(lens_.distortion, {inside * p[0], inside * p[1]});
        const double determinant = at.determinant();
        const auto& j = at.jacobian;
        const Vec2 step{
            (j[1][1] * gap[0] - j[0][1] * gap[1]) / determinant, (j[0][0] * gap[1] - j[1][0] * gap[0]) / determinant};
        // Halved until the residual falls.
        double length = 1;
        Vec2 next, next_gap;
        do {
            next = {p[0] + length * step[0], p[1] + length * step[1]};
            next_gap = residual(next);
            length /= 2;
        } while (radius_of(next_gap) >= radius_of(gap) && length > 1e-6);
        if (radius_of(next_gap) >= radius_of(gap)) break; // round-off
        p = next;
        gap = next_gap;
    }
    return p;
}

Vec2 CameraModel::ray(const Vec2& pixel) const {
    return undistort({(pixel[0] - lens_.cx) / lens_.fx, (pixel[1] - lens_.cy) / lens_.fy});
}

Vec3 CameraModel::unproject(const Vec2& pixel, double depth) const {
    const Vec2 direction = ray(pixel);
    return to_world({depth * direction[0], depth * direction[1], depth});
}

} // namespace treacle::scene
