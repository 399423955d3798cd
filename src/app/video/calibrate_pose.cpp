#include "app/video/calibrate_pose.hpp"

#include "app/input/option_values.hpp"
#include "app/render/picture.hpp"
#include "app/render/seen_solids.hpp"
#include "base/text/text.hpp"
#include "video/camera/board.hpp"
#include "video/camera/circle_bias.hpp"
#include "video/clip/movie.hpp"
#include "video/pose/contour_pose.hpp"
#include "video/pose/levels.hpp"
#include "video/pose/scene_overlay.hpp"

#include <cmath>
#include <numbers>

namespace treacle::app {

namespace {

namespace fs = std::filesystem;
constexpr double degree = std::numbers::pi / 180;
constexpr double level_noise = 1; // [pixels] of points of a level or a plumb line

std::string vector_text(const Vec3& v, int decimals) {
    return format_fixed(v[0], decimals) + ", " + format_fixed(v[1], decimals) + ", " + format_fixed(v[2], decimals);
}

struct LoadedScene {
    Input input;
    Geometry geometry;
};

LoadedScene load(const CalibrateRequest& request, const std::string& option) {
    if (request.scene.empty())
        throw InputError(
            {option, "needs the scene", "its solids and liquids are looked for in the picture", "add --scene SCENE"});
    LoadedScene out;
    fs::path path = request.scene;
    if (fs::is_directory(path)) path /= "scene.yaml";
    out.input = load_scene({path, request.overrides, {request.data.begin(), request.data.end()}, {}, {}});
    out.geometry = build_geometry(out.input);
    return out;
}

// Positions of the points of the board in the scene.
std::vector<Vec3> board_positions(const std::string& text, const video::Board& board) {
    const std::string option = "--board-in-scene";
    const auto parts = split_at(text, ';');
    if (parts.size() < 3 || parts.size() > 4)
        throw InputError({option + " \"" + text + "\"", "has " + std::to_string(parts.size()) + " parts, not 3 or 4",
            "", "write origin; x axis; y axis; thickness, as in \"10 0 5 cm; 1 0 0; 0 0 1; 2 mm\""});
    const Vec3 origin = read_vector(parts[0], unit::length, option);
    Vec3 x = read_vector(parts[1], unit::none, option), y = read_vector(parts[2], unit::none, option);
    const auto dot = [](const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    const double lx = std::sqrt(dot(x, x)), ly = std::sqrt(dot(y, y));
    if (!(lx > 0 && ly > 0) || std::abs(dot(x, y)) > 1e-3 * lx * ly)
        throw InputError({option + " \"" + text + "\"", "the axes are not at right angles",
            "a board's rows and columns are", "measure them again"});
    for (double& v : x) v /= lx;
    for (double& v : y) v /= ly;
    const Vec3 into{x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
    double thickness = 0;
    if (parts.size() == 4) {
        const auto first = parts[3].find_first_not_of(' ');
        thickness = first == std::string::npos ? 0 : read_length(option + " thickness", parts[3].substr(first));
    }
    std::vector<Vec3> out;
    for (const auto& p : video::board_points(board)) {
        Vec3 position;
        for (std::size_t k = 0; k < 3; ++k) position[k] = origin[k] + p[0] * x[k] + p[1] * y[k] - thickness * into[k];
        out.push_back(position);
    }
    return out;
}

std::vector<video::ScenePoint> board_points_in_scene(
    const CalibrateRequest& request, const video::CameraRecord& camera, Log& log) {
    if (request.pose_picture.empty() || request.board_in_scene.empty() || request.square.empty())
        throw InputError({"--pose-picture, --board-in-scene, --square", "belong together",
            "the picture shows the board where it lies in the scene, the place says where that is", "give all three"});
    auto board = video::read_board(request.board);
    video::check_board(board);
    board.spacing = read_length("--square", request.square);
    const auto positions = board_positions(request.board_in_scene, board);
    auto read = video::read_photo(request.pose_picture);
    if (const auto* unreadable = std::get_if<video::Unreadable>(&read))
        throw InputError({request.pose_picture, "cannot be read", unreadable->reason, "give another picture"});
    const auto& photo = std::get<video::Photo>(read);
    const auto seen_by = video::for_pictures(camera, photo.width, photo.height, request.pose_picture);
    const auto view = video::find_board(photo, board, {request.window});
    if (!view)
        throw InputError({request.pose_picture, "no " + board.text() + " was found", "",
            "film the whole board, with a white rim around it"});
    const auto points = video::unbiased_points(seen_by.lens, board, *view);
    std::vector<video::ScenePoint> out;
    for (std::size_t i = 0; i < positions.size(); ++i)
        out.push_back({positions[i], points[i], std::max(camera.rms, 0.1), request.pose_picture});
    const fs::path file = fs::path(request.out).parent_path() / (fs::path(request.out).stem().string() + "_board.png");
    video::write_png(file, video::draw_board_axes(request.pose_picture, board, *view));
    log.line("axes of the board: " + file.string());
    return out;
}

void print_pose(Log& log, const video::CameraRecord& camera) {
    const Vec3 position = camera.pose->position();
    log.line("position " + vector_text(position, 5) + " m, looks along " + vector_text(camera.pose->rotation[2], 5));
    if (!camera.pose_covariance) return;
    const auto& c = *camera.pose_covariance;
    const auto deviation = [&](std::size_t i) { return std::sqrt(c[7 * i]); };
    log.line("deviations: turn " + format_fixed(deviation(0) / degree, 4) + ", " +
             format_fixed(deviation(1) / degree, 4) + ", " + format_fixed(deviation(2) / degree, 4) +
             " deg about the camera's axes; translation " + format_fixed(1e3 * deviation(3), 3) + ", " +
             format_fixed(1e3 * deviation(4), 3) + ", " + format_fixed(1e3 * deviation(5), 3) + " mm");
}

void take_points(const CalibrateRequest& request, video::CameraRecord& camera, Log& log) {
    const bool listed = !request.points.empty();
    const auto points = listed ? video::read_scene_points(request.points) : board_points_in_scene(request, camera, log);
    const auto estimate = video::pose_of_points(camera, points, {request.point_noise});
    if (listed)
        for (std::size_t i = 0; i < points.size(); ++i)
            log.line(points[i].where + "  error " + format_fixed(estimate.distances[i], 2) + " pixels");
    log.line(
        "pose from " + std::to_string(points.size()) + " points, error " + format_fixed(estimate.rms, 3) + " pixels");
    for (const auto& warning : estimate.warnings) log.warn(warning);
    camera.pose = estimate.pose;
    camera.pose_covariance = estimate.covariance;
}

void refine(const CalibrateRequest& request, video::CameraRecord& camera, Log& log) {
    const auto scene = load(request, "--contour");
    const auto solid = find_seen_solid(scene.input, scene.geometry, request.contour_of);
    const auto silhouette = video::read_silhouette(request.contour);
    camera = video::for_pictures(camera, silhouette.mask.width, silhouette.mask.height, request.contour);
    const auto found = video::refine_on_contour(camera, solid, silhouette, {});
    camera.pose = found.estimate.pose;
    camera.pose_covariance = found.estimate.covariance;
    log.line("refined on the outline of " + solid.name + ": " + std::to_string(found.points) + " points, " +
             format_fixed(100 * found.fitting, 0) + " % fit, displacement " + format_fixed(found.mean, 3) + " +- " +
             format_fixed(found.estimate.noise, 3) + " pixels, correlated over " + format_fixed(found.correlation, 0) +
             " pixels, " + format_fixed(found.pieces, 0) + " independent pieces, overlap " +
             format_fixed(found.overlap_before, 4) + " -> " + format_fixed(found.overlap_after, 4));
    log.line("deviation at the liquid " +
             format_fixed(video::pixel_deviation(camera.model(), *camera.pose_covariance, solid.centre), 3) +
             " pixels");
    for (const auto& warning : found.estimate.warnings) log.warn(warning);
}

void find_vertical(const CalibrateRequest& request, const video::CameraRecord& camera, Log& log) {
    Vec3 gravity{0, 0, -9.81};
    if (!request.scene.empty()) gravity = load(request, "--scene").input.scene.domain.gravity;
    const Vec3 about{-gravity[0], -gravity[1], -gravity[2]};
    const auto report = [&](const video::Vertical& vertical, const std::string& source) {
        const double g = std::sqrt(gravity[0] * gravity[0] + gravity[1] * gravity[1] + gravity[2] * gravity[2]);
        double cosine = 0;
        for (std::size_t k = 0; k < 3; ++k) cosine -= vertical.up[k] * gravity[k] / g;
        const double angle = std::acos(std::min(1.0, cosine)) / degree;
        log.line("vertical from the " + source + ": " + vector_text(vertical.up, 5) + " +- " +
                 format_fixed(vertical.deviation / degree, 2) + " deg, " + format_fixed(angle, 2) +
                 " deg from that of the scene; points fit to " + format_fixed(1e3 * vertical.residual, 2) + " mm");
        log.line("domain.gravity: [" + vector_text({-g * vertical.up[0], -g * vertical.up[1], -g * vertical.up[2]}, 4) +
                 "]");
        if (angle * degree > 2 * vertical.deviation && angle > 0.2)
            log.warn("the scene's gravity is off by " + format_fixed(angle, 2) + " deg, " +
                     format_fixed(100 * std::sin(angle * degree), 1) + " % of it sideways");
    };
    if (!request.level.empty())
        report(video::vertical_of_level(camera, video::read_levels(request.level), about, level_noise), "level");
    if (!request.plumb.empty())
        report(video::vertical_of_plumb(camera, video::read_levels(request.plumb), about, level_noise), "plumb line");
}

void draw(const CalibrateRequest& request, const video::CameraRecord& camera, Log& log) {
    if (request.frame.empty())
        throw InputError({"--overlay", "needs the frame", "the scene is drawn over it", "add --frame PICTURE"});
    const auto scene = load(request, "--overlay");
    video::SceneOverlay overlay;
    overlay.domain = domain_box(scene.input.scene.domain);
    overlay.caption = scene.input.scene.title;
    const auto add = [&](const video::SeenSolid& solid, video::OverlayKind kind) {
        overlay.solids.push_back(solid);
        overlay.kinds.push_back(kind);
    };
    for (std::size_t i = 0; i < scene.geometry.liquids.size(); ++i)
        if (!scene.geometry.liquids[i].empty())
            add(seen_liquid(scene.input, scene.geometry, i), video::OverlayKind::liquid);
    for (std::size_t i = 0; i < scene.geometry.bodies.size(); ++i)
        if (scene.geometry.originals[i].closed() && !scene.geometry.originals[i].inverted())
            add(seen_body(scene.input, scene.geometry, i), video::OverlayKind::body);
    if (!request.contour.empty()) overlay.silhouette = video::read_silhouette(request.contour).mask;
    video::write_png(request.overlay, video::draw_overlay(camera, request.frame, overlay));
    log.line("overlay: " + request.overlay);
}

} // namespace

bool asks_for_pose(const CalibrateRequest& request) {
    for (const auto* text : {&request.points, &request.pose_picture, &request.board_in_scene, &request.contour,
             &request.level, &request.plumb, &request.overlay})
        if (!text->empty()) return true;
    return false;
}

void find_pose(const CalibrateRequest& request, video::CameraRecord& camera, Log& log) {
    if (!request.points.empty() || !request.pose_picture.empty() || !request.board_in_scene.empty())
        take_points(request, camera, log);
    if (!request.contour.empty()) refine(request, camera, log);
    if (camera.pose) print_pose(log, camera);
    if (!request.level.empty() || !request.plumb.empty()) find_vertical(request, camera, log);
    if (!request.overlay.empty()) draw(request, camera, log);
}

} // namespace treacle::app
