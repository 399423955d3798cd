#include "app/identify/identify.hpp"

#include "app/compare/experiments.hpp"
#include "app/identify/flow_curve_bands.hpp"
#include "app/identify/hidden_fields.hpp"
#include "app/identify/identified_liquids.hpp"
#include "base/text/log.hpp"
#include "identify/report/report.hpp"
#include "identify/report/report_drift.hpp"

#include <map>

namespace treacle::app {

namespace {
void require_experiments(const identify::StudyFile& file) {
    if (!file.experiments.empty()) return;
    throw InputError({file.study.path.string(), "has no experiments", "there is nothing to compare the runs with",
        "name the masks of a film, experiments: [{masks: masks, camera: camera.yaml}], or fields of PIV; `treacle "
        "sweep` needs none"});
}
} // namespace

IdentifiedStudy identified_study(const IdentifyRequest& request) {
    IdentifiedStudy out;
    out.file = load_checked_study(request.study, request.overrides);
    auto& file = out.file;
    if (!request.compared_curve.empty()) out.measured = read_measured_curve(request.compared_curve, file);
    if (request.quick) file.make_quick();
    require_experiments(file);
    const StudyScenes scenes(file);
    identify::check_searched(file, scenes.reader());
    const auto priors = experiment_priors(file);
    out.folder = study_folder(file.study.path, request.out);
    Log log(LogOutput::enabled);
    study::check_launcher(file.study);
    study::StudyRuns runs(file.study, {out.folder, this_program(), {}}, log);
    out.answer = identify::identify(file, priors, runs, scenes.reader(), log);
    if (out.measured && out.answer.estimate)
        out.compared = run_at_curve({file, runs, scenes.reader()}, priors, *out.measured, out.answer, log);
    std::vector<std::int64_t> of_parameters; // runs that the values of the parameters determine
    std::map<std::int64_t, std::filesystem::path> folders;
    for (const auto& run : runs.journal().runs()) {
        folders[run.number] = runs.folder_of(run.number);
        if (run.changes.empty()) of_parameters.push_back(run.number);
    }
    write_tables(out.folder, study::table_of(file.study, runs.journal(), of_parameters));
    out.folder_of = [folders](std::int64_t number) { return folders.at(number); };
    return out;
}

ExitCode identify_study(const IdentifyRequest& request) {
    const auto [file, found, measured, compared, folder, folder_of] = identified_study(request);
    if (found.end == study::StudyEnd::stopped) return ExitCode::stopped;
    Log log(LogOutput::enabled);
    const auto curves = flow_curve_bands(file, found, folder_of, measured);
    identify::ReportParts parts{curves, identified_materials(file, found, curves), {}, compared};
    if (request.hidden) parts.hidden = draw_hidden_fields(folder / "report", file, found, folder_of, log);
    identify::write_report(folder / "report", file, found, folder_of, parts);
    for (const auto& line : identify::answer_lines(file, found)) log.line(line);
    for (std::size_t k = 0; k < found.values.size(); ++k) {
        log.line(file.study.parameters[k].name + ": " + identify::identifiability(file, found, k));
    }
    for (const auto& line : identify::trade_lines(file, found)) log.line(line);
    for (const auto& curve : curves) {
        for (const auto& line : identify::describe(curve)) log.line(line);
    }
    if (compared) {
        for (const auto& line : identify::describe(*compared, file)) log.line(line);
    }
    for (const auto& note : identify::notes(file)) log.line(note);
    const auto said = identify::verdict(file, found);
    if (!said.empty()) log.warn(said);
    for (const auto& line : identify::drift_lines(file, found)) log.warn(line);
    log.line("report: " + (folder / "report" / "index.html").string());
    return found.estimate ? ExitCode::ok : ExitCode::simulation_failed;
}

} // namespace treacle::app
