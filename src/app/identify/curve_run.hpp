#pragma once
#include "identify/material/compared_curve.hpp"
#include "scene/scene.hpp"

namespace treacle::app {

// A rheometer's table, and the liquid that it is of.
struct MeasuredCurve {
    std::string liquid; // empty: not stated
    identify::ViscositiesByRate curve;
    bool is_of(const std::string& name) const { return liquid.empty() || liquid == name; }
};
// Reads "curve.csv" or "oil=curve.csv". Throws InputError, also for a liquid of which nothing is searched.
MeasuredCurve read_measured_curve(const std::string& argument, const identify::StudyFile& file);

// The study that does the runs.
struct AskedStudy {
    const identify::StudyFile& file;
    study::StudyRuns& runs;
    const study::SceneReader& read_scene;
};

// The law of a measured curve, fitted over the shear rates of the run at the answer, and one more run of each scene
// with it in the place of what was identified of the liquid's rheology: at the finest spacing, all else as in the run
// at the answer. It is a run of the study like the others, kept and resumed by its content, and stays out of the
// answer's trials. An obstacle is stated in `problem`; `found.end` is `stopped` when a stop was requested. `found` has
// an estimate.
identify::ComparedCurve run_at_curve(const AskedStudy& asked, const identify::Priors& priors,
    const MeasuredCurve& measured, identify::Identification& found, Log& log);

// Keys of the scene that give a liquid the law: "liquids.syrup.viscosity=8.01 Pa.s", and its rheology as a whole, in which the times and rates of
// regularisation stay as they are. To six digits.
std::vector<std::string> keys_of_law(
    const identify::CurveFit& law, const std::string& liquid, const scene::Rheology& rheology);

} // namespace treacle::app
