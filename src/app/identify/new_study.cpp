#include "app/identify/new_study.hpp"

#include "app/identify/study_templates.hpp"
#include "app/input/folder_under_way.hpp"
#include "base/text/file.hpp"
#include "base/text/text.hpp"
#include "base/text/units.hpp"
#include "identify/material/first_guess.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>

namespace treacle::app {

namespace {
constexpr double range_factor = 30; // of the search, to either side of the first guess

constexpr std::array sights{
    SightOption{"viscosity", "First guess, in the place of a formula", "VISCOSITY"},
    SightOption{"front",
        "How far the liquid had come: from the wall behind it, from the middle of a cylinder, from the block's upper "
        "edge on a slope",
        "LENGTH"},
    SightOption{"at", "Time from the start at which --front, --fallen or --drained was seen", "TIME"},
    SightOption{"fallen", "How far a ball had fallen", "LENGTH"},
    SightOption{"drained", "Volume that had run out of a hole or nozzle", "VOLUME"},
    SightOption{"cup", "Standard cup: ford2 to ford5, zahn1 to zahn5", "NAME"},
    SightOption{"efflux", "Time in which that cup ran out", "TIME"},
    SightOption{"thickness", "Of an even film on the slope", "LENGTH"},
    SightOption{"speed", "Of that film's surface", "SPEED"},
};

const Unit& unit_of_sight(const std::string& name) {
    if (name == "viscosity") return unit::viscosity;
    if (name == "at" || name == "efflux") return unit::time;
    if (name == "drained") return unit::volume;
    return name == "speed" ? unit::velocity : unit::length;
}

std::string digits(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return format_number(read_number(text).value_or(value));
}

double read_in(const std::string& where, const std::string& text, const Unit& unit) {
    const auto read = read_quantity(text, unit);
    if (const auto* complaint = std::get_if<Complaint>(&read))
        throw InputError({where, complaint->must, complaint->reason, complaint->cure});
    return std::get<double>(read);
}

// A line of the form in a study file: where the text of its value and of its plus_minus stand.
struct FormLine {
    std::string name;
    std::size_t value = 0, value_end = 0, deviation = 0, deviation_end = 0;
};

std::vector<FormLine> form_of(const std::string& study) {
    std::vector<FormLine> out;
    const auto end = study.find("experiments:");
    for (auto at = study.find("measured:"); (at = study.find("- {name: ", at)) < end;) {
        FormLine line;
        at += 9;
        line.name = study.substr(at, study.find(',', at) - at);
        line.value = study.find("value: ", at) + 7;
        line.value_end = study.find(',', line.value);
        line.deviation = study.find("plus_minus: ", line.value) + 12;
        line.deviation_end = study.find_first_of(",}", line.deviation);
        out.push_back(line);
    }
    return out;
}

// Unit of which a value of a template's form is.
const Unit& unit_of(const std::string& value) {
    for (const auto* unit : {&unit::length, &unit::density, &unit::angle, &unit::velocity, &unit::surface_tension}) {
        if (std::holds_alternative<double>(read_quantity(value, *unit))) return *unit;
    }
    return unit::none;
}

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(' ');
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

// Writes "length=7 cm +- 0.05 cm" into the form.
void fill_in(std::string& study, const std::string& entry, const std::string& command) {
    const auto where = command + " --set \"" + entry + "\"";
    const auto equals = entry.find('=');
    const auto name = trimmed(entry.substr(0, equals));
    std::vector<std::string> names;
    for (const auto& line : form_of(study)) names.push_back(line.name);
    const auto at = std::ranges::find(names, name);
    if (equals == std::string::npos || at == names.end()) {
        const auto close = nearest(name, names);
        throw InputError(
            {where, "is not of the form NAME=VALUE with a name of its form", "there are " + join(names, ", "),
                close && *close != name ? "did you mean " + *close + "?"
                                        : "write for instance --set \"" + names.back() + "=7 cm +- 0.05 cm\""});
    }
    const auto line = form_of(study)[std::size_t(at - names.begin())];
    const auto& unit = unit_of(study.substr(line.value, line.value_end - line.value));
    const auto mark = entry.find("+-", equals);
    const auto value = trimmed(entry.substr(equals + 1, mark == std::string::npos ? mark : mark - equals - 1));
    read_in(where, value, unit);
    const auto unit_text = [](const std::string& text) {
        return text.substr(
            std::min(text.size(), text.find_first_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ")));
    };
    const auto deviation = mark == std::string::npos ? study.substr(line.deviation, line.deviation_end - line.deviation)
                                                     : trimmed(entry.substr(mark + 2));
    read_in(where, deviation, unit);
    if (unit_text(deviation) != unit_text(value)) {
        throw InputError({where, "has another unit than its uncertainty, " + deviation, "",
            "write both, in one unit: \"" + name + "=7 cm +- 0.05 cm\""});
    }
    study.replace(line.deviation, line.deviation_end - line.deviation, deviation);
    study.replace(line.value, line.value_end - line.value, value);
}

FormValues values_of(const std::string& study, const NewStudyRequest& request, const std::string& command) {
    FormValues out;
    for (const auto& line : form_of(study)) {
        const auto text = study.substr(line.value, line.value_end - line.value);
        out[line.name] = read_in(command, text, unit_of(text));
    }
    for (const auto& [name, text] : request.sight) {
        const auto where = command + " --" + name + " " + text;
        if (name == "cup") continue;
        const double value = read_in(where, text, unit_of_sight(name));
        if (!(value > 0)) throw InputError({where, "must be > 0", "", ""});
        out[name] = value;
    }
    // The cup's time becomes its kinematic viscosity.
    if (const auto cup = request.sight.find("cup"), time = request.sight.find("efflux");
        cup != request.sight.end() && time != request.sight.end()) {
        const auto nu = identify::efflux_viscosity(cup->second, out.at("efflux"));
        if (!nu)
            throw InputError({command + " --cup " + cup->second + " --efflux " + time->second,
                "is no cup, or a time for which it has no formula",
                "thin liquids run out in the time that its formula takes off",
                "there are ford2 to ford5 and zahn1 to zahn5"});
        out["efflux"] = *nu;
    }
    return out;
}

std::string takes(const FirstGuess& guess) {
    std::string out;
    for (const auto& option : guess.takes) out += (out.empty() ? "--" : " --") + option;
    return out;
}

struct Guessed {
    double viscosity = 0; // [Pa s]
    std::string source;
};

std::optional<Guessed> guess(
    const StudyTemplate& chosen, const std::string& study, const NewStudyRequest& request, const std::string& command) {
    const auto values = values_of(study, request, command);
    if (request.sight.contains("viscosity")) return Guessed{values.at("viscosity"), "as told"};
    if (request.sight.empty()) return {};
    std::vector<std::string> known;
    for (const auto& one : chosen.guesses) {
        known.push_back(takes(one));
        const auto used = [&](const auto& sight) {
            return std::ranges::find(one.takes, sight.first) != one.takes.end();
        };
        if (request.sight.size() == one.takes.size() && std::ranges::all_of(request.sight, used))
            return Guessed{one.viscosity(values), one.source};
    }
    throw InputError({command + " --" + request.sight.begin()->first, "gives no first guess with what is beside it",
        "the formulas of this experiment take " + join(known, ", or "), "give those, or --viscosity"});
}

void replace_after(std::string& text, const std::string& before, const std::string& until, const std::string& value) {
    const auto at = text.find(before) + before.size();
    text.replace(at, text.find(until, at) - at, value);
}

void write_guess(std::string& study, std::string& scene, const Guessed& guessed, double seen_at) {
    const auto word = [](double value) { return digits(value) + " Pa.s"; };
    replace_after(
        study, "range: [", "]", word(guessed.viscosity / range_factor) + ", " + word(guessed.viscosity * range_factor));
    replace_after(study, "start: ", ",", word(guessed.viscosity));
    replace_after(scene, "viscosity: ", "\n", word(guessed.viscosity));
    if (seen_at == 0) return;
    // The film goes on at least until the front was where it was seen.
    replace_after(scene, "time: {end: ", "}", digits(seen_at) + " s");
    replace_after(study, ", from: ", ",", digits(seen_at / 10) + " s");
    replace_after(study, ", to: ", ",", digits(seen_at) + " s");
}

void list_templates() {
    std::printf(
        "treacle new TEMPLATE DIR writes a study with its scene, a form of what to measure, and how to film:\n");
    for (const auto& one : study_templates()) {
        const auto study = std::string(template_text(one.name + "/study.yaml"));
        std::printf("  %-16s %s\n", one.name.c_str(), study.substr(2, study.find('\n') - 2).c_str());
        for (const auto& guess : one.guesses)
            std::printf("  %-16s   first guess: %s (%s)\n", "", takes(guess).c_str(), guess.source.c_str());
    }
    std::printf("\n%s", std::string(template_text("little.txt")).c_str());
}

const StudyTemplate& find_template(const std::string& name) {
    std::vector<std::string> names;
    for (const auto& one : study_templates()) {
        if (one.name == name) return one;
        names.push_back(one.name);
    }
    const auto close = nearest(name, names);
    throw InputError({"treacle new", "there is no template " + name, "there are " + join(names, ", "),
        close ? "did you mean " + *close + "?" : "`treacle new` describes them"});
}
} // namespace

std::span<const SightOption> sight_options() { return sights; }

ExitCode new_study(const NewStudyRequest& request) {
    if (request.name.empty()) {
        list_templates();
        return ExitCode::ok;
    }
    const auto& chosen = find_template(request.name);
    const auto command = "treacle new " + chosen.name;
    if (request.folder.empty())
        throw InputError({command, "needs a folder", "the study is written into it", "write " + command + " my_study"});
    std::error_code ignored;
    if (std::filesystem::exists(request.folder) && !std::filesystem::is_empty(request.folder, ignored)) {
        throw InputError(
            {request.folder.string(), "exists and is not empty", "nothing is overwritten", "choose another folder"});
    }
    auto study = std::string(template_text(chosen.name + "/study.yaml")),
         scene = std::string(template_text(chosen.name + "/scene.yaml"));
    for (const auto& entry : request.form) fill_in(study, entry, command);
    const auto guessed = guess(chosen, study, request, command);
    if (guessed)
        write_guess(study, scene, *guessed,
            request.sight.contains("at") ? read_in(command, request.sight.at("at"), unit::time) : 0);
    FolderUnderWay folder(request.folder, ExistingFolder::refuse);
    write_file_atomically(folder.path() / "study.yaml", study);
    write_file_atomically(folder.path() / "scene.yaml", scene);
    write_file_atomically(folder.path() / "FILMING.md",
        std::string(template_text(chosen.name + "/filming.md")) + std::string(template_text("FILMING.md")));
    folder.finish();
    const auto files = request.folder.string();
    std::printf("%s/study.yaml: what to measure, under `measured`; FILMING.md: how to film; `treacle check "
                "%s/study.yaml`: what matters\n",
        files.c_str(), files.c_str());
    if (guessed) {
        std::printf("first guess: %s Pa.s (%s); the search goes from %s to %s Pa.s\n",
            digits(guessed->viscosity).c_str(), guessed->source.c_str(),
            digits(guessed->viscosity / range_factor).c_str(), digits(guessed->viscosity * range_factor).c_str());
    } else {
        std::vector<std::string> known;
        for (const auto& one : chosen.guesses) known.push_back(takes(one));
        std::printf("no first guess: %s, or --viscosity, would give one\n", join(known, ", or ").c_str());
    }
    return ExitCode::ok;
}

} // namespace treacle::app
