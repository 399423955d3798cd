#pragma once
#include "identify/experiment/experiment.hpp"
#include "identify/experiment/set_up.hpp"
#include "identify/experiment/temperature.hpp"
#include "study/model/study.hpp"

namespace treacle::identify {

// A study file whole: the runs, and the films that they are compared with.
struct StudyFile {
    study::Study
        study; // behind the parameters that are searched stand, with experiments, the measured values and the spacing
    std::vector<Experiment> experiments;
    std::vector<SetUp> candidates; // to be filmed next
    SearchSettings search;
    Temperature temperature;
    std::size_t searched = 0;       // parameters, the first of the study's
    std::size_t measured = 0;       // behind those
    std::vector<double> deviations; // [measured] in the units of the parameters
    std::vector<double> exponents;  // [measured] of the values in what is searched; 0: not known
    bool has_rungs() const { return study.parameters.size() > searched + measured; }

    // Keys of the whole study file: those of study::Study, and the blocks above.
    void declare(Declaration& d);
    // For an answer of a few runs: the coarsest rung and the first finer by 1.6, one run for the noise, none for the measured values, whose part the
    // interval then lacks.
    void make_quick();

    // The scene that the experiment names, the first for an empty name; load_study_file() has checked it.
    const study::StudyScene& scene_of(const Experiment& experiment) const;
    // Absolute.
    std::filesystem::path beside(const std::string& name) const;

private:
    void add_measured_and_rungs(Declaration& d);
};

// Moves a value of a searched parameter by a fraction of its range, to where there is room; how far its coordinate (the logarithm of a
// viscosity) went.
double move_along(const study::Parameter& parameter, double fraction, double& value);

// Throws InputError with all that is wrong in the file itself.
StudyFile load_study_file(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

// The manual of the study file, and its JSON Schema.
std::string study_manual(const std::string& key);
std::string study_schema();

} // namespace treacle::identify
