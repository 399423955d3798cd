#pragma once
#include "scene/scene.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace treacle::identify {

// An identified liquid, for other scenes: what it is made of, and how that is known.
struct Material {
    std::string name;           // of the liquid in the study's scenes
    double density = 0;         // [kg/m3]
    double viscosity = 0;       // [Pa s] of the rheology's law
    double surface_tension = 0; // [N/m]; 0: the study's scenes have none, and that of another scene stays
    scene::Rheology rheology;
    std::string temperature; // "22.5 C +- 0.5 C"; empty: not stated
    std::vector<std::string>
        found; // sentences: identified values with their intervals, how well they are known, the flow's shear rates
    bool well_determined = true; // all of these values
    std::string where;           // "result.yaml:31"

    // Keys of an item of `materials`.
    void declare(Declaration& d);
};

// The list `materials` of a result.yaml.
std::string yaml(const std::vector<Material>& materials);

// Reads it back, whatever else stands in the file. Throws InputError, also for a file without materials.
std::vector<Material> read_materials(const std::filesystem::path& path);

} // namespace treacle::identify
