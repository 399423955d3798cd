#pragma once
#include "base/options/document.hpp"
#include "identify/material/material.hpp"
#include "io/value.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace treacle::app {

// An identified material on its way into a liquid of a scene.
struct Transfer {
    std::size_t index = 0; // of the liquid
    std::string liquid;    // its name
    std::string argument;  // of --material
    std::filesystem::path file;
    identify::Material material;
};

// Meaning of the values of --material for a scene: "FILE", "FILE:NAME" (of several liquids in the file), "LIQUID=FILE"
// (of several in the scene), "LIQUID=FILE:NAME". The file may be given by the folder of its study or report. Throws
// InputError.
std::vector<Transfer> find_transfers(
    const std::vector<std::string>& arguments, const scene::Scene& scene, const std::filesystem::path& scene_file);

// Sets density, viscosity, rheology and, where it is known, surface tension of the liquid.
void put_material(const Transfer& transfer, Document& document);

// Sentences: that the films determine the material poorly, or that the liquid has become another one by other options.
std::vector<std::string> doubts(const Transfer& transfer, const scene::Liquid& liquid);

// Lines for people: the file, the temperature, how each value is known.
std::vector<std::string> describe(const Transfer& transfer);
// For manifest.json, a list.
io::Value record(const std::vector<Transfer>& transfers);

} // namespace treacle::app
