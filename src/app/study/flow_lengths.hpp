#pragma once
#include "app/input/input.hpp"
#include "app/study/measured_fractions.hpp"

namespace treacle::app {

// Narrow passage of a scene's flow, on which surface tension or the spacing may have an effect.
struct FlowLength {
    std::string name;  // "hole of container"
    double length = 0; // [m] radius of a hole or thread, thickness of a layer: that of the Bond number
    double across = 0; // [m] diameter or thickness: what the cells must resolve
};

// Holes: round parts taken out of bodies that reach through them, the narrowest of each body. Threads: what comes out of a hole or inlet, as thin as
// free fall to the lower side of the domain makes it; a viscous thread stays thicker. Layers: the liquid's height at the start, and at the end of
// the run by Huppert's spreading (1982) of all of it over a floor, unless there is a hole or a wall.
std::vector<FlowLength> flow_lengths(const Input& input);

// Lines of `treacle check STUDY`: capillary length, Bond numbers density g L^2 / surface tension, cells across; those with a
// Bond number below 10 or fewer than 4 cells are warned of. Without a surface tension in the scene that of many liquids is taken.
std::vector<LabelledLine> flow_length_lines(const Input& input);

} // namespace treacle::app
