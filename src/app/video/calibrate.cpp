#include "app/video/calibrate.hpp"

#include "app/input/option_values.hpp"
#include "app/video/calibrate_pose.hpp"
#include "base/text/file.hpp"
#include "base/text/log.hpp"
#include "base/text/progress.hpp"
#include "base/text/text.hpp"
#include "video/camera/board_pictures.hpp"
#include "video/camera/camera_file.hpp"
#include "video/camera/coverage_picture.hpp"
#include "video/clip/movie.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace treacle::app {

namespace {

namespace fs = std::filesystem;

video::Board board_of(const CalibrateRequest& request) {
    auto board = video::read_board(request.board);
    video::check_board(board);
    if (request.square.empty())
        throw InputError({"--square", "is missing", "the scale of poses follows from it",
            "measure the side of a square over the whole board, as in --square 24.9mm"});
    board.spacing = read_length("--square", request.square);
    return board;
}

std::string state_text(video::PictureState state) {
    switch (state) {
    case video::PictureState::used: return "used";
    case video::PictureState::outlier: return "outlier";
    case video::PictureState::unreadable: return "unreadable";
    case video::PictureState::blurred: return "blurred";
    case video::PictureState::no_board: break;
    }
    return "no board";
}

bool has_errors(const video::BoardPicture& picture) {
    return picture.state == video::PictureState::used || picture.state == video::PictureState::outlier;
}

void print_pictures(Log& log, const video::Calibration& calibration) {
    std::size_t width = 7;
    for (const auto& picture : calibration.pictures) width = std::max(width, picture.name.size());
    const auto padded = [&](std::string text, std::size_t columns) {
        text.resize(std::max(columns, text.size()), ' ');
        return text;
    };
    log.line(padded("picture", width) + "  error  largest [pixels]");
    for (const auto& picture : calibration.pictures) {
        const auto errors = has_errors(picture) ? format_fixed(picture.rms, 3) + "  " + format_fixed(picture.largest, 3)
                                                : std::string("    -      -");
        const bool used = picture.state == video::PictureState::used;
        log.line(padded(picture.name, width) + "  " + errors +
                 (used ? "" : "  " + state_text(picture.state) + ": " + picture.reason));
    }
}

void print_parameters(Log& log, const video::Calibration& calibration) {
    const auto& lens = calibration.lens;
    std::array<double, video::intrinsic_count> values{lens.fx, lens.fy, lens.cx, lens.cy};
    std::ranges::copy(lens.distortion, values.begin() + 4);
    for (std::size_t i = 0; i < 4 + std::size_t(calibration.options.coefficients); ++i) {
        const int decimals = i < 4 ? 2 : 5;
        log.line(video::intrinsic_names()[i] + "  " + format_fixed(values[i], decimals) + " +- " +
                 format_fixed(calibration.covariance.deviation(i), decimals) + (i < 4 ? " pixels" : ""));
    }
}

std::string quoted(std::string text) {
    std::ranges::replace(text, '"', '\'');
    return '"' + text + '"';
}

std::string table_of(const video::Calibration& calibration) {
    std::string out = "picture,state,error [pixels],largest error [pixels],edge width [pixels],reason\n";
    for (const auto& picture : calibration.pictures) {
        const auto number = [&](double value) { return has_errors(picture) ? format_number(value) : std::string(); };
        out += quoted(picture.name) + "," + state_text(picture.state) + "," + number(picture.rms) + "," +
               number(picture.largest) + "," + format_number(picture.view.edge_width) + "," + quoted(picture.reason) +
               "\n";
    }
    return out;
}

fs::path beside(const fs::path& path, const std::string& ending) {
    return path.parent_path() / (path.stem().string() + ending);
}

video::CameraRecord record_of(const video::Calibration& calibration, const std::string& name) {
    video::CameraRecord camera;
    camera.name = name.empty() ? "main" : name;
    camera.lens = calibration.lens;
    camera.covariance = calibration.covariance;
    camera.rms = calibration.rms;
    camera.where = "this calibration";
    return camera;
}

std::string count_of_used(const video::Calibration& calibration, const video::CalibrationOptions& options) {
    return std::to_string(calibration.count(video::PictureState::used)) + " of " +
           std::to_string(calibration.pictures.size()) + " pictures used, error " + format_fixed(calibration.rms, 3) +
           " pixels; outliers exceed " + format_number(options.outlier_factor) + " times the median and " +
           format_number(options.outlier_floor) + " pixels";
}

video::Calibration calibrate_lens(const CalibrateRequest& request, Log& log) {
    const auto board = board_of(request);
    video::BoardPicturesOptions search;
    search.search.window = request.window;
    Progress progress(log, "calibrate", "%");
    search.progress = [&](double fraction) { progress.report(std::llround(100 * fraction), 100); };
    const auto paths = video::list_pictures({request.pictures.begin(), request.pictures.end()});
    auto pictures = video::find_boards(paths, board, search);
    progress.finish();
    video::CalibrationOptions options;
    options.coefficients = request.coefficients;
    options.outlier_factor = request.outliers;
    auto calibration = video::calibrate(board, options, std::move(pictures));
    print_pictures(log, calibration);
    log.line(count_of_used(calibration, options));
    print_parameters(log, calibration);
    for (const auto& warning : calibration.warnings) log.warn(warning);
    return calibration;
}

video::CameraRecord given_camera(const CalibrateRequest& request) {
    const auto colon = request.camera.rfind(':');
    const bool named = !fs::exists(request.camera) && colon != std::string::npos;
    auto camera = named ? video::read_camera(request.camera.substr(0, colon), request.camera.substr(colon + 1))
                        : video::read_camera(request.camera, "");
    if (!request.name.empty()) camera.name = request.name;
    return camera;
}

void calibrate_alone(const CalibrateRequest& request) {
    if (request.pictures.empty() == request.camera.empty())
        throw InputError({"treacle calibrate",
            request.camera.empty() ? "no pictures and no camera are given" : "pictures and a camera are given",
            "the lens comes from one of them",
            "give 10 to 20 pictures of the board, or a folder with them, or --camera FILE"});
    if (!request.camera.empty() && !asks_for_pose(request))
        throw InputError({"treacle calibrate --camera", "nothing is asked for", "the lens is known",
            "add --points, --pose-picture, --contour, --level, --plumb or --overlay"});
    Log log(LogOutput::enabled);
    const fs::path out = request.out;
    video::CameraRecord camera;
    std::optional<video::Calibration> calibration;
    if (request.camera.empty()) {
        calibration = calibrate_lens(request, log);
        camera = record_of(*calibration, request.name);
    } else {
        camera = given_camera(request);
    }
    find_pose(request, camera, log);
    std::string files = out.string();
    video::write_cameras(out, {camera});
    if (calibration) {
        write_file_atomically(beside(out, "_pictures.csv"), table_of(*calibration));
        video::write_png(beside(out, "_coverage.png"), video::draw_coverage(*calibration));
        files += ", " + beside(out, "_pictures.csv").string() + ", " + beside(out, "_coverage.png").string();
    }
    log.line("camera: " + files);
}

} // namespace

ExitCode calibrate_camera(const Comm& comm, const CalibrateRequest& request) {
    comm.guard_root([&] { calibrate_alone(request); });
    return ExitCode::ok;
}

} // namespace treacle::app
