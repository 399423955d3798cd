#include "app/input/transfer.hpp"

#include "base/options/options.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <algorithm>

namespace treacle::app {

namespace {
struct Words {
    std::string liquid, file, name; // liquid and name may be empty
};

// The text before the first '=' and behind the last ':' is no part of the file's name, unless there is a file of that
// name.
Words read_words(const std::string& argument) {
    Words out{"", argument, ""};
    const auto is_there = [&] { return std::filesystem::exists(out.file); };
    if (const auto equals = out.file.find('='); equals != std::string::npos && !is_there()) {
        out.liquid = out.file.substr(0, equals);
        out.file = out.file.substr(equals + 1);
    }
    if (const auto colon = out.file.rfind(':'); colon != std::string::npos && !is_there()) {
        out.name = out.file.substr(colon + 1);
        out.file = out.file.substr(0, colon);
    }
    return out;
}

std::filesystem::path find_result(const std::string& name, const std::string& option) {
    std::filesystem::path path = name;
    if (std::filesystem::is_directory(path))
        path /= std::filesystem::exists(path / "report") ? "report/result.yaml" : "result.yaml";
    if (name.empty() || !std::filesystem::exists(path)) {
        throw InputError({option, "there is no file " + (name.empty() ? std::string("named") : path.string()),
            "materials come from a result of `treacle identify`", "give STUDY'S FOLDER/report/result.yaml"});
    }
    return std::filesystem::absolute(path).lexically_normal();
}

std::string choices(const std::vector<std::string>& names, const std::string& word) {
    const auto close = word.empty() ? std::nullopt : nearest(word, names);
    return close ? "did you mean " + *close + "?" : "it has " + join(names, ", ");
}

identify::Material pick_material(const std::filesystem::path& file, const Words& words) {
    auto all = identify::read_materials(file);
    std::vector<std::string> names;
    names.reserve(all.size());
    for (const auto& one : all) names.push_back(one.name);
    if (words.name.empty() && all.size() == 1) return std::move(all.front());
    const auto found = std::ranges::find(names, words.name);
    if (found != names.end()) return std::move(all[std::size_t(found - names.begin())]);
    if (words.name.empty()) {
        throw InputError({all[1].where, "it is not said which of its liquids is meant", choices(names, ""),
            "write --material " + words.file + ":" + names.front()});
    }
    throw InputError({all.front().where, "there is no material " + words.name, "", choices(names, words.name)});
}

std::size_t pick_liquid(const scene::Scene& scene, const std::filesystem::path& scene_file, const Words& words) {
    std::vector<std::string> names;
    for (const auto& one : scene.liquids) names.push_back(one.name);
    if (names.empty())
        throw InputError({scene_file.string(), "has no liquid", "a material goes into one", "leave --material out"});
    if (words.liquid.empty() && names.size() == 1) return 0;
    const auto found = std::ranges::find(names, words.liquid);
    if (found != names.end()) return std::size_t(found - names.begin());
    if (words.liquid.empty()) {
        throw InputError({scene.liquids[1].where, "it is not said into which liquid the material goes",
            choices(names, ""), "write --material " + names.front() + "=" + words.file});
    }
    throw InputError(
        {scene.liquids.front().where, "there is no liquid " + words.liquid, "", choices(names, words.liquid)});
}

std::string origin_of(const Transfer& one) { return "--material " + one.argument; }

bool same(const scene::Liquid& liquid, const identify::Material& material) {
    return liquid.density == material.density && liquid.viscosity == material.viscosity &&
           effective(liquid.rheology) == effective(material.rheology) &&
           (material.surface_tension == 0 || liquid.surface_tension == material.surface_tension);
}
} // namespace

std::vector<Transfer> find_transfers(
    const std::vector<std::string>& arguments, const scene::Scene& scene, const std::filesystem::path& scene_file) {
    std::vector<Transfer> out;
    for (const auto& argument : arguments) {
        const auto words = read_words(argument);
        Transfer one;
        one.argument = argument;
        one.file = find_result(words.file, "--material " + argument);
        one.material = pick_material(one.file, words);
        one.index = pick_liquid(scene, scene_file, words);
        const auto& liquid = scene.liquids[one.index];
        one.liquid = liquid.name;
        for (const auto& other : out) {
            if (other.index != one.index) continue;
            throw InputError({origin_of(one), "the liquid " + one.liquid + " has a material already",
                "by " + origin_of(other), "leave one of them out"});
        }
        const char* own = !liquid.viscosity_profile.points.empty() ? "viscosity_profile"
                          : !liquid.viscosity_regions.empty()      ? "viscosity_regions"
                                                                   : nullptr;
        if (own)
            throw InputError({liquid.where,
                "liquids." + liquid.name + "." + own + " would count in the place of the material's viscosity",
                "by " + origin_of(one), "remove it, or name another liquid"});
        out.push_back(std::move(one));
    }
    return out;
}

void put_material(const Transfer& transfer, Document& document) {
    const auto& material = transfer.material;
    const auto set = [&](const std::string& key, const std::string& value) {
        document.set("liquids." + std::to_string(transfer.index) + "." + key + "=" + value, origin_of(transfer));
    };
    set("density", format_number(material.density));
    set("viscosity", format_number(material.viscosity));
    set("rheology", effective(material.rheology));
    if (material.surface_tension > 0) set("surface_tension", format_number(material.surface_tension));
}

std::vector<std::string> doubts(const Transfer& transfer, const scene::Liquid& liquid) {
    std::vector<std::string> out;
    if (!transfer.material.well_determined) {
        out.push_back("liquids." + transfer.liquid + ": " + transfer.file.string() +
                      " does not tell it well: " + join(transfer.material.found, "; "));
    }
    if (!same(liquid, transfer.material))
        out.push_back(
            "liquids." + transfer.liquid + ": is not as " + transfer.file.string() + " has it, since --set changes it");
    return out;
}

std::vector<std::string> describe(const Transfer& transfer) {
    std::vector<std::string> out{transfer.material.name + " of " + transfer.file.string()};
    out.insert(out.end(), transfer.material.found.begin(), transfer.material.found.end());
    out.push_back("temperature " +
                  (transfer.material.temperature.empty() ? std::string("not stated") : transfer.material.temperature));
    return out;
}

io::Value record(const std::vector<Transfer>& transfers) {
    io::Value out = io::Value::list({});
    for (const auto& one : transfers) {
        io::Value found = io::Value::list({});
        for (const auto& sentence : one.material.found) found.add(sentence);
        const auto& material = one.material;
        out.add(io::Value::object({{"liquid", one.liquid}, {"file", one.file.string()}, {"material", material.name},
            {"density [kg/m3]", material.density}, {"viscosity [Pa.s]", material.viscosity},
            {"temperature", material.temperature.empty() ? io::Value() : io::Value(material.temperature)},
            {"found", std::move(found)}}));
    }
    return out;
}

} // namespace treacle::app
