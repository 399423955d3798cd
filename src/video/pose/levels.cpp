#include "video/pose/levels.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "base/text/units.hpp"
#include "video/picture/vector.hpp"
#include "video/pose/pose_algebra.hpp"
#include "video/pose/solid_view.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>

namespace treacle::video {

namespace {

[[noreturn]] void refuse(
    const std::string& where, const std::string& problem, const std::string& reason, const std::string& cure) {
    throw InputError({where, problem, reason, cure});
}

PlanePixel read_line(const std::string& line, const std::string& where) {
    constexpr const char* cure = "write for instance 512.5, 300, x = 2 cm";
    std::istringstream stream(line);
    std::string u, v, plane;
    std::getline(stream, u, ',');
    std::getline(stream, v, ',');
    std::getline(stream, plane);
    const auto trimmed = [](std::string text) {
        text.erase(0, text.find_first_not_of(" \t\r"));
        text.erase(text.find_last_not_of(" \t\r") + 1);
        return text;
    };
    const auto x = read_number(trimmed(u)), y = read_number(trimmed(v));
    plane = trimmed(plane);
    const auto equals = plane.find('=');
    if (!x || !y || equals == std::string::npos) refuse(where, "is no pixel with its plane", "", cure);
    PlanePixel out;
    out.pixel = {*x, *y};
    const auto axis = trimmed(plane.substr(0, equals));
    if (axis != "x" && axis != "y" && axis != "z")
        refuse(where, axis + " is no axis", "planes stand across x, y or z", cure);
    out.axis = axis[0] - 'x';
    const auto read = read_quantity(trimmed(plane.substr(equals + 1)), unit::length);
    if (const auto* complaint = std::get_if<Complaint>(&read))
        refuse(where, complaint->must, complaint->reason, complaint->cure);
    out.offset = std::get<double>(read);
    out.where = where;
    return out;
}

// The point of the plane that is seen at the pixel.
Vec3 point_of(const scene::CameraModel& camera, const PlanePixel& pixel, const scene::Vec2& shift) {
    const auto ray = ray_of(camera, {pixel.pixel[0] + shift[0], pixel.pixel[1] + shift[1]});
    const auto k = std::size_t(pixel.axis);
    const double t = (pixel.offset - ray.origin[k]) / ray.direction[k];
    if (!(t > 0) || !std::isfinite(t) || std::abs(ray.direction[k]) < 0.02)
        refuse(pixel.where, "its ray does not meet the plane in front of the camera", "",
            "look for another plane or a wrong pose");
    return ray.origin + t * ray.direction;
}

struct Axes {
    Vec3 longest, shortest;
    double middle, least, largest; // variances
};

Axes axes_of(const std::vector<Vec3>& points) {
    cv::Mat rows(int(points.size()), 3, CV_64F), covariance, mean, values, vectors;
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) rows.at<double>(int(i), int(k)) = points[i][k];
    cv::calcCovarMatrix(rows, covariance, mean, cv::COVAR_NORMAL | cv::COVAR_ROWS | cv::COVAR_SCALE, CV_64F);
    cv::eigen(covariance, values, vectors);
    const auto row = [&](int i) {
        return Vec3{vectors.at<double>(i, 0), vectors.at<double>(i, 1), vectors.at<double>(i, 2)};
    };
    return {row(0), row(2), values.at<double>(1), std::max(values.at<double>(2), 0.0), values.at<double>(0)};
}

using Direction = std::function<Vec3(const std::vector<Vec3>&)>;

Vec3 towards(const Vec3& direction, const Vec3& about) {
    return dot(direction, about) < 0 ? -1.0 * direction : direction;
}

// Standard deviation by moving each pixel, and the pose along the axes of its covariance.
double deviation_of(const CameraRecord& record, const std::vector<PlanePixel>& pixels, const Direction& direction,
    const Vec3& up, double noise) {
    const auto camera = record.model();
    const auto all = [&](const scene::CameraModel& from) {
        std::vector<Vec3> out;
        out.reserve(pixels.size());
        for (const auto& pixel : pixels) out.push_back(point_of(from, pixel, {0, 0}));
        return out;
    };
    cv::Matx33d spread = cv::Matx33d::zeros();
    const auto add = [&](const std::vector<Vec3>& points, double scale) {
        const Vec3 d = scale * (towards(direction(points), up) - up);
        const cv::Vec3d v(d[0], d[1], d[2]);
        spread += v * v.t();
    };
    const auto points = all(camera);
    for (std::size_t i = 0; i < pixels.size(); ++i)
        for (const scene::Vec2& shift : {scene::Vec2{noise, 0}, scene::Vec2{0, noise}}) {
            auto moved = points;
            moved[i] = point_of(camera, pixels[i], shift);
            add(moved, 1);
        }
    if (record.pose_covariance) {
        cv::Mat values, vectors;
        cv::eigen(cv::Mat(matrix_of(*record.pose_covariance)), values, vectors);
        for (int k = 0; k < 6; ++k) {
            PoseVector change(vectors.ptr<double>(k));
            change *= std::sqrt(std::max(values.at<double>(k), 0.0));
            add(all({"", record.lens, changed(camera.pose(), change)}), 1);
        }
    }
    cv::Mat values;
    cv::eigen(cv::Mat(spread), values);
    return std::sqrt(std::max(values.at<double>(0), 0.0));
}

std::vector<Vec3> points_of(const CameraRecord& camera, const std::vector<PlanePixel>& pixels) {
    const auto model = camera.model();
    std::vector<Vec3> out;
    out.reserve(pixels.size());
    for (const auto& pixel : pixels) out.push_back(point_of(model, pixel, {0, 0}));
    return out;
}

} // namespace

std::vector<PlanePixel> read_levels(const std::filesystem::path& path) {
    std::ifstream file(path);
    if (!file) refuse(path.string(), "there is no such file", "", "write lines such as 512.5, 300, x = 2 cm");
    std::vector<PlanePixel> out;
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        const auto first = line.find_first_not_of(" \t\r");
        if (first == std::string::npos || line[first] == '#' || line[first] == 'u') continue;
        out.push_back(read_line(line, path.string() + ":" + std::to_string(number)));
    }
    return out;
}

Vertical vertical_of_level(
    const CameraRecord& camera, const std::vector<PlanePixel>& pixels, const Vec3& about, double noise) {
    if (pixels.size() < 3)
        refuse("--level", std::to_string(pixels.size()) + " points do not make a plane", "",
            "list three points or more of the line where the liquid meets the walls");
    const auto points = points_of(camera, pixels);
    const auto axes = axes_of(points);
    if (axes.middle < 0.0025 * axes.largest)
        refuse(pixels.front().where, "the points of the level lie on one line", "a plane can turn about it",
            "add points on another wall");
    const Direction direction = [](const std::vector<Vec3>& list) { return axes_of(list).shortest; };
    Vertical out;
    out.up = towards(axes.shortest, about);
    out.residual = std::sqrt(axes.least);
    out.deviation = deviation_of(camera, pixels, direction, out.up, noise);
    return out;
}

Vertical vertical_of_plumb(
    const CameraRecord& camera, const std::vector<PlanePixel>& pixels, const Vec3& about, double noise) {
    if (pixels.size() < 2)
        refuse("--plumb", std::to_string(pixels.size()) + " points do not make a line", "",
            "list two points or more of the plumb line");
    const auto axes = axes_of(points_of(camera, pixels));
    const Direction direction = [](const std::vector<Vec3>& list) { return axes_of(list).longest; };
    Vertical out;
    out.up = towards(axes.longest, about);
    out.residual = std::sqrt(axes.middle + axes.least);
    out.deviation = deviation_of(camera, pixels, direction, out.up, noise);
    return out;
}

} // namespace treacle::video
