#include "app/bench/bench_scene.hpp"

#include "base/options/options.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "scene/renamed_keys.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

Input bench_scene(std::int64_t particles, int sections, const std::vector<std::string>& overrides) {
    const double edge = std::max(1.0, std::round(std::cbrt(double(particles))));
    const std::string depth = std::to_string(sections);
    const std::string text = "schema_version: 1\n"
                             "title: Dam break for measurements\n"
                             "domain:\n"
                             "  max: [2, " +
                             depth +
                             ", 1.25]\n"
                             "  spacing: " +
                             format_number(1 / edge) +
                             "\n"
                             "  boundaries: {z_max: {kind: open, outflow: true}}\n"
                             "liquids:\n"
                             "  - name: water\n"
                             "    density: 1000\n"
                             "    viscosity: 1 mPa.s\n"
                             "    shapes:\n"
                             "      - box: {min: [0, 0, 0], max: [1, " +
                             depth +
                             ", 1]}\n"
                             "method: {pressure: {solver: isph}}\n"
                             "time: {end: 1 s}\n";
    auto document = Document::from_text(text, "treacle bench");
    document.accept(scene::renamed_keys());
    for (const auto& assignment : overrides) document.set(assignment);
    Input input;
    parse(document, input);
    if (input.method.pressure.solver != sph::PressureSolver::isph) {
        throw InputError({"method.pressure.solver", "has no matrix", "treacle bench measures the assembled system",
            "leave it at isph, and compare steps.csv of runs for the others"});
    }
    return input;
}

} // namespace treacle::app
