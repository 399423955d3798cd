#pragma once
#include "identify/answer/identification.hpp"
#include "identify/material/flow_curve_band.hpp"
#include "identify/material/material.hpp"

namespace treacle::app {

// Names of the liquids of which a key is searched.
std::vector<std::string> searched_liquids(const identify::StudyFile& file);

// A liquid at given values of the searched parameters, in the study's first scene that has it; nothing where none has. Throws InputError.
std::optional<scene::Liquid> liquid_at(
    const identify::StudyFile& file, const std::string& liquid, const std::vector<double>& searched);

// The searched liquids as they were identified; none where nothing was. `curves`: of the shear rates that the flow had. Throws InputError.
std::vector<identify::Material> identified_materials(const identify::StudyFile& file,
    const identify::Identification& found, const std::vector<identify::FlowCurveBand>& curves);

} // namespace treacle::app
