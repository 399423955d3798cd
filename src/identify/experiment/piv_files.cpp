#include "identify/experiment/piv_files.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "io/hdf5/mat_file.hpp"

#include <cmath>

namespace treacle::identify {

namespace {
using Arrays = std::map<std::string, io::MatArray>;

const io::MatArray& array(
    const Arrays& arrays, const std::filesystem::path& path, const std::string& name, std::size_t size) {
    const auto found = arrays.find(name);
    if (found == arrays.end()) {
        std::vector<std::string> names;
        for (const auto& [known, values] : arrays) names.push_back(known);
        throw InputError({path.string(), "has no array " + name, "it holds " + shorten(join(names, ", ")),
            "save the session of PIVlab, or a frame, with -v7.3"});
    }
    if (size > 0 && found->second.values.size() != size) {
        throw InputError({path.string(), name + " has " + std::to_string(found->second.values.size()) + " values",
            "the places have " + std::to_string(size), "the file may be damaged"});
    }
    return found->second;
}

double number(const Arrays& arrays, const std::string& name) {
    const auto found = arrays.find(name);
    return found == arrays.end() || found->second.values.size() != 1 ? 1 : found->second.values.front();
}

video::PivField frame_of(const Arrays& arrays, const std::filesystem::path& path, const std::string& suffix) {
    video::PivField out;
    out.format = "PIVlab";
    const auto& x = array(arrays, path, "x" + suffix, 0);
    const auto size = x.values.size();
    out.x = x.values;
    out.y = array(arrays, path, "y" + suffix, size).values;
    out.u = array(arrays, path, "u" + suffix, size).values;
    out.v = array(arrays, path, "v" + suffix, size).values;
    const auto type = arrays.find("typevector" + suffix);
    for (std::size_t i = 0; i < size; ++i) {
        const bool measured = type == arrays.end() || (i < type->second.values.size() && type->second.values[i] == 1);
        out.valid.push_back(measured && std::isfinite(out.u[i]) && std::isfinite(out.v[i]) ? 1 : 0);
    }
    const double length = number(arrays, "calxy"), speed = number(arrays, "caluv");
    const bool calibrated = length != 1 || speed != 1;
    out.length_unit = calibrated ? "m" : "px";
    out.velocity_unit = calibrated ? "m/s" : "px/frame";
    if (!calibrated) return out;
    for (auto* list : {&out.x, &out.y}) {
        for (auto& value : *list) value *= length;
    }
    for (auto* list : {&out.u, &out.v}) {
        for (auto& value : *list) value *= speed;
    }
    return out;
}
} // namespace

std::vector<video::PivField> read_piv(const std::filesystem::path& path) {
    if (!std::filesystem::is_regular_file(path)) throw InputError({path.string(), "is no file", "", "check its name"});
    if (!io::is_hdf5(path)) return {video::read_piv_text(path)};
    const auto arrays = io::read_mat(path);
    std::vector<video::PivField> out;
    for (int k = 0; arrays.contains("x_" + std::to_string(k)); ++k)
        out.push_back(frame_of(arrays, path, "_" + std::to_string(k)));
    if (out.empty()) out.push_back(frame_of(arrays, path, ""));
    return out;
}

} // namespace treacle::identify
