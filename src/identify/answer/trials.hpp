#pragma once
#include "base/text/log.hpp"
#include "identify/answer/identification.hpp"
#include "identify/answer/search_space.hpp"

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace treacle::identify {

// A change of a run against those of the search: of the spacing, or of a measured value.
struct Variation {
    std::string purpose = "search";
    std::size_t parameter = std::numeric_limits<std::size_t>::max(); // of the study; none: as in the search
    double value = 0;                                                // in its unit
};

using Wanted = std::vector<std::pair<search::Point, Variation>>; // points of the search, each with its change

// Runs candidates and keeps what came of them.
class Trials {
public:
    Trials(const StudyFile& file, const Priors& priors, study::StudyRuns& runs, const study::SceneReader& read_scene,
        Log& log, Identification& out)
        : file_(file), priors_(priors), runs_(runs), read_scene_(read_scene), log_(log), out_(out) {}

    // Runs of each point and its variation: nothing where one failed or stopped early. Runs may do that where the
    // search's objective of the k-th point is above cut(k), infinite where it may not. Throws Stopped when a stop is
    // requested.
    struct Stopped {};
    using Cuts = std::function<double(std::size_t)>;
    std::vector<std::optional<EvaluatedRun>> run(Wanted wanted, const Cuts& cut = {});
    // Lanes that would idle while later calls of `run` block may do these meanwhile; without any, they end.
    void offer(const Wanted& expected);
    bool speculates() const { return file_.study.runs.speculate && runs_.lanes() > 1; }
    // Runs at the search's spacing with the measured values as they are.
    const std::vector<EvaluatedRun>& good() const { return good_; }

private:
    search::Point run_point(search::Point point, const Variation& variation) const;
    std::vector<double> values_at(const search::Point& point, const Variation& variation) const;
    std::vector<study::Candidate> candidates_at(const std::vector<double>& values) const;
    std::optional<EvaluatedRun> evaluate(Trial& trial, const search::Point& point) const;
    void keep(const std::optional<EvaluatedRun>& run, const Variation& variation);
    void tell(const Trial& trial) const;

    const StudyFile& file_;
    const Priors& priors_;
    study::StudyRuns& runs_;
    const study::SceneReader& read_scene_;
    Log& log_;
    Identification& out_;
    std::vector<search::Axis> axes_ = axes_of(file_);
    std::vector<EvaluatedRun> good_;
};

} // namespace treacle::identify
