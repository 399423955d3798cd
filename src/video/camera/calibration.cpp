#include "video/camera/calibration.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/camera/calibration_covariance.hpp"
#include "video/camera/camera_matrix.hpp"
#include "video/camera/circle_bias.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>

namespace treacle::video {

namespace {

constexpr int bias_rounds = 3; // of lens, poses and the bias of circles

using Used = std::vector<BoardPicture*>;

Used used_pictures(std::vector<BoardPicture>& pictures) {
    Used used;
    for (auto& picture : pictures)
        if (picture.state == PictureState::used) used.push_back(&picture);
    return used;
}

// Pictures of most files have the size of the camera.
void check_sizes(const std::vector<BoardPicture>& pictures) {
    std::map<std::pair<int, int>, std::vector<std::string>> sizes;
    for (const auto& picture : pictures)
        if (picture.width > 0) sizes[{picture.width, picture.height}].push_back(picture.name);
    if (sizes.size() < 2) return;
    const auto most = std::ranges::max_element(sizes, {}, [](const auto& entry) { return entry.second.size(); });
    std::vector<Diagnostic> problems;
    const auto text = [](const std::pair<int, int>& size) {
        return std::to_string(size.first) + " x " + std::to_string(size.second) + " pixels";
    };
    for (const auto& [size, names] : sizes) {
        if (size == most->first) continue;
        const bool turned = size.first == most->first.second && size.second == most->first.first;
        for (const auto& name : names)
            problems.push_back({name, "has " + text(size) + ", others have " + text(most->first),
                turned ? "it is turned by a quarter" : "a lens is calibrated for one size of picture and one zoom",
                "leave it out, or calibrate each size by itself"});
    }
    throw InputError(problems);
}

void check_count(const std::vector<BoardPicture>& pictures, const Board& board) {
    const auto found = std::ranges::count_if(pictures, [](const auto& p) { return p.state == PictureState::used; });
    if (std::size_t(found) >= least_pictures) return;
    std::vector<Diagnostic> problems{{"",
        "the board was found in " + std::to_string(found) + " of " + std::to_string(pictures.size()) +
            (pictures.size() == 1 ? " picture" : " pictures") + ": a " + board.text(),
        "at least " + std::to_string(least_pictures) + " are needed, from unlike directions",
        "10 to 20 sharp pictures in which the whole board is seen, with a white rim around it, are usual"}};
    for (const auto& picture : pictures)
        if (picture.state != PictureState::used && problems.size() < 11)
            problems.push_back({picture.name, picture.reason, "", ""});
    throw InputError(problems);
}

int flags_of(const CalibrationOptions& options) {
    switch (options.coefficients) {
    case 0: return cv::CALIB_FIX_K1 | cv::CALIB_FIX_K2 | cv::CALIB_FIX_K3 | cv::CALIB_ZERO_TANGENT_DIST;
    case 4: return cv::CALIB_FIX_K3;
    case 8: return cv::CALIB_RATIONAL_MODEL;
    default: return 0;
    }
}

void measure_errors(BoardPicture& picture, const scene::Lens& lens, const std::vector<Vec3>& points) {
    const scene::CameraModel camera = unchecked_camera(lens, picture.pose);
    double sum = 0;
    picture.largest = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto p = camera.project(points[i]);
        const double d = std::hypot(p.x - picture.view.points[i][0], p.y - picture.view.points[i][1]);
        sum += d * d;
        picture.largest = std::max(picture.largest, d);
    }
    picture.rms = std::sqrt(sum / double(points.size()));
}

// Fits lens and poses to the pictures used; true when OpenCV's iteration ended at finite numbers.
void fit(Calibration& calibration) {
    const auto points = board_points(calibration.board);
    const auto used = used_pictures(calibration.pictures);
    std::vector<cv::Point3f> object;
    object.reserve(points.size());
    for (const auto& p : points) object.emplace_back(float(p[0]), float(p[1]), float(p[2]));
    std::vector<std::vector<cv::Point2f>> seen;
    for (const auto* picture : used) {
        auto& list = seen.emplace_back();
        for (const auto& p : picture->view.points) list.emplace_back(float(p[0]), float(p[1]));
    }
    cv::Mat matrix, distortion;
    std::vector<cv::Mat> turns, shifts;
    const cv::TermCriteria stop(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 200, 1e-12);
    cv::calibrateCamera(std::vector<std::vector<cv::Point3f>>(used.size(), object), seen,
        {used[0]->width, used[0]->height}, matrix, distortion, turns, shifts, flags_of(calibration.options), stop);
    calibration.lens = lens_of(matrix, distortion, used[0]->width, used[0]->height);
    for (std::size_t i = 0; i < used.size(); ++i) {
        used[i]->pose = pose_of(turns[i], shifts[i]);
        measure_errors(*used[i], calibration.lens, points);
    }
    double sum = 0;
    for (const auto* picture : used) sum += picture->rms * picture->rms;
    calibration.rms = std::sqrt(sum / double(used.size()));
}

// Fits, and where circles were seen fits again with their points moved to the images of the circles' middles.
void fit_unbiased(Calibration& calibration) {
    fit(calibration);
    if (calibration.board.kind == BoardKind::chessboard) return;
    const auto centres = board_points(calibration.board);
    const auto used = used_pictures(calibration.pictures);
    std::vector<std::vector<std::array<double, 2>>> seen;
    for (const auto* picture : used) seen.push_back(picture->view.points);
    for (int round = 0; round < bias_rounds; ++round) {
        for (std::size_t k = 0; k < used.size(); ++k) {
            const auto bias =
                circle_bias(unchecked_camera(calibration.lens, used[k]->pose), centres, used[k]->view.diameter);
            for (std::size_t i = 0; i < centres.size(); ++i)
                for (std::size_t c = 0; c < 2; ++c) used[k]->view.points[i][c] = seen[k][i][c] - bias[i][c];
        }
        fit(calibration);
    }
}

// The picture to leave out, or nothing.
BoardPicture* worst_outlier(Calibration& calibration) {
    auto used = used_pictures(calibration.pictures);
    if (used.size() <= least_pictures) return nullptr;
    std::ranges::sort(used, {}, [](const auto* p) { return p->rms; });
    const double median = 0.5 * (used[(used.size() - 1) / 2]->rms + used[used.size() / 2]->rms);
    const auto& options = calibration.options;
    auto* worst = used.back();
    if (worst->rms < options.outlier_floor || worst->rms < options.outlier_factor * median) return nullptr;
    worst->state = PictureState::outlier;
    worst->reason = "its error is " + format_number(std::round(10 * worst->rms / median) / 10) +
                    " times the median of the pictures, " + format_number(std::round(1000 * median) / 1000) + " pixels";
    return worst;
}

std::string rounded(double value, int decimals) {
    const double unit = std::pow(10.0, decimals);
    return format_number(std::round(value * unit) / unit);
}

void warn(Calibration& calibration) {
    auto& warnings = calibration.warnings;
    if (calibration.rms > 1)
        warnings.push_back(
            "the error of " + rounded(calibration.rms, 2) +
            " pixels is above 1: the board may not be flat, or its size of squares or the focus changed");
    const auto coverage = coverage_of(calibration);
    if (coverage.covered() < 0.6 || coverage.corners() < 4)
        warnings.push_back("the board was seen in " + rounded(100 * coverage.covered(), 0) +
                           " % of the picture and in " + std::to_string(coverage.corners()) +
                           " of its 4 corners: the distortion elsewhere is a guess; add pictures with the board there");
    const double rays = ray_deviation(calibration);
    if (rays > 1)
        warnings.push_back("rays are known to " + rounded(rays, 1) +
                           " pixels only: add pictures with the board tilted by 30 to 45 degrees");
    if (used_pictures(calibration.pictures).size() < 8)
        warnings.push_back("few pictures: standard deviations from fewer than 8 are themselves uncertain by a third");
}

} // namespace

const std::array<std::string, intrinsic_count>& intrinsic_names() {
    static const std::array<std::string, intrinsic_count> names{
        "fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
    return names;
}

double IntrinsicCovariance::deviation(std::size_t i) const { return std::sqrt(at(i, i)); }

std::size_t Calibration::count(PictureState state) const {
    return std::size_t(std::ranges::count_if(pictures, [&](const auto& p) { return p.state == state; }));
}

Calibration calibrate(const Board& board, const CalibrationOptions& options, std::vector<BoardPicture> pictures) {
    check_board(board);
    check_sizes(pictures);
    check_count(pictures, board);
    Calibration calibration;
    calibration.board = board;
    calibration.options = options;
    calibration.pictures = std::move(pictures);
    fit_unbiased(calibration);
    while (worst_outlier(calibration)) fit(calibration);
    const auto points = board_points(board);
    for (auto& picture : calibration.pictures) {
        if (picture.state != PictureState::outlier) continue;
        picture.pose = pose_from_points(calibration.lens, points, picture.view.points);
        measure_errors(picture, calibration.lens, points);
    }
    calibration.covariance = jackknife_covariance(calibration);
    warn(calibration);
    return calibration;
}

double Coverage::covered() const {
    int count = 0;
    for (const auto& row : points) count += int(std::ranges::count_if(row, [](int n) { return n > 0; }));
    return double(count) / (parts * parts);
}

int Coverage::corners() const {
    int count = 0;
    for (const int top : {0, parts - 2})
        for (const int left : {0, parts - 2}) {
            int inside = 0;
            for (int i = 0; i < 4; ++i) inside += points[std::size_t(top + i / 2)][std::size_t(left + i % 2)];
            count += inside > 0;
        }
    return count;
}

Coverage coverage_of(const Calibration& calibration) {
    Coverage coverage;
    const auto& lens = calibration.lens;
    const auto part = [](double x, int side) {
        return std::size_t(std::clamp(int((x + 0.5) * Coverage::parts / side), 0, Coverage::parts - 1));
    };
    for (const auto& picture : calibration.pictures) {
        if (picture.state != PictureState::used) continue;
        for (const auto& p : picture.view.points) ++coverage.points[part(p[1], lens.height)][part(p[0], lens.width)];
    }
    return coverage;
}

} // namespace treacle::video
