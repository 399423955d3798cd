#include "identify/experiment/set_up.hpp"

#include "base/options/options.hpp"

namespace treacle::identify {

void SetUp::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    d.text("name", name, "Name in the table, and of its folder.");
    d.required("name");
    d.text("like", like, "Experiment whose scene, camera, times and uncertainties it takes; by default the first.");
    d.texts("set", set, "Keys of that scene that differ: [\"liquids.lotion.shapes.0.box.max=[2.5 cm, 5 cm]\"].");
    d.text("camera", camera, "Another camera: a file, or the name of one of the scene's.");
    d.number("from", from, unit::time, range_at_least(-1),
        "Scene's time from which frames are compared; -1: as the experiment.");
    d.number("to", to, unit::time, range_at_least(-1),
        "Scene's time up to which they are, no later than that experiment's film lasts; -1: as the experiment.");
    d.check(name.find_first_of(",/\"\n\r ") == std::string::npos, "name",
        {"must not have a blank, a comma, a slash, a quote or a line break", "a folder is named after it",
            "choose a plainer name"});
}

} // namespace treacle::identify
