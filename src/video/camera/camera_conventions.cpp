#include "video/camera/camera_conventions.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

namespace treacle::video {

namespace fs = std::filesystem;

namespace {

constexpr double centimetre = 0.01;

[[noreturn]] void refuse(
    const std::string& where, const std::string& problem, const std::string& reason, const std::string& cure) {
    throw InputError({where, problem, reason, cure});
}

// Value of attribute="..." in an XML text; empty without it.
std::string attribute(const std::string& content, const std::string& name) {
    const auto at = content.find(" " + name + "=\"");
    if (at == std::string::npos) return "";
    const auto begin = at + name.size() + 3;
    return content.substr(begin, content.find('"', begin) - begin);
}

std::vector<double> numbers(
    const std::string& where, const std::string& content, const std::string& name, std::size_t count) {
    std::istringstream text(attribute(content, name));
    std::vector<double> out;
    std::string word;
    while (text >> word) {
        const auto value = read_number(word);
        if (!value || !std::isfinite(*value))
            refuse(where, name + "=\"" + attribute(content, name) + "\" has no number " + word, "", "");
        out.push_back(*value);
    }
    if (out.size() != count)
        refuse(where,
            "attribute " + name + " of <camera> has " + std::to_string(out.size()) + " numbers, not " +
                std::to_string(count),
            "",
            "write for instance eyepos=\"9.8 13.7 26.9\" quat=\"0.97 -0.26 0 0\" window_size=\"960 540\" fov=\"36.2\"");
    return out;
}

struct ColmapModel {
    const char* name;
    std::size_t parameters;
    // Places of the parameters in fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6; one focal length counts for both.
    bool one_focal_length;
    std::vector<std::size_t> distortion; // places in Lens::distortion
};

const std::vector<ColmapModel>& colmap_models() {
    static const std::vector<ColmapModel> models{{"SIMPLE_PINHOLE", 3, true, {}}, {"PINHOLE", 4, false, {}},
        {"SIMPLE_RADIAL", 4, true, {0}}, {"RADIAL", 5, true, {0, 1}}, {"OPENCV", 8, false, {0, 1, 2, 3}},
        {"FULL_OPENCV", 12, false, {0, 1, 2, 3, 4, 5, 6, 7}}};
    return models;
}

// A line that is not a comment, with its number.
bool next_line(std::istream& file, std::string& line, int& number) {
    while (std::getline(file, line)) {
        ++number;
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (!line.empty() && line.front() != '#') return true;
    }
    return false;
}

scene::Lens colmap_lens(std::istringstream& words, const std::string& where) {
    std::string name;
    scene::Lens lens;
    std::vector<double> values;
    words >> name >> lens.width >> lens.height;
    for (double value; words >> value;) values.push_back(value);
    for (const auto& model : colmap_models()) {
        if (name != model.name) continue;
        if (values.size() != model.parameters)
            refuse(where,
                name + " has " + std::to_string(values.size()) + " parameters, not " + std::to_string(model.parameters),
                "", "export the model anew with colmap model_converter --output_type TXT");
        std::size_t next = 0;
        lens.fx = values[next++];
        lens.fy = model.one_focal_length ? lens.fx : values[next++];
        lens.cx = values[next++] - scene::pixel_corner_offset;
        lens.cy = values[next++] - scene::pixel_corner_offset;
        for (const auto index : model.distortion) lens.distortion[index] = values[next++];
        return lens;
    }
    std::vector<std::string> known;
    for (const auto& model : colmap_models()) known.emplace_back(model.name);
    refuse(where, "camera model " + name + " is not known", "known are " + join(known, ", "),
        "reconstruct with --ImageReader.camera_model OPENCV");
}

std::ifstream open(const fs::path& path, const std::string& reason) {
    std::ifstream file(path);
    if (!file)
        refuse(
            path.string(), "cannot be read", reason, "export the model with colmap model_converter --output_type TXT");
    return file;
}

} // namespace

scene::Matrix3 matrix_of(const std::array<double, 4>& q) {
    const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double w = q[0] / n, x = q[1] / n, y = q[2] / n, z = q[3] / n;
    return {Vec3{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
        Vec3{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
        Vec3{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
}

scene::Lens lens_of(const OpenGlCamera& camera) {
    const double f = 0.5 * camera.height / std::tan(0.5 * camera.vertical_field_of_view);
    return {camera.width, camera.height, f, f, 0.5 * camera.width - scene::pixel_corner_offset,
        0.5 * camera.height - scene::pixel_corner_offset, {}};
}

scene::CameraPose pose_of(const OpenGlCamera& camera) {
    // OpenGL's y and z axes are turned round.
    scene::Matrix3 rotation = scene::transposed(matrix_of(camera.quaternion));
    for (const std::size_t row : {1, 2})
        for (double& v : rotation[row]) v = -v;
    const Vec3 t = scene::apply(rotation, camera.eye);
    return {rotation, {-t[0], -t[1], -t[2]}};
}

bool is_virheometry(const std::string& content) {
    return content.find("<setup3D") != std::string::npos && content.find("<camera ") != std::string::npos;
}

std::vector<CameraRecord> read_virheometry(const fs::path& path, const std::string& content) {
    const auto where = path.string();
    const auto eye = numbers(where, content, "eyepos", 3), q = numbers(where, content, "quat", 4),
               size = numbers(where, content, "window_size", 2), angle = numbers(where, content, "fov", 1);
    OpenGlCamera camera;
    for (std::size_t i = 0; i < 3; ++i) camera.eye[i] = centimetre * eye[i];
    for (std::size_t i = 0; i < 4; ++i) camera.quaternion[i] = q[i];
    camera.width = int(size[0]);
    camera.height = int(size[1]);
    if (!(angle[0] > 0 && angle[0] < 180))
        refuse(where, "fov=\"" + format_number(angle[0]) + "\": must be between 0 and 180 degrees", "", "");
    camera.vertical_field_of_view = angle[0] * std::numbers::pi / 180;
    CameraRecord record;
    record.name = "main";
    record.lens = lens_of(camera);
    record.pose = pose_of(camera);
    record.where = where;
    record.any_size = true;
    return {record};
}

bool is_colmap(const fs::path& path) {
    return fs::is_directory(path) ? fs::exists(path / "cameras.txt") : path.filename() == "cameras.txt";
}

std::vector<CameraRecord> read_colmap(const fs::path& path) {
    const fs::path folder = fs::is_directory(path) ? path : path.parent_path();
    const fs::path cameras = folder / "cameras.txt", images = folder / "images.txt";
    std::map<int, scene::Lens> lenses;
    std::string line;
    int number = 0;
    auto file = open(cameras, "");
    while (next_line(file, line, number)) {
        std::istringstream words(line);
        int id = 0;
        words >> id;
        lenses[id] = colmap_lens(words, cameras.string() + ":" + std::to_string(number));
    }
    std::vector<CameraRecord> out;
    number = 0;
    auto list = open(images, "the poses stand in it");
    while (next_line(list, line, number)) {
        const auto where = images.string() + ":" + std::to_string(number);
        std::istringstream words(line);
        int image = 0, camera = 0;
        std::array<double, 4> q{};
        Vec3 t{};
        CameraRecord record;
        words >> image >> q[0] >> q[1] >> q[2] >> q[3] >> t[0] >> t[1] >> t[2] >> camera;
        std::getline(words >> std::ws, record.name);
        if (!words)
            refuse(where, "is no image of a COLMAP model", "",
                "a line holds IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME");
        if (!lenses.contains(camera))
            refuse(where, "camera " + std::to_string(camera) + " does not stand in cameras.txt", "",
                "export both files together");
        record.lens = lenses[camera];
        record.pose = scene::CameraPose{matrix_of(q), t};
        record.where = where;
        out.push_back(record);
        std::getline(list, line); // its points, possibly none
        ++number;
    }
    if (out.empty())
        refuse(images.string(), "holds no image", "", "export a reconstruction that has registered images");
    return out;
}

} // namespace treacle::video
