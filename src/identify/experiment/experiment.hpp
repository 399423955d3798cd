#pragma once
#include "identify/experiment/occupancy.hpp"
#include "identify/experiment/series.hpp"
#include "identify/experiment/sheet.hpp"
#include "identify/experiment/views.hpp"

#include <array>
#include <string>
#include <vector>

namespace treacle {
class Declaration;
}

namespace treacle::identify {

// Standard deviations of inputs of a comparison that are not exact. They enter the interval, as parameters that
// need no run: the contours move a little.
struct ViewUncertainty {
    double time_zero = 5e-3; // [s]
    double contour = 0.3;    // [px] that all contours of a film may lie too far out or in: threshold, blur, iso value
    double focal = 1e-3;     // relative; without the covariance of a camera file
    double turn = 1e-3;      // [rad] of the camera about each axis, likewise
    double position = 1e-3;  // [m] of the camera along each axis, likewise
    double readout = 0;      // [s] of the rolling shutter's readout; 0: it is known
    double scale = 2e-3;     // relative, of a sheet of PIV or the instrument of a series
    double shift = 2e-4;     // [m] of a sheet of PIV along each of its axes; its turn in its plane is `turn`

    // Keys of the block `plus_minus` of an experiment.
    void declare(Declaration& d);
};

// An observation of a flow beside the scene that simulates it: a film's contours, frame by frame or of how often pixels are liquid, velocity fields in a sheet, or numbers over time.
struct Experiment {
    std::string name;
    std::string scene; // name of the study's scene; empty: its first
    ExperimentKind kind = ExperimentKind::contours;
    std::string masks;   // folder of `treacle silhouettes` or `treacle film`, beside the study's file
    Occupancy occupancy; // of the masks
    Sheet piv;
    Series series;
    std::vector<std::string> see_through; // names of bodies of clear material: walls of glass
    std::string camera;                   // a camera file, or the name of a camera of the scene
    double time_zero = 0;                 // [s] time of the masks' table at which the scene's time is 0
    double from = 0;                      // [s] of the scene's time
    double to = 0;                        // [s]; 0: as long as both last
    int every = 1;                        // masks from one that is compared to the next
    double readout =
        0; // [s] from the first to the last row of a rolling shutter; a mask's time is that of its middle row
    std::string repeats; // name of the experiment of whose set-up this is another clip; empty: a set-up of its own
    ViewUncertainty plus_minus;
    std::string where;

    // Keys of an item of `experiments`; keys of another kind of experiment are refused.
    void declare(Declaration& d);
};

// Method of the search; automatic: bracketing for one parameter, gauss_newton for several, cma_es for the mismatch.
enum class Method { automatic, bracketing, gauss_newton, cma_es, dissertation };

// Quantity that the search makes least.
enum class Objective {
    displacements, // residual_objective, of contours, fields and series
    mismatch,      // mean over films of (6.9)
};

// Spacing at which the answer is read off the rungs.
enum class Answer { extrapolated, finest };

// Block `search` of a study file.
struct SearchSettings {
    Method method = Method::automatic;
    Objective objective = Objective::displacements; // mismatch is refused for gauss_newton
    bool early_stop = true;                         // of runs that are hopeless; see stops_early
    int evaluations = 20;                           // at most
    double tolerance = 0.03;                        // of the parameters, relative
    int seed = 1;                                   // of cma_es and dissertation; other methods draw nothing
    std::vector<std::string>
        rungs; // spacings of the scenes, the coarsest first: the search's, then those that correct it
    Answer answer = Answer::extrapolated; // spacing zero by the rungs, or the finest rung itself
    int noise_runs = 4;                   // of the search's spacing, changed a little, that measure the numerical noise

    // Keys and ranges of the block `search`.
    void declare(Declaration& d);
    // True where runs of a search that has cuts may stop early: those of an objective that only grows from frame to frame.
    bool stops_early() const { return early_stop && objective == Objective::mismatch; }
};

} // namespace treacle::identify
