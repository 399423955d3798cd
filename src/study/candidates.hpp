#pragma once
#include "study/lanes/journal.hpp"
#include "study/model/study.hpp"

#include <functional>

namespace treacle::study {

// A key of a scene that is set, and the place that states it: "study.yaml:12: viscosity".
struct Assignment {
    std::string text; // "liquids.syrup.viscosity=12 Pa.s"
    std::string origin;
};

// Facts of a scene for a study; returned by the program's own reader of scenes. Throws InputError where the scene is
// not valid with these assignments.
struct SceneFacts {
    std::string content; // all that a run's result depends on: every value, and the contents of the files that it names
    double end = 0;      // [s] of simulated time
    double work = 0;     // in which its runs' lengths are to each other, roughly: particles times steps; 0: not known
};
using SceneReader =
    std::function<SceneFacts(const std::filesystem::path& scene, const std::vector<Assignment>& assignments)>;

// The keys that a run of the study sets in its scene: those of the scene's entry, measured values, parameters, and then the run's own changes.
std::vector<Assignment> assignments_of(
    const Study& study, const StudyScene& scene, const Point& values, const std::vector<std::string>& changes = {});

// Hash of all that a run's result depends on: the scene's content, ranks, and the program's version and sources.
std::string run_key(const SceneFacts& facts, int ranks, const std::string& program);
JournalOwner owner_of(const Study& study, const std::string& program);
// Version and sources of this program, in one line.
std::string program_identity();

// A run that may be requested.
struct Candidate {
    std::string scene; // its name
    Point values;
    std::string key;
    double end = 0;                        // [s] of simulated time
    double work = 0;                       // as in SceneFacts
    std::vector<std::string> changes = {}; // as in RunRequest
    double cut = no_cut;                   // it may stop early once its objective is above
};
// Throws InputError when the values or changes are invalid for the scene.
Candidate candidate_of(const Study& study, const StudyScene& scene, const Point& values, const SceneReader& read_scene,
    const std::vector<std::string>& changes = {});
// Candidates of every point in every scene, the scenes of a point side by side. Throws InputError with what is wrong in
// all of them.
std::vector<Candidate> candidates_of(
    const Study& study, const std::vector<Point>& points, const SceneReader& read_scene);

} // namespace treacle::study
