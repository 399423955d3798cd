#pragma once
#include "app/identify/curve_run.hpp"
#include "app/study/sweep.hpp"

namespace treacle::app {

// Arguments of `treacle identify`, beyond those of a sweep.
struct IdentifyRequest : SweepRequest {
    std::string compared_curve; // a rheometer's table, as read_measured_curve takes it; empty: none
    bool hidden = false;        // draws pressure and speed, see hidden_fields.hpp
    bool quick = false;         // see StudyFile::make_quick
};

// A study's answer, and where its runs are.
struct IdentifiedStudy {
    identify::StudyFile file;
    identify::Identification answer;
    std::optional<MeasuredCurve> measured;                        // where the request has a table
    std::optional<identify::ComparedCurve> compared;              // with it, where there is an answer
    std::filesystem::path folder;                                 // of the study's results
    std::function<std::filesystem::path(std::int64_t)> folder_of; // of a run
};
// Does the runs that are lacking and writes the table of those that the answer comes from. Throws InputError, for a bad table of a rheometer before
// any run.
IdentifiedStudy identified_study(const IdentifyRequest& request);

// `treacle identify` in a process without MPI: searches the parameters with which the study's scenes match its films
// best, and writes the table of the runs and a report. Exit code 0 with an answer, 3 without, 5 when stopped.
ExitCode identify_study(const IdentifyRequest& request);

} // namespace treacle::app
