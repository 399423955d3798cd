#include "identify/experiment/experiment.hpp"

#include "base/options/options.hpp"

namespace treacle::identify {

void ViewUncertainty::declare(Declaration& d) {
    d.number("time_zero", time_zero, unit::time, range_at_least(0),
        "Standard deviation of the time at which the flow starts.");
    d.number("contour", contour, unit::none, range_at_least(0),
        "Pixels by which all contours of the film may lie too far out or in.");
    d.number("focal", focal, unit::none, range_at_least(0),
        "Relative, of the focal length, where the camera's file has no covariance.");
    d.number("turn", turn, unit::angle, range_at_least(0), "Of the camera about each of its axes, likewise.");
    d.number("place", position, unit::length, range_at_least(0), "Of the camera along each of its axes, likewise.");
    d.number("readout", readout, unit::time, range_at_least(0), "Of the experiment's readout; 0: it is known.");
    d.number("scale", scale, unit::none, range_at_least(0),
        "Relative, of the lengths in a sheet of PIV, and with them of its velocities; of the values of a series.");
    d.number("shift", shift, unit::length, range_at_least(0),
        "Of a sheet of PIV along each of its axes; `turn` is that in its plane.");
}

void Experiment::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    d.text("name", name, "Name in reports; by default that of the masks' folder, or piv or series.");
    d.text("scene", scene, "Name of the scene that simulates it; by default the first.");
    d.text("masks", masks,
        "Folder with masks and their times, by `treacle silhouettes` or `treacle film`; or piv or series.");
    const bool occupied = d.optional_block(
        "occupancy", kind == ExperimentKind::occupancy, [this](Declaration& inner) { occupancy.declare(inner); },
        "Masks are compared by how often each pixel is liquid, over windows of time: for liquid that coils or folds, "
        "whose phase and sense of turning tell nothing.");
    const bool sheet = d.optional_block(
        "piv", kind == ExperimentKind::piv, [this](Declaration& inner) { piv.declare(inner); },
        "Velocity fields in a sheet of light, in the place of masks.");
    const bool numbers = d.optional_block(
        "series", kind == ExperimentKind::series, [this](Declaration& inner) { series.declare(inner); },
        "Numbers over time, in the place of masks: a front's place, a level, a ball's height.");
    if (occupied) kind = ExperimentKind::occupancy;
    if (sheet) kind = ExperimentKind::piv;
    if (numbers) kind = ExperimentKind::series;
    d.check(int(sheet) + int(numbers) + int(!masks.empty()) == 1, "masks",
        {"must be given, or piv, or series, and only one of them", "an experiment observes one thing",
            "write an experiment for each"});
    d.check(!occupied || !masks.empty(), "occupancy", {"has no effect", "it belongs to masks", "leave it out"});
    d.texts("see_through", see_through,
        "Bodies of the scene that the camera sees through: [front_wall]. What refracts is not accounted for.");
    d.text("camera", camera, "The camera's file, or the name of a camera of the scene; by default the scene's first.");
    d.number("time_zero", time_zero, unit::time, range_any(),
        "Time of the masks or fields at which the scene's time is 0: when the flow starts.");
    d.number("from", from, unit::time, range_at_least(0), "Scene's time from which masks or fields are compared.");
    d.number("to", to, unit::time, range_at_least(0),
        "Scene's time up to which they are; 0: as long as observation and run last.");
    d.integer("every", every, range_at_least(1), "Masks or fields from one that is compared to the next.");
    d.number("readout", readout, unit::time, range_at_least(0),
        "Time from the first to the last row of a rolling shutter, 10 to 30 ms of a phone; rows are compared at their "
        "own time, the middle one at that of "
        "the mask. Film a light that blinks at a known rate, and count its bands.");
    d.text("repeats", repeats,
        "Name of the experiment of which this is another clip: the same set-up, filled and filmed anew. How much clips "
        "differ enters the interval.");
    d.check(readout == 0 || has_masks(kind), "readout", {"has no effect", "it belongs to masks", "leave it out"});
    d.block("plus_minus", plus_minus, "Standard deviations of what the comparison does not know exactly.");
    d.check(plus_minus.readout == 0 || has_masks(kind), "plus_minus",
        {"must not have a readout", "it belongs to masks", "leave it out"});
    if (d.parsing() && name.empty() && (sheet || numbers)) name = sheet ? "piv" : "series";
    if (d.parsing() && name.empty()) {
        const auto end = masks.find_last_not_of('/');
        const auto slash = masks.rfind('/', end);
        name = masks.substr(
            slash == std::string::npos ? 0 : slash + 1, end - (slash == std::string::npos ? std::string::npos : slash));
    }
    d.check(to == 0 || to > from, "to", {"must be after `from`", "", "leave it out to compare to the end"});
    d.check(name.find_first_of(",/\"\n\r ") == std::string::npos, "name",
        {"must not have a blank, a comma, a slash, a quote or a line break", "files are named after it",
            "choose a plainer name"});
}

void SearchSettings::declare(Declaration& d) {
    d.choice<Method>("method", method,
        {{"automatic", Method::automatic}, {"bracketing", Method::bracketing}, {"gauss_newton", Method::gauss_newton},
            {"cma_es", Method::cma_es}, {"dissertation", Method::dissertation}},
        "automatic: bracketing for one parameter, gauss_newton for several, or cma_es where the objective is the "
        "mismatch; bracketing: from both sides, then Brent's method; gauss_newton: by "
        "the residuals of each segment, in some 15 runs of three parameters; cma_es: by the objective alone, in "
        "hundreds; dissertation: that of its "
        "section 6.5.5, CMA-ES without a logarithm.");
    d.choice<Objective>("objective", objective,
        {{"displacements", Objective::displacements}, {"mismatch", Objective::mismatch}},
        "displacements: of contours, with the view that suits each run best; mismatch: half the share of pixels that "
        "differ, (6.9) of the "
        "dissertation, mean over masks and films. The answer and its interval are those of the displacements either "
        "way.");
    d.check(objective == Objective::displacements || method != Method::gauss_newton, "objective",
        {"must be displacements", "gauss_newton goes by them, segment by segment",
            "leave it out, or write method: cma_es"});
    d.boolean("early_stop", early_stop,
        "Whether cma_es and dissertation, with objective: mismatch, end a run once its frames so far are worse than "
        "the worst run of the generation "
        "before. Its value is then a lower bound, which ranks but enters no fit. Other searches and objectives have "
        "whole runs.");
    d.integer("evaluations", evaluations, range_at_least(3), "Runs of each scene at most.");
    d.number("tolerance", tolerance, unit::none, range_above(0),
        "Relative change of the parameters at which the search ends.");
    d.integer("seed", seed, range_at_least(0), "Of the random numbers of cma_es.");
    d.texts("rungs", rungs,
        "Spacings of the scenes, the coarsest first: [8 mm, 5.6 mm, 4 mm]. The search runs with the first, one run "
        "each with the "
        "others corrects its answer, and their differences say how far it is from that of spacing 0. Without them the "
        "interval lacks the error of the resolution.");
    d.choice<Answer>("answer", answer, {{"extrapolated", Answer::extrapolated}, {"finest", Answer::finest}},
        "extrapolated: at spacing zero, for films of real liquids; finest: at the finest rung, for a film that is "
        "itself a run of that spacing, "
        "whose interval then lacks the error of the resolution.");
    d.integer("noise_runs", noise_runs, range_between(0, 8),
        "Runs with the first spacing changed by 1.5 to 6 %, of which the scatter of the answer is the numerical "
        "noise.");
}

} // namespace treacle::identify
