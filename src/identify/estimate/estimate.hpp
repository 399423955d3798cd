#pragma once
#include "identify/compare/residual_file.hpp"

#include <Eigen/Dense>

namespace treacle::identify {

// Inverse of the covariance that the view's parameters of an experiment have before the film is compared.
using ViewInformation = Eigen::Matrix<double, view_count, view_count>;

// One run against all experiments: its coordinates, and the residuals of each experiment.
struct EvaluatedRun {
    Eigen::VectorXd point; // [p] the logarithm of a viscosity
    std::vector<RunResiduals> experiments;
};

// Prior knowledge of the parameters before any film, where there are several: they lie within their ranges. Where films
// do not determine them one by one, the answer is then a region that ends, and not a point at its end.
struct RangePrior {
    Eigen::VectorXd lower, upper; // [p] of the coordinates; empty: none is used

    Eigen::VectorXd centre() const { return 0.5 * (lower + upper); } // [p] middle of the ranges
    // Inverse of the variance of an even distribution over the range.
    Eigen::VectorXd information() const { return 12 * (upper - lower).array().square().inverse(); }
};

// The search's objective: half of the weighted squares of the residuals in units of their usual noise, mean over segments,
// with Huber's loss beyond `bend` noises, least over the view's parameters within their priors. Contours of the run that lie far beyond
// the observed ones add to it, on which segments of these do not depend.
double residual_objective(const EvaluatedRun& run, const std::vector<ViewInformation>& priors, double bend = 3);

// Residuals of a run whose mean loss is its objective, for searches that use them: those of all segments at the view that suits the run best,
// in units of their usual noise (not a number where there is none), what lies beyond them by frame, and what that view is away from its priors.
std::vector<double> search_residuals(
    const EvaluatedRun& run, const std::vector<ViewInformation>& priors, double bend = 3);

// Unit of the misfits of an experiment: "px" of contours, "noises" of the measurement of all others.
const char* misfit_unit(ExperimentKind kind);

// Root mean square residual of each experiment over its frames, at the view that suits the run best, in misfit_unit; not a number where
// the run has nothing to compare.
std::vector<double> misfits_of_run(
    const EvaluatedRun& run, const std::vector<ViewInformation>& priors, double bend = 3);

// Parts of the variance of the logarithm of a parameter.
struct VarianceParts {
    double pixels = 0;                                                   // scatter of the residuals
    double time = 0, contour = 0, camera = 0, sheet = 0, instrument = 0; // of the view, by ViewPart
    double range = 0;                   // what is known by the ranges of the parameters alone
    double resolution = 0, noise = 0;   // numerical; see Identification
    double clips = 0, clip_freedom = 0; // between clips of one set-up, and its degrees of freedom; see repeats.hpp
    std::vector<std::pair<std::string, double>> measured; // by the measured values' names
    double total() const;
};

// (I5) Standard deviations to either side of a 90 % interval when a part of the variance is known with few degrees of freedom: a
// t distribution's, with Welch's and Satterthwaite's degrees for the sum.
double ninety_percent(const VarianceParts& parts, double freedom);

// The parameter that suits a part of an experiment's frames best, with one view for all parts.
struct WindowAnswer {
    double from = 0, to = 0; // times of its first and last frame [s]
    double change = 0;       // from the answer of all, of the logarithm of a viscosity
    double deviation = 0;    // its standard deviation
};

// Change of the answer over an experiment's frames: a model that explains the film has none.
struct Drift {
    std::vector<WindowAnswer> windows; // in the order of time; empty where frames are too few
    double change = 0, deviation = 0;  // of a straight line through the windows, from the first to the last
};

// Result of a fit, with the variance of its point by cause.
struct Estimate {
    Eigen::VectorXd point;            // [p]
    std::vector<VarianceParts> parts; // [p] of its variance
    Eigen::MatrixXd covariance;       // [p][p] of pixels, views and ranges
    std::vector<double>
        naive; // (I5b) [p] standard deviation if points of the contour were independent and the view known: far too small, to compare with
    std::vector<double> freedom;       // [p] degrees of freedom of the part of the pixels: few with few blocks
    std::vector<Eigen::VectorXd> view; // per experiment [view_count]: what the fit takes them for, less what was stated
    std::vector<double> noise;         // per experiment: standard deviation of a segment's residual in its unit, robust
    std::vector<double> dilution;      // per experiment: how many segments count as one
    double curvature = 0; // share of the local model's square term in a standard deviation: small where it is linear
    std::vector<double> misfit; // by frame of all experiments in turn: root mean square residual left over, in its unit
    std::vector<double> times;  // [s] of those frames
    std::vector<std::size_t> misfit_of;       // experiment of those frames
    std::vector<double> information_fraction; // of those frames, of a single parameter: of the information on it (I7)
    std::vector<Drift> drifts;                // per experiment, of a single parameter
    double alike = 0;       // difference of objectives that a likelihood ratio of 90 % allows, segments diluted
    int block_frames = 0;   // frames over which the displacements left over are correlated
    std::size_t blocks = 0; // blocks of frames and sectors of the picture that the jackknife leaves out in turn
    std::size_t runs = 0;   // that the local model is fitted to
};

// (I1) Gauss-Newton on signed residuals r(theta, v) = r + g (theta - theta_0) + J v: r and g of each segment by a
// polynomial through the runs nearest to the best one, J of the view. Weights are even up to Huber's; the variance is that of
// leaving out blocks of neighbouring segments and frames in turn (the jackknife of clusters, CR3 in Bell & McCaffrey 2002),
// since residuals side by side are not independent; its degrees of freedom after Satterthwaite. Each experiment is scaled by its
// own noise, and diluted by how many of its segments count as one. Throws InputError where the runs do not determine it.
// finer: runs at one or more other resolutions, or with another change, in order. Then r is that of the last of them; g of the runs
// before is corrected along the directions in which each resolution has several runs (a multisecant update, Fang & Saad 2009).
// range: what else is known of several parameters; the point stays within it. Of several, the view is free within its priors, and all
// experiments have one scale and dilution, which widens the covariance alone.
Estimate estimate(const std::vector<EvaluatedRun>& runs, const std::vector<ViewInformation>& priors,
    const std::vector<std::vector<EvaluatedRun>>& finer = {}, const RangePrior& range = {});

} // namespace treacle::identify
