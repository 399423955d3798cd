#include "identify/report/report_charts.hpp"

#include <cmath>

namespace treacle::identify {

std::string mismatch_title(const Experiment& one) {
    if (one.kind == ExperimentKind::contours) return "E (6.9) of " + one.name;
    if (one.kind == ExperimentKind::occupancy) return "E (6.9) of how often pixels are liquid in " + one.name;
    return one.kind == ExperimentKind::piv ? "E (E.1) of " + one.name + " [m2/s2]" : "mean square of " + one.name;
}

study::Chart objective_chart(
    const StudyFile& file, const Identification& identification, std::optional<std::size_t> experiment) {
    const auto& parameter = file.study.parameters.front();
    study::Chart chart;
    chart.title = experiment ? mismatch_title(file.experiments[*experiment]) : "Objective";
    chart.x = {
        parameter.column(), parameter.scale == study::Scale::log ? study::AxisScale::log : study::AxisScale::linear};
    chart.y = {experiment ? "E" : "objective", study::AxisScale::log};
    study::ChartSeries dots;
    for (const auto& trial : identification.trials) {
        if (trial.purpose != "search" && trial.purpose != "around the answer")
            continue; // of another spacing or measured value
        dots.x.push_back(trial.values.front());
        dots.y.push_back(!experiment                ? trial.objective
                         : trial.mismatches.empty() ? std::nan("")
                                                    : trial.mismatches[*experiment]);
    }
    chart.series.push_back(dots);
    return chart;
}

study::Chart misfit_chart(const StudyFile& file, const Estimate& estimate, std::size_t experiment) {
    study::Chart chart;
    chart.title = "Left over by frame: " + file.experiments[experiment].name;
    chart.x.label = "time [s]";
    chart.y.label = std::string("root mean square [") + misfit_unit(file.experiments[experiment].kind) + "]";
    study::ChartSeries line;
    for (std::size_t i = 0; i < estimate.misfit.size(); ++i) {
        if (estimate.misfit_of[i] != experiment) continue;
        line.x.push_back(estimate.times[i]);
        line.y.push_back(estimate.misfit[i]);
    }
    line.line = true;
    chart.series.push_back(line);
    return chart;
}

study::Chart convergence_chart(const StudyFile& file, const Identification& identification) {
    study::Chart chart;
    const auto& parameter = file.study.parameters.front();
    chart.title = "Search";
    chart.x.label = "trial";
    chart.y = {
        parameter.column(), parameter.scale == study::Scale::log ? study::AxisScale::log : study::AxisScale::linear};
    study::ChartSeries line;
    for (std::size_t i = 0; i < identification.trials.size(); ++i) {
        line.x.push_back(double(i + 1));
        line.y.push_back(identification.trials[i].values.front());
    }
    auto dots = line;
    line.line = true;
    chart.series = {line, dots};
    return chart;
}

} // namespace treacle::identify
