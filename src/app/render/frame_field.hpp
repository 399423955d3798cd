#pragma once
#include "io/frame.hpp"
#include "scene/scene.hpp"

#include <string>
#include <vector>

namespace treacle::app {

// One number per particle, from a field of a frame.
struct ScalarField {
    std::string title;          // "speed [m/s]"
    std::vector<double> values; // [n]
    bool magnitude = false;     // never negative: a length of a vector
};

// Names that scalar_field takes: fields with one component as they are; of a vector its components "velocity_x" and its
// magnitude "velocity"; "speed" for the magnitude of the velocity; "x", "y", "z".
std::vector<std::string> scalar_names(const io::Frame& frame);

// Throws InputError that lists the names when there is no such one.
ScalarField scalar_field(const io::Frame& frame, const std::string& name);

// Adds the mirror image of each row, for each plane in turn; `total` stays.
void add_images(io::Frame& frame, const std::vector<scene::MirrorPlane>& planes);

// A component of a field, and the field's unit in brackets: "velocity_x [m/s]", "role".
std::string with_unit_of(const std::string& name, const io::FrameColumn& column);

} // namespace treacle::app
