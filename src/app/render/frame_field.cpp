#include "app/render/frame_field.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "surface/mesh/mirror.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

namespace {

constexpr const char* axis_names[3] = {"x", "y", "z"};

std::string component_name(const io::FrameColumn& column, int component) {
    return column.name + "_" + (column.components == 3 ? axis_names[component] : std::to_string(component));
}

std::vector<double> component(const io::FrameColumn& column, int offset) {
    return std::visit(
        [&](const auto& values) {
            std::vector<double> out;
            const auto stride = static_cast<std::size_t>(column.components);
            out.reserve(values.size() / stride);
            for (auto i = static_cast<std::size_t>(offset); i < values.size(); i += stride) {
                out.push_back(static_cast<double>(values[i]));
            }
            return out;
        },
        column.values);
}

std::vector<double> magnitude(const io::FrameColumn& column) {
    std::vector<double> out = component(column, 0);
    for (auto& value : out) value *= value;
    for (int k = 1; k < column.components; ++k) {
        const auto more = component(column, k);
        for (std::size_t i = 0; i < out.size(); ++i) out[i] += more[i] * more[i];
    }
    for (auto& value : out) value = std::sqrt(value);
    return out;
}

std::vector<double> coordinates(const io::Frame& frame, std::size_t axis) {
    std::vector<double> out;
    for (std::size_t i = axis; i < frame.positions.size(); i += 3) out.push_back(frame.positions[i]);
    return out;
}

} // namespace

std::string with_unit_of(const std::string& name, const io::FrameColumn& column) {
    const bool plain = column.unit.empty() || column.unit == "1";
    return plain ? name : name + " [" + column.unit + "]";
}

std::vector<std::string> scalar_names(const io::Frame& frame) {
    std::vector<std::string> names;
    if (frame.find("velocity")) names.emplace_back("speed");
    for (const auto& column : frame.fields) {
        names.push_back(column.name);
        for (int k = 0; column.components > 1 && k < column.components; ++k) {
            names.push_back(component_name(column, k));
        }
    }
    names.insert(names.end(), axis_names, axis_names + 3);
    return names;
}

ScalarField scalar_field(const io::Frame& frame, const std::string& name) {
    for (const auto& column : frame.fields) {
        const bool speed = name == "speed" && column.name == "velocity";
        if (column.name == name || speed) {
            if (column.components == 1) return {with_unit_of(name, column), component(column, 0), false};
            return {with_unit_of(name, column), magnitude(column), true};
        }
        for (int k = 0; column.components > 1 && k < column.components; ++k) {
            if (component_name(column, k) == name) return {with_unit_of(name, column), component(column, k), false};
        }
    }
    for (std::size_t k = 0; k < 3; ++k) {
        if (name == axis_names[k]) return {name + " [m]", coordinates(frame, k), false};
    }
    const auto names = scalar_names(frame);
    const auto close = nearest(name, names);
    throw InputError({"--field " + name,
        "there is no such field in the frames" + (close ? "; did you mean " + *close + "?" : std::string()),
        "they hold " + join(names, ", "), "output.fields of the scene says what a run writes"});
}

void add_images(io::Frame& frame, const std::vector<scene::MirrorPlane>& planes) {
    for (const auto& plane : planes) {
        surface::add_image(frame.positions, plane.axis, 2 * plane.position);
        for (auto& column : frame.fields) {
            auto* reals = std::get_if<std::vector<double>>(&column.values);
            if (reals && column.components == 3)
                surface::add_image(*reals, plane.axis, 0);
            else
                std::visit([](auto& values) { surface::add_image(values); }, column.values);
        }
    }
}

} // namespace treacle::app
