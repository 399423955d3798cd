#include "base/options/options.hpp"
#include "base/text/error.hpp"
#include "scene/names.hpp"
#include "scene/scene.hpp"

#include <numbers>

namespace treacle::scene {

namespace {

constexpr double degree = std::numbers::pi / 180;

// Check of a camera from a file or with a lens, which define all of these keys.
void check_alone(Declaration& d, const std::string& given) {
    for (const auto* key : {"automatic", "position", "target", "up", "field_of_view"}) {
        d.check(
            !d.given(key), key, {"cannot go with " + given, "the pose and the lens stand there", "remove one of them"});
    }
}

} // namespace

void MeasuredCamera::declare(Declaration& d) {
    const auto pixels = [&](const std::string& key, double& value, const std::string& doc) {
        d.number(key, value, unit::none, range_any(), doc);
        d.required(key);
    };
    pixels("fx", lens.fx, "Focal length along a row [pixels].");
    pixels("fy", lens.fy, "Focal length along a column [pixels].");
    pixels("cx", lens.cx, "Principal point, from the centre of the first column [pixels].");
    pixels("cy", lens.cy, "Principal point, from the centre of the first row [pixels].");
    constexpr const char* names[] = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
    for (std::size_t i = 0; i < lens.distortion.size(); ++i) {
        const bool tangential = i == 2 || i == 3;
        d.number(names[i], lens.distortion[i], unit::none, range_any(),
            tangential ? "Tangential distortion, as OpenCV has it." : "Radial distortion, as OpenCV has it.");
    }
    d.vec3("rotation", rotation, unit::angle,
        "Rotation vector from the scene's axes to the camera's: x right, y down, z forward.", VectorKind::in_space);
    d.vec3("translation", translation, unit::length, "The scene's origin in the camera's axes.", VectorKind::in_space);
    d.required("translation");
}

void Camera::declare(Declaration& d) {
    declare_name(d, name, "Part of the pictures' names.");
    if (d.parsing()) {
        automatic = !d.given("position") && !d.given("file") && !d.given("lens");
        size_given = d.given("width") || d.given("height");
        where = d.location_of("file");
    }
    d.text("file", file,
        "A camera file of `treacle calibrate`, OpenCV, ViRheometry or COLMAP, relative to the scene: pictures are "
        "drawn through its lens.");
    d.text("camera", file_camera, "The camera in that file, where it holds several.");
    const bool measured_here = d.optional_block(
        "lens", measured.has_value(),
        [this](Declaration& block) {
            if (!measured) measured.emplace();
            measured->declare(block);
        },
        "A measured lens and its pose, in the place of a file.");
    if (!measured_here) measured.reset();
    d.boolean(
        "automatic", automatic, "Placed to see the whole domain; by default when no position, file or lens is given.");
    d.vec3("position", position, unit::length, "Where the camera is.", VectorKind::in_space);
    d.vec3("target", target, unit::length, "The point in the middle of the picture.", VectorKind::in_space);
    d.direction("up", up, "Direction that is upwards in the picture.");
    d.number("field_of_view", field_of_view, unit::angle, range_between(0.1 * degree, 170 * degree),
        "Vertical angle of view.");
    d.integer("width", width, range_between(16, 16384), "Pixels.");
    d.integer("height", height, range_between(16, 16384), "Pixels.");
    if (!file.empty()) check_alone(d, "file");
    d.check(file.empty() || !measured, "lens", {"cannot go with file", "the lens stands there", "remove one of them"});
    d.check(!file.empty() || file_camera.empty(), "camera",
        {"has no effect", "it is the name of one in a file", "give the file as well"});
    const bool looks_at = !automatic && file.empty() && !measured;
    d.check(!looks_at || position != target, "position",
        {"must differ from target", "the camera would look nowhere", "move it away"});
    d.check(!automatic || position == Vec3{0, 0, 0}, "position",
        {"has no effect", "automatic is true", "remove one of them"});
    d.check(!automatic || target == Vec3{0, 0, 0}, "target",
        {"has no effect", "the camera is placed automatically", "give a position as well"});
    if (d.parsing() && measured) {
        measured->lens.width = width;
        measured->lens.height = height;
    }
}

CameraModel Camera::model() const {
    if (!measured) throw InputError({name, "the camera has no measured lens", "", "give its file"});
    return {name, measured->lens, {rotation_matrix(measured->rotation), measured->translation}};
}

} // namespace treacle::scene
