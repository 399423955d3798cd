#include "app/identify/study_templates.hpp"

#include "identify/material/first_guess.hpp"

#include <numbers>

namespace treacle::app {

namespace {
using namespace identify;

double from_gate(const FormValues& v) {
    return plane_spreading(v.at("density"), v.at("length") * v.at("height"), v.at("front"), v.at("at"));
}
double from_cylinder(const FormValues& v) {
    const double volume = std::numbers::pi * v.at("radius") * v.at("radius") * v.at("height");
    return round_spreading(v.at("density"), volume, v.at("front"), v.at("at"));
}
double down_incline(const FormValues& v) {
    return spreading_down(v.at("density"), v.at("length") * v.at("height"), v.at("tilt"), v.at("front"), v.at("at"));
}
double of_film(const FormValues& v) {
    return film_on_incline(v.at("density"), v.at("tilt"), v.at("thickness"), v.at("speed"));
}
double from_hole(const FormValues& v) {
    return outflow({v.at("density"), v.at("hole"), v.at("inside") - v.at("bottom"), v.at("level") - v.at("bottom"),
        v.at("drained") / v.at("at")});
}
double from_nozzle(const FormValues& v) {
    return outflow({v.at("density"), v.at("bore"), v.at("length"), v.at("level"), v.at("drained") / v.at("at")});
}
double of_ball(const FormValues& v) {
    return falling_ball(
        v.at("ball_density") - v.at("density"), v.at("radius"), v.at("tube"), v.at("fallen") / v.at("at"));
}
double from_cup(const FormValues& v) { return v.at("density") * v.at("efflux"); }

const FirstGuess spreading{{"front", "at"}, "Huppert 1982, spreading over a floor in the plane", from_gate};
} // namespace

std::string_view template_text(const std::string& name) {
    for (const auto& file : template_files()) {
        if (file.name == name) return file.text;
    }
    return {};
}

const std::vector<StudyTemplate>& study_templates() {
    static const std::vector<StudyTemplate> all{
        {"container",
            {{{"drained", "at"}, "Hagen and Poiseuille with the loss at the entrance, Sampson 1891", from_hole}}},
        {"dam_break", {spreading}},
        {"cylinder_slump", {{{"front", "at"}, "Huppert 1982, spreading over a floor to a disc", from_cylinder}}},
        {"bostwick", {spreading}},
        {"nozzle_cup",
            {{{"drained", "at"}, "Hagen and Poiseuille with the loss at the entrance, Sampson 1891", from_nozzle},
                {{"cup", "efflux"}, "the cup's formula, ASTM D1200 or D4212", from_cup}}},
        {"incline", {{{"front", "at"}, "Huppert 1982, spreading down a slope", down_incline},
                        {{"thickness", "speed"}, "Nusselt 1916, a film of even thickness", of_film}}},
        {"falling_ball", {{{"fallen", "at"}, "Stokes 1851 with Faxen's walls, 1922", of_ball}}},
    };
    return all;
}

} // namespace treacle::app
