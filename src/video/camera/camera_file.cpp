#include "video/camera/camera_file.hpp"

#include "base/text/error.hpp"
#include "base/text/file.hpp"
#include "base/text/text.hpp"
#include "video/camera/camera_conventions.hpp"
#include "video/camera/camera_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>

namespace treacle::video {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(
    const std::string& where, const std::string& problem, const std::string& reason, const std::string& cure) {
    throw InputError({where, problem, reason, cure});
}

// The first of these keys that the node has.
cv::FileNode find(const cv::FileNode& node, const std::vector<std::string>& keys) {
    for (const auto& key : keys)
        if (!node[key].empty()) return node[key];
    return {};
}

// A matrix, a plain list, or a map with `data` as ROS writes it, as one list of numbers.
std::vector<double> read_numbers(const cv::FileNode& node, const std::string& where, const std::string& key) {
    std::vector<double> out;
    if (node.isMap() && node["dt"].empty() && node["data"].isSeq()) return read_numbers(node["data"], where, key);
    if (node.isSeq()) {
        for (const auto& item : node) {
            if (item.isSeq()) {
                const auto row = read_numbers(item, where, key);
                out.insert(out.end(), row.begin(), row.end());
            } else if (item.isReal() || item.isInt()) {
                out.push_back(double(item));
            } else {
                refuse(where, key + " holds something that is no number", "", "");
            }
        }
        return out;
    }
    cv::Mat matrix;
    node >> matrix;
    if (matrix.empty() || matrix.channels() != 1)
        refuse(where, key + " is no matrix of numbers", "", "write it as cv::FileStorage does, or as a list");
    matrix.convertTo(matrix, CV_64F);
    matrix = matrix.clone();
    return {matrix.begin<double>(), matrix.end<double>()};
}

std::vector<double> require_numbers(
    const cv::FileNode& node, const std::vector<std::string>& keys, const std::string& where, std::size_t count) {
    const auto found = find(node, keys);
    if (found.empty())
        refuse(where, keys.front() + " is missing", "",
            "a camera needs image_width, image_height, camera_matrix and distortion_coefficients");
    auto out = read_numbers(found, where, keys.front());
    if (out.size() != count)
        refuse(where, keys.front() + " has " + std::to_string(out.size()) + " numbers, not " + std::to_string(count),
            "", "");
    return out;
}

scene::Lens read_lens(const cv::FileNode& node, const std::string& where) {
    scene::Lens lens;
    const auto width = find(node, {"image_width", "width"}), height = find(node, {"image_height", "height"});
    if (!width.isInt() || !height.isInt())
        refuse(where, "image_width or image_height is missing",
            "the focal length in pixels holds for one size of picture only",
            "add the size of the pictures of the calibration");
    lens.width = int(width);
    lens.height = int(height);
    const auto m = require_numbers(node, {"camera_matrix", "cameraMatrix", "Camera_Matrix", "K"}, where, 9);
    if (std::abs(m[1]) > 1e-9 * std::abs(m[0]) || std::abs(m[3]) > 1e-9 || std::abs(m[6]) > 1e-9 ||
        std::abs(m[7]) > 1e-9 || std::abs(m[8] - 1) > 1e-9)
        refuse(where, "camera_matrix is not [fx 0 cx; 0 fy cy; 0 0 1]", "", "skewed pixels are not modelled");
    lens.fx = m[0];
    lens.cx = m[2];
    lens.fy = m[4];
    lens.cy = m[5];
    const auto found =
        find(node, {"distortion_coefficients", "Distortion_Coefficients", "dist_coeffs", "distCoeffs", "D"});
    std::vector<double> d;
    if (!found.empty()) d = read_numbers(found, where, "distortion_coefficients");
    const auto named = find(node, {"distortion_model"});
    if (named.isString() && (std::string(named) == "equidistant" || std::string(named) == "fisheye"))
        refuse(where, "distortion_model " + std::string(named) + " is not known",
            "lenses have OpenCV's k1 k2 p1 p2 k3 k4 k5 k6", "calibrate with cv::calibrateCamera");
    const bool thin = std::any_of(
        d.begin() + std::ptrdiff_t(std::min<std::size_t>(8, d.size())), d.end(), [](double k) { return k != 0; });
    if ((!d.empty() && d.size() != 4 && d.size() != 5 && d.size() < 8) || thin)
        refuse(where, "distortion_coefficients has " + std::to_string(d.size()) + " numbers: must be 4, 5 or 8",
            thin ? "thin prisms and tilted sensors are not modelled" : "they are k1 k2 p1 p2, k3, and k4 k5 k6", "");
    std::copy_n(d.begin(), std::min<std::size_t>(8, d.size()), lens.distortion.begin());
    return lens;
}

std::optional<scene::CameraPose> read_pose(const cv::FileNode& node, const std::string& where) {
    const std::vector<std::string> vectors{"rotation_vector", "rvec"}, matrices{"rotation_matrix", "R"},
        shifts{"translation_vector", "tvec", "T", "t"};
    const auto vector = find(node, vectors), matrix = find(node, matrices), shift = find(node, shifts);
    if (vector.empty() && matrix.empty() && shift.empty()) return {};
    scene::CameraPose pose;
    const auto t = require_numbers(node, shifts, where, 3);
    pose.translation = {t[0], t[1], t[2]};
    if (!matrix.empty()) {
        const auto r = require_numbers(node, matrices, where, 9);
        for (std::size_t i = 0; i < 9; ++i) pose.rotation[i / 3][i % 3] = r[i];
    } else {
        const auto v = require_numbers(node, vectors, where, 3);
        pose.rotation = scene::rotation_matrix({v[0], v[1], v[2]});
    }
    return pose;
}

void read_covariances(const cv::FileNode& node, CameraRecord& record) {
    const auto lens = node["intrinsic_covariance"], pose = node["pose_covariance"];
    if (!lens.empty()) {
        record.covariance.emplace();
        record.covariance->values =
            require_numbers(node, {"intrinsic_covariance"}, record.where, intrinsic_count * intrinsic_count);
    }
    if (!pose.empty()) {
        const auto values = require_numbers(node, {"pose_covariance"}, record.where, 36);
        record.pose_covariance.emplace();
        std::ranges::copy(values, record.pose_covariance->begin());
    }
    const auto rms = find(node, {"reprojection_error", "avg_reprojection_error"});
    if (rms.isReal() || rms.isInt()) record.rms = double(rms);
}

CameraRecord read_one(const cv::FileNode& node, const std::string& file, const std::string& name) {
    CameraRecord record;
    const auto given = find(node, {"name", "camera_name"});
    record.name = given.isString() ? std::string(given) : name;
    record.where = name.empty() ? file : file + ", camera " + record.name;
    if (record.name.empty()) record.name = "main";
    record.lens = read_lens(node, record.where);
    record.pose = read_pose(node, record.where);
    read_covariances(node, record);
    // Refused here, with the file's name, rather than where it is used.
    const scene::CameraModel checked(record.where, record.lens, record.pose.value_or(scene::CameraPose{}));
    return record;
}

std::vector<CameraRecord> read_storage(const fs::path& path, std::string content) {
    const auto file = path.string();
    const auto first = content.find_first_not_of(" \t\r\n");
    if (first == std::string::npos) refuse(file, "is empty", "", "calibrate a camera with `treacle calibrate`");
    const bool marked = content[first] == '{' || content[first] == '<' || content.starts_with("%YAML");
    if (!marked) content = "%YAML:1.0\n---\n" + content;
    try {
        const cv::FileStorage storage(content, cv::FileStorage::READ | cv::FileStorage::MEMORY);
        const auto root = storage.root();
        const auto list = root["cameras"];
        if (list.empty()) return {read_one(root, file, "")};
        std::vector<CameraRecord> out;
        for (const auto& node : list) out.push_back(read_one(node, file, std::to_string(out.size())));
        if (out.empty()) refuse(file, "cameras is empty", "", "");
        return out;
    } catch (const cv::Exception&) {
        refuse(file, "is no camera file",
            "it is neither OpenCV's YAML, JSON or XML, ViRheometry's XML nor a model of COLMAP",
            "calibrate a camera with `treacle calibrate`, or see `treacle calibrate --help` for the formats");
    }
}

cv::Mat column(const Vec3& v) { return (cv::Mat_<double>(3, 1) << v[0], v[1], v[2]); }

void write_pose(cv::FileStorage& out, const CameraRecord& camera) {
    const auto& pose = *camera.pose;
    out << "rotation_vector" << column(scene::rotation_vector(pose.rotation));
    out << "translation_vector" << column(pose.translation);
    out << "position" << column(pose.position());
    if (!camera.pose_covariance) return;
    const cv::Mat covariance(6, 6, CV_64F, const_cast<double*>(camera.pose_covariance->data()));
    out << "pose_covariance" << covariance;
}

void write_one(cv::FileStorage& out, const CameraRecord& camera) {
    out << "name" << camera.name << "image_width" << camera.lens.width << "image_height" << camera.lens.height;
    out << "orientation"
        << "upright";
    out << "camera_matrix" << camera_matrix(camera.lens) << "distortion_coefficients" << distortion_vector(camera.lens);
    if (camera.rms > 0) out << "reprojection_error" << camera.rms;
    if (camera.covariance) {
        cv::Mat deviations(1, int(intrinsic_count), CV_64F);
        std::vector<std::string> names(intrinsic_names().begin(), intrinsic_names().end());
        for (std::size_t i = 0; i < intrinsic_count; ++i)
            deviations.at<double>(int(i)) = camera.covariance->deviation(i);
        const int n = int(intrinsic_count);
        out << "intrinsic_names" << names << "intrinsic_deviations" << deviations;
        out << "intrinsic_covariance" << cv::Mat(n, n, CV_64F, const_cast<double*>(camera.covariance->values.data()));
    }
    if (camera.pose) write_pose(out, camera);
}

constexpr const char* explanation = "Lengths in metres, angles in radians, pixels with (0, 0) in the centre of the top "
                                    "left one. Pictures as displayed: turned "
                                    "as their container or EXIF says.\nX_camera = R X_scene + t with R from "
                                    "rotation_vector; camera axes x right, y down, z "
                                    "forward. pose_covariance: small rotation about the camera's axes, then t.";

} // namespace

scene::CameraModel CameraRecord::model() const {
    if (pose) return {name, lens, *pose};
    refuse(where, "the camera " + name + " has no pose", "it says how the lens draws, not where it stands in the scene",
        "find the pose with `treacle calibrate --camera FILE` and --points, --board-in-scene or --scene with "
        "--contour");
}

std::vector<CameraRecord> read_cameras(const fs::path& path) {
    if (is_colmap(path)) return read_colmap(path);
    std::ifstream file(path, std::ios::binary);
    if (!file || fs::is_directory(path))
        refuse(path.string(), "there is no such camera file", "",
            "give OpenCV's YAML or JSON, ViRheometry's camera_params.xml, or the folder of a COLMAP text model");
    const std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    return is_virheometry(content) ? read_virheometry(path, content) : read_storage(path, content);
}

CameraRecord read_camera(const fs::path& path, const std::string& name) {
    const auto cameras = read_cameras(path);
    std::vector<std::string> names;
    for (const auto& camera : cameras) {
        if (camera.name == name || (name.empty() && cameras.size() == 1)) return camera;
        names.push_back(camera.name);
    }
    refuse(path.string(), name.empty() ? "holds several cameras" : "holds no camera " + name,
        "there are " + join(names, ", "), "give the name of one of them");
}

namespace {

void write_list(cv::FileStorage& out, const std::vector<CameraRecord>& cameras) {
    out << "cameras"
        << "[";
    for (const auto& camera : cameras) {
        out << "{";
        write_one(out, camera);
        out << "}";
    }
    out << "]";
}

} // namespace

void write_cameras(const fs::path& path, const std::vector<CameraRecord>& cameras) {
    const auto extension = path.extension().string();
    if (extension != ".yaml" && extension != ".yml" && extension != ".json" && extension != ".xml")
        refuse(path.string(), "is no name for a camera file", "its extension chooses the format",
            "write .yaml, .json or .xml");
    cv::FileStorage out("camera" + extension, cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
    if (extension != ".json") out.writeComment(explanation);
    if (cameras.size() == 1) {
        write_one(out, cameras.front());
    } else {
        write_list(out, cameras);
    }
    write_file_atomically(path, out.releaseAndGetString());
}

CameraRecord for_pictures(const CameraRecord& camera, int width, int height, const std::string& where) {
    if (camera.lens.width == width && camera.lens.height == height) return camera;
    if (camera.any_size && camera.lens.width * height == camera.lens.height * width) {
        auto out = camera;
        out.lens = scene::resized(camera.lens, width, height);
        return out;
    }
    const auto text = [](int w, int h) { return std::to_string(w) + " x " + std::to_string(h) + " pixels"; };
    const bool turned = camera.lens.width == height && camera.lens.height == width;
    refuse(where,
        "has " + text(width, height) + ", but the camera " + camera.name + " of " + camera.where +
            " was calibrated for " + text(camera.lens.width, camera.lens.height),
        turned ? "one of them is turned by a quarter" : "a lens is calibrated for one size of picture and one zoom",
        "film the board and the experiment in the same mode of the camera, held the same way");
}

} // namespace treacle::video
