#include "app/identify/identified_liquids.hpp"

#include "app/study/study_scenes.hpp"
#include "base/text/split.hpp"
#include "base/text/text.hpp"
#include "identify/report/report.hpp"

#include <algorithm>

namespace treacle::app {

namespace {
// The liquid that a parameter changes; empty: none.
std::string liquid_of(const study::Parameter& parameter) {
    const auto parts = split(parameter.key, '.');
    return parts.size() < 3 || parts[0] != "liquids" ? "" : parts[1];
}
} // namespace

std::vector<std::string> searched_liquids(const identify::StudyFile& file) {
    std::vector<std::string> out;
    for (std::size_t k = 0; k < file.searched; ++k) {
        const auto liquid = liquid_of(file.study.parameters[k]);
        if (!liquid.empty() && std::ranges::find(out, liquid) == out.end()) out.push_back(liquid);
    }
    return out;
}

std::optional<scene::Liquid> liquid_at(
    const identify::StudyFile& file, const std::string& liquid, const std::vector<double>& searched) {
    study::Point words;
    for (std::size_t k = 0; k < file.study.parameters.size(); ++k) {
        const auto& parameter = file.study.parameters[k];
        words.push_back(k < searched.size() ? parameter.word(searched[k]) : parameter.values.front());
    }
    for (const auto& scene : file.study.scenes) {
        const auto input =
            load_scene(source_of(file.study.scene_file(scene), study::assignments_of(file.study, scene, words)));
        const auto& liquids = input.scene.liquids;
        const auto found = std::ranges::find(liquids, liquid, &scene::Liquid::name);
        if (found != liquids.end()) return *found;
        const auto number = read_number(liquid); // a key may name it by its place
        if (number && *number >= 0 && *number < double(liquids.size())) return liquids[std::size_t(*number)];
    }
    return {};
}

std::vector<identify::Material> identified_materials(const identify::StudyFile& file,
    const identify::Identification& found, const std::vector<identify::FlowCurveBand>& curves) {
    std::vector<identify::Material> out;
    if (!found.estimate) return out;
    const auto answers = identify::answer_lines(file, found);
    for (const auto& name : searched_liquids(file)) {
        const auto liquid = liquid_at(file, name, found.values);
        if (!liquid) continue;
        identify::Material material;
        material.name = liquid->name;
        material.density = liquid->density;
        material.viscosity = liquid->viscosity;
        material.surface_tension = liquid->surface_tension;
        material.rheology = liquid->rheology;
        if (file.temperature.stated()) material.temperature = file.temperature.text();
        for (std::size_t k = 0; k < file.searched; ++k) {
            if (liquid_of(file.study.parameters[k]) != name) continue;
            const auto how = identify::identifiability(file, found, k);
            material.found.push_back(answers[k] + ", " + how);
            material.well_determined = material.well_determined && how == identify::well_determined;
        }
        for (const auto& curve : curves) {
            if (curve.liquid == name && !curve.flow.empty())
                material.found.push_back(identify::describe(curve).front());
        }
        out.push_back(std::move(material));
    }
    return out;
}

} // namespace treacle::app
