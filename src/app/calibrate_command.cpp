#include "app/subcommands.hpp"

#include "app/video/calibrate.hpp"

#include <memory>

namespace treacle::app {

namespace {
void add_lens_options(CLI::App& app, CalibrateRequest& request) {
    app.add_option("pictures", request.pictures, "Pictures of the board, folders with them, or videos of it")
        ->type_name("PICTURE...");
    app.add_option("--camera", request.camera,
           "A lens that is known, in the place of pictures: OpenCV's YAML, JSON or XML, "
           "ViRheometry's camera_params.xml, COLMAP's text model; FILE:NAME for one of several")
        ->type_name("FILE");
    app.add_option("--board", request.board,
           "9x6 (default): a chessboard by its inner corners; circles:4x11: an asymmetric grid of circles")
        ->type_name("SIZE");
    app.add_option(
           "--square", request.square, "Side of a square, or distance of neighbouring rows of circles, as in 25mm")
        ->type_name("LENGTH");
    app.add_option("--coefficients", request.coefficients,
           "Of the distortion: 0, 4 (k1 k2 p1 p2), 5 (and k3, default) or 8 (and k4 k5 k6)")
        ->check(CLI::IsMember({0, 4, 5, 8}))
        ->type_name("NUMBER");
    app.add_option("--window", request.window,
           "Half of the side of the window in which corners are refined (default: 0.4 of the smallest square, 2 to 11)")
        ->check(CLI::Range(1, 100))
        ->type_name("PIXELS");
    app.add_option("--outliers", request.outliers,
           "A picture is left out when its error exceeds the median by this factor (default 3)")
        ->check(CLI::Range(1.0, 1e9))
        ->type_name("FACTOR");
    app.add_option("--name", request.name, "Of the camera (default main)")->type_name("NAME");
    app.add_option("--out", request.out, "The camera's file: .yaml (default camera.yaml), .json or .xml")
        ->type_name("FILE");
}

void add_pose_options(CLI::App& app, CalibrateRequest& request) {
    const auto add = [&](const std::string& name, std::string& text, const std::string& doc, const std::string& type) {
        app.add_option(name, text, doc)->type_name(type);
    };
    add("--points", request.points,
        "Pose from points of the scene: a table with columns x [cm], y [cm], z [cm], u, v and perhaps s", "FILE");
    app.add_option("--point-noise", request.point_noise,
           "Standard deviation of u and v where the table states none (default 1)")
        ->check(CLI::PositiveNumber)
        ->type_name("PIXELS");
    add("--pose-picture", request.pose_picture, "Pose from a picture of the board where it lies in the scene",
        "PICTURE");
    add("--board-in-scene", request.board_in_scene,
        "Where that is: first point; axis along a row; axis along a column; thickness of the board, as in \"10 0 5 cm; "
        "1 0 0; 0 0 1; 2 mm\"",
        "PLACE");
    add("--scene", request.scene, "The scene that the camera films", "SCENE");
    add_repeated(app, "--set", request.overrides, "Override a key of the scene: a.b.c=value.");
    add_repeated(app, "--data", request.data, "Folder in which meshes are looked up.");
    add("--contour", request.contour, "Refine the pose on the silhouette of the first frame: a mask", "PICTURE");
    add("--contour-of", request.contour_of, "Which liquid or body of the scene the mask shows (default: the liquids)",
        "NAME");
    add("--level", request.level, "The vertical from where the liquid's level meets walls: lines \"u, v, x = 2 cm\"",
        "FILE");
    add("--plumb", request.plumb, "The vertical from a plumb line: lines as those of --level", "FILE");
    add("--overlay", request.overlay, "Draw the scene at its start over --frame into this PNG", "FILE");
    add("--frame", request.frame, "A frame of the video, for --overlay", "PICTURE");
}
} // namespace

void add_calibrate(CLI::App& program, Chosen& chosen) {
    auto request = std::make_shared<CalibrateRequest>();
    auto& app =
        *program.add_subcommand("calibrate", "The lens of a camera from pictures of a board, and its pose in a scene.");
    add_lens_options(app, *request);
    add_pose_options(app, *request);
    app.callback([request, &chosen] {
        chosen.make = [request]() -> Command {
            return [request](const Comm& comm) { return calibrate_camera(comm, *request); };
        };
    });
}

} // namespace treacle::app
