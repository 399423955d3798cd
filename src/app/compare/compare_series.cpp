#include "app/compare/compare_series.hpp"

#include "app/run/measure.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <algorithm>

namespace treacle::app {

namespace {
// Table and column of the run that the values are compared with.
struct Source {
    std::string table, column;
};

Source source_of(const identify::Experiment& experiment, const scene::Scene& scene) {
    const auto& series = experiment.series;
    if (series.measurement.empty()) return {series.table + ".csv", series.column};
    std::vector<std::string> names;
    for (const auto& one : scene.measurements) {
        if (one.name == series.measurement) return {"measurements.csv", measurement_column(one, scene.domain)};
        names.push_back(one.name);
    }
    const auto close = nearest(series.measurement, names);
    throw InputError({series.where, "the scene has no measurement " + series.measurement,
        names.empty() ? "it has none at all" : "it has " + join(names, ", "),
        close ? "did you mean " + *close + "?" : "add it to the scene's `measurements`"});
}
} // namespace

std::vector<identify::ObservedValue> observed_series(
    const identify::StudyFile& file, const identify::Experiment& experiment, const Input& input) {
    const auto path = file.beside(experiment.series.file);
    if (!std::filesystem::is_regular_file(path)) {
        throw InputError({experiment.series.where, "file = " + experiment.series.file + " is not there",
            "names are taken from the study's folder", "check the name"});
    }
    return identify::observed_values(experiment, path, identify::unit_in(source_of(experiment, input.scene).column));
}

ObservationNeeds series_needs(
    const identify::StudyFile& file, const identify::Experiment& experiment, const Input& input) {
    const auto observed = observed_series(file, experiment, input);
    check_end(experiment.where, experiment.name, observed.back().time, input.scene.time.end);
    const auto source = source_of(experiment, input.scene);
    ObservationNeeds out;
    out.content = "series " + experiment.name + " " + source.table + " " + source.column;
    for (const auto& one : observed) {
        for (const double v : {one.time, one.value, one.deviation}) out.content += " " + format_number(v);
    }
    return out;
}

void compare_with_series(const identify::StudyFile& file, const identify::Experiment& experiment, const Input& input,
    const std::filesystem::path& folder) {
    const auto source = source_of(experiment, input.scene);
    const auto table = read_csv(folder / "run" / source.table);
    identify::write_residuals(folder, experiment.name,
        identify::compare_series(
            observed_series(file, experiment, input), table.column("time"), table.column(source.column)));
}

} // namespace treacle::app
