#include "identify/material/material.hpp"

#include "base/options/parse_some.hpp"
#include "base/text/error.hpp"
#include "scene/renamed_keys.hpp"

namespace treacle::identify {

namespace {
struct Materials {
    std::vector<Material> all;
    void declare(Declaration& d) {
        d.list("materials", all, "Liquids of which keys were identified, for `treacle run SCENE --material`.");
    }
};
} // namespace

void Material::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    d.text("name", name, "Of the liquid in the study's scenes.");
    d.required("name");
    d.number("density", density, unit::density, range_above(0), "Mass per volume.");
    d.required("density");
    d.number("viscosity", viscosity, unit::viscosity_of(density), range_at_least(0),
        "Dynamic viscosity of the rheology's law.");
    d.required("viscosity");
    d.number("surface_tension", surface_tension, unit::surface_tension, range_at_least(0), "Against air; 0: not told.");
    d.block("rheology", rheology, "How the viscosity depends on the shear rate.", "law");
    d.text("temperature", temperature, "At which it holds.");
    d.texts("found", found, "How it is known.");
    d.boolean("well_determined", well_determined, "Whether the films tell it.");
}

std::string yaml(const std::vector<Material>& materials) {
    return materials.empty() ? "" : effective(Materials{materials});
}

std::vector<Material> read_materials(const std::filesystem::path& path) {
    Materials out;
    auto document = Document::load(path);
    document.accept(scene::renamed_keys()); // of a study of an earlier version
    parse_some(document, [&](Declaration& d) { out.declare(d); });
    if (out.all.empty()) {
        throw InputError({path.string(), "has no materials",
            "in its study no key of a liquid was identified, or it is no result of `treacle identify`",
            "give report/result.yaml of a study whose parameters have keys such as liquids.honey.viscosity"});
    }
    return std::move(out.all);
}

} // namespace treacle::identify
